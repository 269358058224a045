"""Properties of a train's entry record (FVA-3, FVA-4, FVA-5; as a device FVA-12, FVA-13, FVA-14).

The truth is counted upwards along the line; a record is counted in the direction in which it reports the train as coming.
"""

from __future__ import annotations

from collections.abc import Iterator

from safeloc.language.expr import Bool, Lit, Num, abs_, all_of, any_of, as_num, before, between, exact_to, ite, maximum
from safeloc.language.spec import Property, reachable
from safeloc.language.units import COUNT, MM_S, MS, NM, UM, UM_S
from safeloc.models.axle_counter import AxleCounter
from safeloc.models.axle_counter import passage as p
from safeloc.models.axle_counter.passage import Parts
from safeloc.models.axle_head import DOWN, NO_AXLE, UP
from safeloc.properties import late_axles
from safeloc.properties.claims import Claims

REQUIREMENTS = ("FVA-3", "FVA-5", "FVA-12", "FVA-14")
LAW = (
    "heads without a fault report every axle, or stay damped, and true bounds of its speed; trains keep to their traction and "
    "brakes, and follow each other at the headway; the input that a passage is over is true"
)


def properties(model: AxleCounter) -> list[Property]:
    """Return the properties: a sound record is true; a passage with any flaw gives none."""
    return [
        *_truth(model),
        *_within_bounds(model),
        *late_axles.claims(model, _SAFE, _CLAIMS),
        *_exact(model),
        *_narrow_speeds(model),
        *_narrow_runs(model),
        *_narrow_from_the_first(model),
        *_spoils(model),
        *_too_long(model),
        *_spoilt(model),
        *_damped(model),
        *_free(model),
        *_pause(model),
        *_flaws(model),
        *_no_passage(model),
        *_records(model),
        *_recorded(model),
    ]


_CLAIMS = Claims(REQUIREMENTS, LAW)
_held, _lawful = _CLAIMS.for_all_inputs, _CLAIMS.lawful
_SAFE = Claims(("FVA-4", "FVA-13"), LAW)


# ------------------------------------------------------------------ a sound record


def _truth(model: AxleCounter) -> Iterator[Property]:
    machine, own = model.machine, model.own
    sound, direction = machine.flag("record_sound"), machine.output("record_direction")
    gap = Lit(own.config.axle_gap_mm * 1_000_000, NM)
    yield _lawful(
        "count is true",
        sound.implies(machine.output("record_axles").eq(own.axles)),
        "a sound record holds the number of axles that passed",
    )
    yield _lawful(
        "direction is true",
        sound.implies(direction.eq(ite(own.last_axle_upwards, UP, DOWN))),
        "a sound record reports the direction in which the train passed",
    )
    yield _lawful(
        "the whole train has passed",
        sound.implies(late_axles.ahead(model, own.run - own.length) > gap),
        "a record is made only when the train has run farther since its last axle than two axles are apart",
    )


def _within_bounds(model: AxleCounter) -> Iterator[Property]:
    """Claim that the bounds of a sound record contain the truth."""
    machine, own = model.machine, model.own
    bounds = {"length": ("um", own.length), "speed": ("mm_s", own.speed), "run": ("um", own.run)}
    meant = {
        "length": "the length from first to last axle, whatever the train's speed did",
        "speed": "the speed of its cycle",
        "run": "how far the first axle is beyond the counter",
    }
    for name, (unit, truth) in bounds.items():
        low, high = (machine.output(f"record_{name}_{end}_{unit}") for end in ("low", "high"))
        finer = UM_S if name == "speed" else NM
        yield _lawful(
            f"{name if name != 'run' else 'place'} is true",
            machine.flag("record_sound").implies(
                between(exact_to(low, finer), late_axles.ahead(model, truth), exact_to(high, finer))
            ),
            f"a sound record's bounds contain {meant[name]}",
        )


def _exact(model: AxleCounter) -> Iterator[Property]:
    machine, own = model.machine, model.own
    wide = machine.output("record_length_high_um") - machine.output("record_length_low_um")
    yield _held(
        "length is exact enough",
        machine.flag("record_sound").implies(wide <= Lit(own.config.length_spread_mm * 1_000, UM)),
        "a sound record's length is never wider than permitted",
    )


def _change_mm_s(own: Parts) -> int:
    """Return the greatest change of speed in a cycle, in whole mm/s, rounded up."""
    return -(own.config.change_mm_s2 * own.config.period_ms // -1_000)


def _goes_on(model: AxleCounter) -> Bool:
    """Return whether a passage of the cycle before goes on, or ends with its record."""
    _, _, passing, done = model.machine.modes
    return before(model.machine.mode).eq(passing) & model.machine.mode.one_of(passing, done)


def _begins(model: AxleCounter) -> Bool:
    """Return whether the first axle of a passage passes in this cycle."""
    _, _, passing, _ = model.machine.modes
    return before(model.machine.mode).ne(passing) & model.machine.mode.eq(passing)


def _narrow_speeds(model: AxleCounter) -> Iterator[Property]:
    own, change = model.own, _change_mm_s(model.own)
    measured = own.axle.ne(NO_AXLE) & (_goes_on(model) | _begins(model))
    yield _held(
        "the speed widens by traction and brakes alone",
        _goes_on(model).implies(
            (before(own.speed_low) - own.speed_low <= change) & (own.speed_high - before(own.speed_high) <= change)
        ),
        "in one cycle the bounds of the speed move apart by no more than a train can change its speed, either way",
    )
    yield _held(
        "the speed is as exact as measured",
        measured.implies(
            (own.axle_speed_low.value - own.speed_low <= change)
            & (own.speed_high - own.axle_speed_high.value <= change)
        ),
        "after an axle the bounds of the speed are those of the axle, apart by no more than a train can change its speed since",
    )


def _narrow_runs(model: AxleCounter) -> Iterator[Property]:
    own, period, change = model.own, Lit(model.own.config.period_ms, MS), _change_mm_s(model.own)
    least, most = ((before(own.speed_low) - change) * period, (before(own.speed_high) + change) * period)
    yield _held(
        "the run widens by the speed alone",
        _goes_on(model).implies(
            (own.run_low - before(own.run_low) >= least) & (own.run_high - before(own.run_high) <= most)
        ),
        "in one cycle the bounds of the run move no farther than the bounds of the speed permit",
    )
    since = own.past_low - ite(own.axle.eq(NO_AXLE), before(own.past_low), 0)
    yield _held(
        "the run since the last axle widens by the speed alone",
        _goes_on(model).implies((since >= least) | (own.axle.ne(NO_AXLE) & (since >= 0))),
        "the bound of the run since the last axle falls no faster than the lower bound of the speed permits",
    )
    yield _held(
        "the length ends with the last axle",
        (_goes_on(model) & own.axle.ne(NO_AXLE)).implies(
            any_of(own.length_low >= low for low in (own.run_low, before(own.run_low)))
            & any_of(own.length_high <= high for high in (own.run_high, before(own.run_high)))
        ),
        "with each axle the bounds of the length are those of the run in its cycle",
    )


def _narrow_from_the_first(model: AxleCounter) -> Iterator[Property]:
    own, period = model.own, Lit(model.own.config.period_ms, MS)
    lows, highs = (own.run_low, own.length_low, own.past_low), (own.run_high, own.length_high)
    yield _held(
        "the run begins in the cycle of the first axle",
        _begins(model).implies(
            all_of((low >= 0) | (low >= own.speed_low * period) for low in lows)
            & all_of((high <= 0) | (high <= own.speed_high * period) for high in highs)
        ),
        "after the first axle run and length are no wider than a whole cycle at the bounds of the speed",
    )


# ------------------------------------------------------------------ spoilt passages


def _other_way(own: Parts) -> Bool:
    return own.axle.ne(NO_AXLE) & own.axle.ne(before(own.direction))


def _longest(own: Parts) -> Num:
    return Lit(own.config.length_limit_mm * 1_000, UM)


def _has_passed(model: AxleCounter) -> Bool:
    """Return the condition that a passage goes on without an axle, and its train has certainly run farther than two axles are apart."""
    own, passing = model.own, model.machine.modes[2]
    change, top = _change_mm_s(own), own.config.max_speed_mm_s
    slowest = maximum(before(own.speed_low), change - top) - change
    past = before(own.past_low) + slowest * Lit(own.config.period_ms, MS)
    return (
        before(model.machine.mode).eq(passing) & own.axle.eq(NO_AXLE) & (past > Lit(own.config.axle_gap_mm * 1_000, UM))
    )


def _due(model: AxleCounter) -> Bool:
    return _has_passed(model) & ~model.own.fault


def _late(own: Parts) -> Bool:
    """Return the condition that the headway may have passed since the last axle, which may lie at the edge of its cycle, as this one."""
    return (before(own.pause) + 2) * own.config.period_ms > own.config.headway_ms


def _spoils(model: AxleCounter) -> Iterator[Property]:
    """Claim the events that spoil a passage."""
    machine, own = model.machine, model.own
    spoilt, _, passing, _ = machine.modes
    mode, before_ = machine.mode, before(machine.mode)
    yield _held(
        "a fault spoils",
        own.fault.implies(mode.eq(spoilt)),
        "disagreeing channels or a disturbed head: no record, from the same cycle on",
    )
    yield _held(
        "turning spoils",
        (before_.eq(passing) & _other_way(own)).implies(mode.eq(spoilt)),
        "an axle in the other direction spoils the passage in the same cycle",
    )
    yield _held(
        "an axle after the headway spoils",
        (before_.eq(passing) & own.axle.ne(NO_AXLE) & _late(own)).implies(mode.eq(spoilt)),
        "an axle that comes so long after the last one that it may be another train's spoils the passage in the "
        "same cycle",
    )


def _too_long(model: AxleCounter) -> Iterator[Property]:
    own = model.own
    yield _held(
        "no longer train than the longest goes on",
        _goes_on(model).implies(before(own.length_high) <= _longest(own)),
        "a passage that may be longer than the longest train is spoilt in the next cycle",
    )


def _spoilt(model: AxleCounter) -> Iterator[Property]:
    """Claim that a passage stays spoilt until it is over."""
    machine, own = model.machine, model.own
    spoilt, _, _, done = machine.modes
    mode, before_, sound = machine.mode, before(machine.mode), machine.flag("record_sound")
    yield _held(
        "spoilt until over",
        (before_.eq(spoilt) & mode.ne(spoilt)).implies(own.over & mode.eq(done) & ~sound),
        "the rest of a spoilt passage is never counted as another train",
    )
    yield _held(
        "the end of a spoilt passage is reported",
        all_of([before_.eq(spoilt), own.over, own.axle.eq(NO_AXLE), ~own.fault]).implies(machine.flag("record_ready")),
        "when an input reports that a spoilt passage is over, in a cycle without an axle or a fault, the machine "
        "reports a passage without a record in that cycle",
    )


def _damped(model: AxleCounter) -> Iterator[Property]:
    """Claim that no record comes from a head that is damped."""
    machine, own = model.machine, model.own
    spoilt, sound = machine.modes[0], machine.flag("record_sound")
    yield _SAFE.for_all_inputs(
        "no record while the head is damped",
        own.damped.implies(~sound),
        "in a cycle at whose end the head is damped there is no sound record",
    )
    yield _SAFE.for_all_inputs(
        "a head that is damped when the train has passed spoils",
        (_due(model) & own.damped).implies(machine.mode.eq(spoilt) & own.flaw.one_of(p.HEAD_DAMPED, p.TOO_LONG)),
        "where the record would be due and the head is damped, the passage is spoilt in that cycle, with its reason",
    )
    yield _SAFE.lawful(
        "an axle that a damped head has missed is in no record",
        own.missed.implies(~sound),
        "where a channel has stayed damped under an axle and the head has left it uncounted, no sound record comes",
    )


def _free(model: AxleCounter) -> Iterator[Property]:
    """Claim that a free head gives the record that is due."""
    own, done = model.own, model.machine.modes[3]
    followed = (before(own.length_high) <= _longest(own)) & ~_far_off(own)
    yield _SAFE.for_all_inputs(
        "a free head gives the record that is due",
        (_due(model) & ~own.damped & followed).implies(
            model.machine.mode.eq(done) & own.flaw.one_of(p.SOUND, p.LENGTH_UNKNOWN)
        ),
        "where the train has passed, the head is free and not at fault, and the passage is not too long, the record comes in that cycle, "
        "unless its length is not known well enough",
    )


def _pause(model: AxleCounter) -> Iterator[Property]:
    machine, own = model.machine, model.own
    _, _, passing, _ = machine.modes
    mode, before_ = machine.mode, before(machine.mode)
    longer = ite(before(own.pause) >= own.pause.high, before(own.pause), before(own.pause) + 1)
    yield _held(
        "the pause is counted",
        (before_.eq(passing) & mode.eq(passing)).implies(
            own.pause.eq(ite(own.axle.eq(NO_AXLE), longer, as_num(0, COUNT)))
        ),
        "the pause begins anew with every axle, and grows by one cycle in every other cycle",
    )


def _flaws(model: AxleCounter) -> Iterator[Property]:
    """Claim that a spoilt passage has a reason, and the right one."""
    machine, own = model.machine, model.own
    spoilt, _, passing, _ = machine.modes
    mode, before_ = machine.mode, before(machine.mode)
    yield _held("a flaw is reported", mode.eq(spoilt).implies(own.flaw.ne(p.SOUND)), "a spoilt passage has a reason")
    newly = before_.ne(spoilt) & mode.eq(spoilt)
    yield _held(
        "a passage is spoilt only for the reported reason",
        newly.implies(any_of(own.flaw.eq(flaw) & cause for flaw, cause in _causes(model).items())),
        "a passage is spoilt only by what its flaw says",
    )
    again = all_of([before_.eq(passing), own.axle.eq(before(own.direction)), own.axle.ne(NO_AXLE), ~_unknown(own)])
    yield _held(
        "speeds that exclude each other spoil the passage",
        (again & _apart(own)).implies(mode.eq(spoilt)),
        "another axle of the train whose speed no train with this traction and brakes can have ends the passage without a record",
    )
    yield _lawful(
        "true speeds never contradict each other",
        newly.implies(own.flaw.ne(p.SPEED_CONTRADICTED) | own.missed),
        "the bounds of the speeds of a train that keeps to its traction and brakes always overlap, as long as the head has counted its axles",
    )
    yield _held(
        "an unspoilt passage goes on",
        (before_.eq(passing) & own.axle.eq(NO_AXLE) & ~own.fault).implies(
            mode.ne(spoilt) | own.flaw.eq(p.TOO_LONG) | (own.flaw.eq(p.HEAD_DAMPED) & own.damped)
        ),
        "in a cycle without an axle and without a fault only its length, or a damped head, can spoil a passage",
    )


def _no_passage(model: AxleCounter) -> Iterator[Property]:
    """Claim that neither a direction nor a flaw is left over from an earlier passage."""
    machine = model.machine
    spoilt, idle, passing, done = machine.modes
    mode, direction, flaw = machine.mode, machine.output("record_direction"), machine.output("record_flaw")
    spoilt_before = mode.eq(done) & flaw.ne(p.SOUND) & flaw.ne(p.LENGTH_UNKNOWN)
    yield _held(
        "no direction without a passage",
        (mode.one_of(spoilt, idle) | spoilt_before).implies(direction.eq(NO_AXLE)),
        "without a train on the counter, and of a spoilt passage, no direction is reported",
    )
    yield _held(
        "no flaw without a spoilt passage",
        mode.one_of(idle, passing).implies(flaw.eq(p.SOUND)),
        "without a train on the counter, and while an undisturbed passage goes on, no flaw is reported",
    )


def _causes(model: AxleCounter) -> dict[Lit, Bool]:
    own, config = model.own, model.own.config
    counted, unknown = own.axle.ne(NO_AXLE), _unknown(own)
    return {
        p.HEAD_FAULT: own.fault,
        p.NO_SPEED: counted & unknown,
        p.TURNED: _other_way(own),
        p.TOO_MANY: before(own.axles_counted) + own.axles_in_cycle > config.axle_limit,
        p.TOO_LONG: (before(own.length_high) > _longest(own)) | _far_off(own),
        p.SPEED_CONTRADICTED: counted & ~unknown & _apart(own),
        p.MAYBE_ANOTHER_TRAIN: counted & _late(own),
        p.HEAD_DAMPED: own.damped & _has_passed(model),
    }


def _unknown(own: Parts) -> Bool:
    """Return the condition that no speed of the axle, or none that can be, is given."""
    low, high = own.axle_speed_low, own.axle_speed_high
    return ~low.present | ~high.present | (low.value > high.value)


def _apart(own: Parts) -> Bool:
    """Return the condition that no speed is in the axle's bounds, in those known before and in the line's, each after a cycle of traction or brake."""
    change, most = own.config.change_mm_s, own.config.max_speed_mm_s
    sides = (
        (own.axle_speed_low.value, own.axle_speed_high.value),
        (before(own.speed_low), before(own.speed_high)),
        (Lit(change - most, MM_S), Lit(most - change, MM_S)),  # of any moment, so without the change
    )
    return any_of(low - high > 2 * change for low, _ in sides for _, high in sides)


def _far_off(own: Parts) -> Bool:
    """Return the condition that a bound of the run may leave the followed range within this cycle."""
    farthest = Lit((own.config.length_limit_mm + own.config.axle_gap_mm) * 1_000, UM)
    return any_of(abs_(before(bound)) > farthest for bound in (own.run_low, own.run_high, own.past_low))


# ------------------------------------------------------------------ conditions of a record


def _records(model: AxleCounter) -> Iterator[Property]:
    """Claim the conditions of a sound record."""
    machine, own = model.machine, model.own
    _, _, passing, _ = machine.modes
    before_, sound = before(machine.mode), machine.flag("record_sound")
    bounds = ("length_low_um", "length_high_um", "speed_low_mm_s", "speed_high_mm_s", "run_low_um", "run_high_um")
    numbers = [machine.output(f"record_{name}") for name in ("axles", *bounds)]
    yield _held(
        "a record needs a passage",
        sound.implies(before_.eq(passing) & (own.axles_counted > 0)),
        "a sound record is made only at the end of an undisturbed passage",
    )
    yield _held(
        "nothing without a record",
        (~sound).implies(all_of(number.eq(0) for number in numbers)),
        "without a sound record all its numbers are zero",
    )


def _recorded(model: AxleCounter) -> Iterator[Property]:
    """Claim the cycle in which the record comes."""
    machine, own = model.machine, model.own
    _, _, passing, done = machine.modes
    mode, before_, sound = machine.mode, before(machine.mode), machine.flag("record_sound")
    ready = machine.flag("record_ready")
    room = 2 * own.config.late_mm
    known = own.length_high - own.length_low + room * 1_000 <= Lit(own.config.length_spread_mm * 1_000, UM)
    yield _held(
        "a passage ends with its record",
        (before_.eq(passing) & mode.eq(done)).implies(
            ready & sound.iff(known) & (sound | own.flaw.eq(p.LENGTH_UNKNOWN))
        ),
        "a passage that was not spoilt ends with a sound record, or its length is not known well enough",
    )
    gap = Lit(own.config.axle_gap_mm * 1_000, UM)
    yield _held(
        "a record comes as soon as the train has passed",
        mode.eq(passing).implies(own.past_low <= gap),
        "the record comes in the cycle in which the train has certainly run farther than two axles are apart",
    )
    yield reachable(
        "record", sound & (own.axles_counted > 1), statement="a train gives a sound record", requirements=REQUIREMENTS
    )
