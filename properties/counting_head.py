"""Properties of a counting head through a cycle of the axle counter (FVA-4, FVA-5; as a device FVA-13, FVA-14)."""

from __future__ import annotations

from collections.abc import Iterator

from safeloc.language.expr import Bool, Lit, Num, any_of, as_num, ite
from safeloc.language.spec import Property, always, earlier_bool, earlier_num, previous, reachable
from safeloc.language.units import COUNT, UM_S
from safeloc.models.axle_head import DOWN, NO_AXLE, UP
from safeloc.models.counting_head import CountingHead
from safeloc.models.vocabulary.head_contract import counts_every_axle
from safeloc.properties.claims import Claims

REQUIREMENTS = ("FVA-4", "FVA-5", "FVA-13", "FVA-14")
_BACK = ("turned back to A", "turned back to B", "turned back to both, upwards", "turned back to both, downwards")
LAW = "one wheel at a time, sampled often enough, and no false damping of a channel that is alive"
_BRAKES = f"{LAW}; trains keep to their traction and brakes"


def properties(model: CountingHead) -> list[Property]:
    """Return the properties: a cycle is reported as it was, or at fault."""
    return [
        *_contract(model),
        *_cycles(model),
        *_faults(model),
        *_wheel_times(model),
        *_late(model),
        *_no_more_faults(model),
        *_not_refused(model),
        *_added(model),
        *_damped(model),
        *_reached(model),
    ]


_held = Claims(REQUIREMENTS).for_all_inputs


def _contract(model: CountingHead) -> Iterator[Property]:
    """Claim the law that the axle counter assumes of each of its cycles."""
    of, own, machine = model.composition.of(model.cycle.machine), model.cycle.own, model.cycle.machine
    ups, downs = of.num(own.true_axles_upwards), of.num(own.true_axles_downwards)
    contract = counts_every_axle(
        fault=of.bool(machine.flag("cycle_fault")),
        axle=of.num(machine.output("cycle_axle")),
        number=of.num(machine.output("cycle_axles")),
        passed=ups + downs,
        upwards=downs.eq(0),
        downwards=ups.eq(0),
    )
    yield always(
        "a cycle is reported as the axle counter assumes",
        of.bool(machine.flag("cycle_done")).implies(contract),
        statement="at the last sample of a cycle of the axle counter, without a fault, the number of axles that is reported is the "
        "number of wheels that passed in its samples, and all of them passed in the direction reported",
        requirements=REQUIREMENTS,
        assumption=LAW,
    )


def _cycles(model: CountingHead) -> Iterator[Property]:
    of, own, machine = model.composition.of(model.cycle.machine), model.cycle.own, model.cycle.machine
    samples, done = of.num(own.samples), of.bool(machine.flag("cycle_done"))
    whole = earlier_num(samples).eq(model.config.samples)
    yield _held(
        "each sample belongs to one cycle",
        samples.eq(ite(whole, as_num(1, COUNT), earlier_num(samples) + 1)) & done.iff(samples.eq(model.config.samples)),
        "samples are counted one by one; after as many as make a cycle of the axle counter there is a record, and the next "
        "sample is the first of the next cycle",
    )


def _some(model: CountingHead) -> tuple[Bool, Bool, Bool]:
    """Return the damping of the two channels, and whether an axle is counted."""
    of, own = model.composition.of(model.head.machine), model.head.own
    return of.bool(own.channel_a_damped), of.bool(own.channel_b_damped), of.num(own.axle).ne(NO_AXLE)


def _alive(model: CountingHead) -> Bool:
    """Return whether both channels are alive."""
    of, own = model.composition.of(model.head.machine), model.head.own
    return of.bool(own.channel_a_alive) & of.bool(own.channel_b_alive)


def _flawed(model: CountingHead) -> Bool:
    return model.composition.of(model.cycle.machine).bool(model.cycle.own.flawed)


def _first_sample(model: CountingHead) -> Bool:
    """Return whether the sample is the first after a whole cycle."""
    samples = model.composition.of(model.cycle.machine).num(model.cycle.own.samples)
    return earlier_num(samples).eq(model.config.samples)


def _faults(model: CountingHead) -> Iterator[Property]:
    """Claim the events that are a fault of the cycle."""
    a, b, counted = _some(model)
    some, flawed = a | b, _flawed(model)
    of, machine = model.composition.of(model.head.machine), model.head.machine
    disturbed = of.bool(machine.flag("disturbed"))
    yield _held(
        "a disturbance is a fault of the cycle",
        (disturbed | earlier_bool(disturbed)).implies(flawed),
        "in a sample in which the head is disturbed, and in the one after it, the cycle is at fault",
    )
    yield _held(
        "a channel that is not alive is a fault of the cycle",
        (~_alive(model)).implies(flawed),
        "in a sample in which the current of a channel is not that of a sound one, the cycle is at fault, whatever both channels tell",
    )
    yield _held(
        "a wheel that leaves uncounted is a fault of the cycle",
        (previous(some) & ~some & ~counted).implies(flawed),
        "where both channels become free and no axle is counted, the cycle is at fault",
    )
    back = of.bool(machine.fired(*_BACK))
    yield _held(
        "a wheel that goes back on the head is a fault of the cycle",
        back.implies(flawed) & _mode_is_kept(model),
        "where a wheel turns back from one channel to both, or from both to one, the cycle is at fault: as of each wheel that passes while a "
        "channel stays damped",
    )
    yield _held(
        "a fault stays until its cycle ends",
        (earlier_bool(flawed) & ~_first_sample(model)).implies(flawed),
        "a cycle that is at fault in one of its samples is at fault in all later ones, its record included",
    )


def _mode_is_kept(model: CountingHead) -> Bool:
    """Return whether the cycle's memory of the head's mode is the head's."""
    of, head = (model.composition.of(one.machine) for one in (model.cycle, model.head))
    return of.num(model.cycle.own.mode_before).eq(head.num(model.head.machine.mode))


def _times_before(model: CountingHead) -> tuple[Num, Num]:
    """Return the samples of the first channel alone, and those since both were damped, before this sample."""
    of, own = model.composition.of(model.cycle.machine), model.cycle.own
    return earlier_num(of.num(own.first_alone)), earlier_num(of.num(own.since_both))


def _wheel_times(model: CountingHead) -> Iterator[Property]:
    """Claim how the samples of a wheel are counted."""
    of, own, head = model.composition.of(model.cycle.machine), model.cycle.own, model.head.machine
    in_head = model.composition.of(head)
    mode, (free, a_first, _, _, b_first, *_) = in_head.num(head.mode), head.modes
    alone, since = _times_before(model)
    wheel = model.config.wheel
    slow, longest = wheel.slow_samples, wheel.slow_samples * wheel.times_as_long + wheel.more_samples + 1
    first, back = mode.one_of(a_first, b_first), in_head.bool(head.fired(*_BACK))
    more = alone + ite(first, as_num(1, COUNT), 0)
    disturbed = in_head.bool(head.flag("disturbed"))
    counted = ite(disturbed | back | (more > slow), as_num(slow, COUNT), more)
    yield _held(
        "the samples of the first channel alone are counted",
        of.num(own.first_alone).eq(ite(mode.eq(free), as_num(0, COUNT), counted)),
        "from a free head on, one for each sample in which the channel that was damped first is damped alone; as many as of a slow wheel once "
        "a wheel has gone back, or while the head is disturbed",
    )
    rest = ite(since >= longest, as_num(longest, COUNT), since + 1)
    yield _held(
        "the samples since both channels are counted",
        of.num(own.since_both).eq(ite(first | mode.eq(free), as_num(0, COUNT), rest)),
        "from the first sample on in which both channels are damped, one for each sample until the head is free",
    )


def _took_too_long(model: CountingHead) -> Bool:
    """Return whether an axle is counted of a wheel that took too long, or may have stopped on the head."""
    (alone, since), wheel = _times_before(model), model.config.wheel
    *_, counted = _some(model)
    return counted & ((alone >= wheel.slow_samples) | (since - alone * wheel.times_as_long > wheel.more_samples))


def _late(model: CountingHead) -> Iterator[Property]:
    yield _held(
        "a wheel that is counted late is a fault of the cycle",
        _took_too_long(model).implies(_flawed(model)),
        "where an axle is counted, and the head was damped since both channels were for more than a few times as long as the first channel "
        "alone, or that one for so long that the wheel may have stopped, the cycle is at fault",
    )


def _no_more_faults(model: CountingHead) -> Iterator[Property]:
    """Claim that nothing else is a fault."""
    flawed = _flawed(model)
    of, own = model.composition.of(model.cycle.machine), model.cycle.own
    ups, downs = of.num(own.axles_upwards), of.num(own.axles_downwards)
    head, machine = model.composition.of(model.head.machine), model.head.machine
    disturbed = head.bool(machine.flag("disturbed"))
    uncounted = head.bool(machine.fired("turned back off A", "turned back off B"))
    went_back = head.bool(machine.fired(*_BACK))
    yield _held(
        "nothing else is a fault of the cycle",
        _mode_is_kept(model)
        & flawed.implies(
            (earlier_bool(flawed) & ~_first_sample(model))
            | disturbed
            | earlier_bool(disturbed)
            | uncounted
            | went_back
            | _took_too_long(model)
            | ((ups > 0) & (downs > 0))
            | (ups + downs > model.config.counter.axles_a_cycle)
        ),
        "a cycle is at fault only by a disturbance, a wheel that leaves uncounted, goes back on the head or is counted late, axles both ways, "
        "or more axles than the counter takes",
    )


def _not_refused(model: CountingHead) -> Iterator[Property]:
    """Claim that the times of a wheel that cannot stop on the head refuse none."""
    of, own = model.composition.of(model.cycle.machine), model.cycle.own
    end = 1_000 * (2 * model.config.head.spacing_mm + model.config.head.overlap_mm)
    place = model.composition.of(model.head.machine).num(model.head.own.wheel)
    on = any_of((one >= 0) & (one < end) for one in (place, earlier_num(place)))
    sure = of.num(own.speed_came) >= Lit(1_000 * model.config.wheel.sure_speed_mm_s, UM_S)
    ups, downs = of.num(own.axles_upwards), of.num(own.axles_downwards)
    others = ((ups > 0) & (downs > 0)) | (ups + downs > model.config.counter.axles_a_cycle)
    heard = _alive(model) & ~earlier_bool(
        model.composition.of(model.head.machine).bool(model.head.machine.flag("disturbed"))
    )
    yield always(
        "no wheel that comes fast enough is refused",
        (on & sure & heard & ~(earlier_bool(_flawed(model)) & ~_first_sample(model)) & ~others).implies(
            ~_flawed(model)
        ),
        statement="a wheel that comes on the head at the sure speed or faster makes no fault, neither on the head nor as it leaves, whatever "
        "its train's traction or brakes do, while both channels are alive",
        requirements=REQUIREMENTS,
        assumption=_BRAKES,
    )


def _added(model: CountingHead) -> Iterator[Property]:
    of, own, machine = model.composition.of(model.cycle.machine), model.cycle.own, model.cycle.machine
    head, most = model.composition.of(model.head.machine), model.config.counter.axles_a_cycle + 1

    def added(kept: Num, way: Lit) -> Bool:
        was = ite(_first_sample(model), as_num(0, COUNT), earlier_num(of.num(kept)))
        more = was + ite(head.num(model.head.own.axle).eq(way), as_num(1, COUNT), 0)
        return of.num(kept).eq(ite(more > most, as_num(most, COUNT), more))

    yield _held(
        "a cycle adds up its samples",
        added(own.axles_upwards, UP) & added(own.axles_downwards, DOWN),
        "axles of each direction are counted from 0 at the first sample of a cycle, one more with each that the head counts",
    )
    fault, done = of.bool(machine.flag("cycle_fault")), of.bool(machine.flag("cycle_done"))
    axle, axles = of.num(machine.output("cycle_axle")), of.num(machine.output("cycle_axles"))
    ups, downs, sound = of.num(own.axles_upwards), of.num(own.axles_downwards), done & ~fault
    yield _held(
        "a record has the cycle's axles, or a fault",
        fault.iff(done & _flawed(model))
        & axles.eq(ite(sound, ups + downs, 0))
        & axle.eq(ite(sound & (ups > 0), UP, ite(sound & (downs > 0), DOWN, NO_AXLE))),
        "a record without a fault reports the axles of its cycle with their direction; a record with a fault, and a sample within a cycle, reports none",
    )


def _damped(model: CountingHead) -> Iterator[Property]:
    """Claim that the counter is told of a head that is damped when its cycle ends, and of no other one."""
    of, machine = model.composition.of(model.cycle.machine), model.cycle.machine
    a, b, _ = _some(model)
    done, fault, told = (of.bool(machine.flag(f"cycle_{name}")) for name in ("done", "fault", "damped"))
    yield _held(
        "a head that is damped when its cycle ends is told",
        _mode_is_kept(model) & (done & (a | b)).implies(told),
        "at the last sample of a cycle in which a channel is damped, the counter is told that the head is damped",
    )
    yield _held(
        "a free head is not told as damped",
        told.implies(done & (a | b | fault)),
        "where the counter is told that the head is damped, a channel is damped at the last sample of the cycle, or the cycle is at fault",
    )


def _reached(model: CountingHead) -> Iterator[Property]:
    of, machine = model.composition.of(model.cycle.machine), model.cycle.machine
    yield reachable(
        "axles of a cycle",
        of.bool(machine.flag("cycle_done")) & (of.num(machine.output("cycle_axles")) > 1),
        statement="a cycle with several axles is reported",
        requirements=REQUIREMENTS,
    )
