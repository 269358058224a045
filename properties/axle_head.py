"""Properties of a counting head (FVA-4, FVA-5; as a device FVA-13, FVA-14)."""

from __future__ import annotations

from collections.abc import Iterator
from functools import partial

from safeloc.language.expr import Bool, NumVar, before, was
from safeloc.language.spec import Property, always, previous, reachable, since
from safeloc.models.axle_head import AxleHead
from safeloc.models.axle_head.variables import DOWN, NO_AXLE, UP, Parts
from safeloc.properties.claims import Claims

REQUIREMENTS = ("FVA-4", "FVA-5", "FVA-13", "FVA-14")
LAW = "one wheel at a time, sampled often enough, and no false damping of a channel that is alive"
under_assumption = partial(always, requirements=REQUIREMENTS, assumption=LAW)


def properties(model: AxleHead) -> list[Property]:
    """Return the properties: every axle is counted once, in its direction, and nothing else is."""
    return [
        *_wheels(model),
        *_sequences(model),
        *_disturbs(model),
        *_alive_channels(model),
        *_disturbed(model),
        *_reached(model),
    ]


_held = Claims(REQUIREMENTS).for_all_inputs


def _end_um(own: Parts) -> int:
    """Return the place where a wheel that rolls up leaves channel B, um."""
    return 1_000 * (own.config.spacing_mm + own.config.overlap_mm + own.config.spacing_mm)


def _on(own: Parts, wheel: NumVar) -> Bool:
    return (wheel >= 0) & (wheel < _end_um(own))


def _hears_the_wheel(own: Parts) -> Bool:
    """Return the condition that the channels are alive, and damped by the wheel that is there, and by nothing else."""
    begins, ends = own.config.spacing_mm * 1_000, (own.config.spacing_mm + own.config.overlap_mm) * 1_000
    on = _on(own, own.wheel)
    by_wheel = own.channel_a_damped.iff(on & (own.wheel < ends)) & own.channel_b_damped.iff(on & (own.wheel >= begins))
    return by_wheel & _alive(own)


def _alive(own: Parts) -> Bool:
    """Return the condition that both channels are alive."""
    return own.channel_a_alive & own.channel_b_alive


def _wheels(model: AxleHead) -> Iterator[Property]:
    """Claim count and damping against the true place of the wheel."""
    machine, own = model.machine, model.own
    on, above, below = _on(own, before(own.wheel)), own.wheel >= _end_um(own), own.wheel < 0
    through_up, through_down = on & above & was(own.from_low), on & below & ~was(own.from_low)
    disturbed, was_disturbed = machine.flag("disturbed"), before(machine.mode).eq(machine.modes[-1])
    yield under_assumption(
        "every axle is counted",
        (~disturbed & ~was_disturbed).implies(own.axle.eq(UP).iff(through_up) & own.axle.eq(DOWN).iff(through_down)),
        statement="an axle is counted upwards in exactly the sample in which a wheel that came from below has left above; "
        "and downwards the other way round; unless the head is disturbed in that sample, or was in the one before",
    )
    yield under_assumption(
        "a wheel that is not counted is told",
        ((through_up & own.axle.ne(UP)) | (through_down & own.axle.ne(DOWN))).implies(machine.flag("may_miss")),
        statement="in a sample in which a wheel has passed that is not counted in its direction, the head tells that it may have missed one",
    )
    yield under_assumption(
        "no disturbance by wheels",
        (_hears_the_wheel(own) & (~was_disturbed | ~_on(own, own.wheel))).implies(~disturbed),
        statement="wheels over channels that are alive, also wheels that turn back on the head, never disturb it; and a disturbance ends where "
        "no wheel is on the head",
    )
    yield under_assumption(
        "damped is a wheel on the head",
        _on(own, own.wheel).implies(machine.flag("damped"))
        & (machine.flag("damped") & ~disturbed).implies(_on(own, own.wheel)),
        statement="the head reports itself as damped while a wheel is on it, and is disturbed where it does so without one",
    )


def _sequences(model: AxleHead) -> Iterator[Property]:
    """Claim the sequences of the channels that count an axle, and those that lead to each mode, so that two steps of induction prove them."""
    own, mode = model.own, model.machine.mode
    free, a_first, both_up, b_last, b_first, both_down, a_last, _ = model.machine.modes
    a, b, alive = own.channel_a_damped, own.channel_b_damped, _alive(own)
    some = a | b
    heard, came = some & alive, ~previous(some | ~alive)
    overlapped, from_a, from_b = (since(heard, heard & begun) for begun in (a & b, a & ~b & came, b & ~a & came))
    is_free = mode.eq(free).implies(~some & alive)
    yield _held(
        "no axle without overlap",
        own.axle.ne(NO_AXLE).implies(previous(overlapped) & ~some & alive)
        & mode.one_of(both_up, b_last, both_down, a_last).implies(overlapped),
        "an axle is counted only when both channels are free again, and were damped together since they were free before, as they "
        "were in each mode of a wheel that is beyond its first channel; both are alive all the while",
    )
    yield _held(
        "an axle comes in at one channel and goes out at the other",
        own.axle.eq(UP).implies(previous(from_a & b & ~a))
        & own.axle.eq(DOWN).implies(previous(from_b & a & ~b))
        & mode.one_of(a_first, both_up, b_last).implies(from_a)
        & mode.one_of(b_first, both_down, a_last).implies(from_b)
        & is_free,
        "an axle upwards damped A alone first and B alone last; an axle downwards the other way round, and so did a wheel "
        "in each mode of one that has come; both channels were alive all the while",
    )


def _alive_channels(model: AxleHead) -> Iterator[Property]:
    """Claim that a channel that is not alive disturbs the head, whatever it tells."""
    machine, own = model.machine, model.own
    yield _held(
        "a channel that is not alive disturbs",
        (~_alive(own)).implies(machine.flag("disturbed")),
        "in a sample in which a channel is not alive, whatever both tell, the head is disturbed",
    )


def _disturbs(model: AxleHead) -> Iterator[Property]:
    """Claim the events that disturb the head."""
    machine, own = model.machine, model.own
    free, *_, disturbed = machine.modes
    mode, is_disturbed = machine.mode, machine.flag("disturbed")
    leap = previous(own.channel_a_damped).iff(~own.channel_a_damped) & previous(own.channel_b_damped).iff(
        ~own.channel_b_damped
    )
    yield _held(
        "unknown direction disturbs",
        (before(mode).eq(free) & own.channel_a_damped & own.channel_b_damped).implies(mode.eq(disturbed)),
        "both channels at once show no direction: the head is disturbed in that sample",
    )
    was_disturbed = before(mode).eq(disturbed)
    yield _held(
        "a step that no wheel makes disturbs",
        (leap & ~was_disturbed).implies(is_disturbed),
        "two channels that change in the same sample, in whatever order, disturb the head in that sample",
    )
    yield _held(
        "nothing else disturbs",
        is_disturbed.implies(leap | ~_alive(own) | (was_disturbed & (own.channel_a_damped | own.channel_b_damped))),
        "the head is disturbed only by such a step or by a channel that is not alive, and only until both channels are alive and free",
    )


def _disturbed(model: AxleHead) -> Iterator[Property]:
    """Claim the outputs of a disturbed head."""
    machine, own = model.machine, model.own
    *_, disturbed = machine.modes
    mode, is_disturbed = machine.mode, machine.flag("disturbed")
    was_disturbed = before(mode).eq(disturbed)
    yield _held(
        "a disturbed head counts nothing",
        (was_disturbed | mode.eq(disturbed)).implies(own.axle.eq(NO_AXLE)),
        "while disturbed, and in the sample in which that ends, no axle is counted",
    )
    yield _held(
        "what may be missed is told while disturbed",
        machine.flag("may_miss").iff(was_disturbed | is_disturbed),
        "while disturbed, and in the sample in which that ends, the head tells that it may have missed an axle; and never otherwise",
    )
    some_wheel = own.channel_a_damped | own.channel_b_damped | is_disturbed
    yield _held(
        "damped unless free and sound",
        machine.flag("damped").iff(some_wheel),
        "the head reports itself as damped exactly while a channel is damped or the head is disturbed: while it "
        "is disturbed, a wheel may stand on it",
    )


def _reached(model: AxleHead) -> Iterator[Property]:
    own = model.own
    yield reachable("axle upwards", own.axle.eq(UP), statement="axles are counted upwards", requirements=REQUIREMENTS)
    yield reachable(
        "axle downwards", own.axle.eq(DOWN), statement="axles are counted downwards", requirements=REQUIREMENTS
    )
