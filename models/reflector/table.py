"""The transition table of the reflector machine, in order of priority."""

from __future__ import annotations

from collections.abc import Iterator

from safeloc.language.expr import Bool, Expr, Lit, Num, Var, any_of, as_num
from safeloc.language.machine import Transition
from safeloc.language.units import COUNT, MM, NM
from safeloc.models.reflector.cycle import Judged
from safeloc.models.reflector.echo import Recognition
from safeloc.models.reflector.variables import (
    BALISE_CONTRADICTS,
    DRIFT,
    ECHOES_CONTRADICT,
    MISMATCH,
    NO_ERROR,
    NO_SELF_TEST,
    NOT_FOUND,
    ROUTE_CONTRADICTED,
    SENSOR_FAILURE,
    TOLERANCE,
    Parts,
)
from safeloc.models.vocabulary.interval import Interval

Updates = dict[Var, Expr]


def rows(own: Parts, cycle: Judged, mode: tuple[Lit, ...]) -> Iterator[Transition]:
    """All transitions."""
    yield from _failures(own, cycle, mode)
    yield from _self_test(own, cycle, mode)
    yield from _measured(own, cycle, mode)
    yield from _missing(cycle, mode)
    yield from _zones(own, cycle, mode)
    yield from _going_on(own, cycle, mode)


def _failures(own: Parts, cycle: Judged, mode: tuple[Lit, ...]) -> Iterator[Transition]:
    """What takes the position away at once."""
    lost, *located = mode
    view_zone = mode[5:]
    refused = own.contradicted | own.odometer.failed
    yield Transition("nothing to rely on", lost, lost, refused, _drop(cycle, None), ("RFL-D3",), 0)
    for rank, (name, source, when, reason, trace) in enumerate(
        [
            ("route contradicted", tuple(located), own.contradicted, ROUTE_CONTRADICTED, ("RFL-12", "RFL-D5")),
            ("odometer failed", tuple(located), own.odometer.failed, SENSOR_FAILURE, ("RFL-1",)),
            ("balise contradicts", tuple(located), cycle.balise_contradicts, BALISE_CONTRADICTS, ("RFL-5", "RFL-D3")),
            ("echoes contradict each other", view_zone, cycle.overlap_contradicts & ~cycle.started, ECHOES_CONTRADICT,
             ("RFL-D3",)),
            ("measuring error drifts", view_zone, cycle.target.accepted & ~cycle.started & ~cycle.steady, DRIFT,
             ("RFL-D2", "RFL-D3")),
        ]
    ):  # fmt: skip
        yield Transition(name, source, lost, when, _drop(cycle, reason), trace, rank)


def _self_test(own: Parts, cycle: Judged, mode: tuple[Lit, ...]) -> Iterator[Transition]:
    """The reference measurement that a balise starts (RFL-6, RFL-8)."""
    _, unready, reference, *_ = mode
    view = mode[5]
    begun: Updates = {own.procedure: own.balise.identity.value}
    here = cycle.started & cycle.tolerable
    proven = {**cycle.opened(cycle.left_open), **own.track.become(cycle.tested_fix)}
    seen = {**_seen(cycle, cycle.target, own.target.become(own.ahead), own.ahead.position.value), **begun, **proven}
    yield Transition(
        "self-test passed at the balise", mode, view, cycle.started & cycle.passed, seen, ("RFL-5", "RFL-6"), 5
    )
    yield Transition(
        "self-test failed at the balise", mode, unready, here & cycle.failed, {**_unready(cycle, MISMATCH), **begun},
        ("RFL-6", "RFL-D3"), 5,
    )  # fmt: skip
    waiting: Updates = {
        **_unready(cycle, NO_SELF_TEST),
        **own.target.become(own.ahead),
        **begun,
        own.reference: cycle.reference,
        own.search_from: own.balise.search.value_or(as_num(0, MM)),
        own.run: cycle.run,
        **own.anchor.become(cycle.begins_at),
    }
    unseen = here & ~cycle.target.accepted
    exact = cycle.testable(cycle.begins_at)
    yield Transition("reference measurement begins", mode, reference, unseen & exact, waiting, ("RFL-6",), 5)
    yield Transition(
        "balise too coarse for a self-test", mode, unready, unseen & ~exact, {**_unready(cycle, NO_SELF_TEST), **begun},
        ("RFL-6",), 5,
    )  # fmt: skip
    again = {**_seen(cycle, cycle.target, {}, own.target.position), **proven}
    yield Transition("self-test passed", reference, view, cycle.passed & ~cycle.started, again, ("RFL-6", "RFL-8"), 6)
    yield Transition(
        "self-test failed", reference, unready, cycle.failed & cycle.tolerable & ~cycle.started, _unready(cycle, MISMATCH),
        ("RFL-6", "RFL-D3"), 6,
    )  # fmt: skip


def _measured(own: Parts, cycle: Judged, mode: tuple[Lit, ...]) -> Iterator[Transition]:
    """A reflector is measured."""
    search, view, coast, passing = mode[4:]
    target, ahead = cycle.target.accepted & ~cycle.started, cycle.ahead.accepted & ~cycle.started
    found = _seen(cycle, cycle.target, {}, own.target.position)
    tracked = {
        **_measure(cycle, cycle.target),
        **cycle.anchor_on(_charged(cycle, cycle.target.bare)),
        own.recognised: False,
    }
    other = _seen(cycle, cycle.ahead, own.target.become(own.ahead), own.ahead.position.value)
    yield Transition("reflector found", search, view, target, found, ("RFL-1", "RFL-3", "RFL-10"), 6)
    yield Transition(
        "reflector tracked", (view, coast, passing), view, target, tracked,
        ("RFL-2", "RFL-3", "RFL-D2"), 6,
    )  # fmt: skip
    yield Transition(
        "next reflector takes over", (view, coast, passing), view, ahead, other,
        ("RFL-1", "RFL-3", "RFL-10"), 7,
    )  # fmt: skip
    yield Transition("tolerance exceeded", mode[1:], mode[0], ~cycle.tolerable, _drop(cycle, TOLERANCE), ("RFL-1",), 8)
    yield Transition(
        "self-test too long ago", mode[3:], mode[1], cycle.outdated, _unready(cycle, NO_SELF_TEST), ("RFL-6",), 8
    )
    yield Transition(
        "self-test grows too coarse",
        (mode[2],),
        mode[1],
        cycle.too_coarse,
        _unready(cycle, NO_SELF_TEST),
        ("RFL-6",),
        8,
    )


def _missing(cycle: Judged, mode: tuple[Lit, ...]) -> Iterator[Transition]:
    """A reflector is not where the map has it (RFL-D3)."""
    _, unready, reference, odometry, search, *_ = mode
    ended = _unready(cycle, NOT_FOUND)
    yield Transition(
        "reference reflector not found", reference, unready, cycle.reference_over, ended, ("RFL-6", "RFL-D3"), 9
    )
    yield Transition("reflector not found", search, unready, cycle.search_over, ended, ("RFL-D3",), 9)
    yield Transition("reflector passed unseen", odometry, unready, cycle.passed_unseen, ended, ("RFL-D3",), 9)


def _zones(own: Parts, cycle: Judged, mode: tuple[Lit, ...]) -> Iterator[Transition]:
    """From zone to zone without a measurement."""
    _, _, _, odometry, search, view, coast, passing = mode
    sought = {**_hold(cycle), **own.target.become(own.ahead)}
    none = {**_hold(cycle), **own.target.nothing()}
    left = {**none, **own.anchor.nothing(), own.pauses: 0, own.misses: 0}
    kept = {**_hold(cycle), **cycle.anchor_on(cycle.by_radar)}
    fresh: Updates = {own.pauses: as_num(0, COUNT), own.misses: as_num(0, COUNT)}
    yield Transition("search zone begins", odometry, search, cycle.search_opens, sought, ("RFL-1", "RFL-8"), 10)
    yield Transition("search zone left", search, odometry, cycle.search_left, none, ("RFL-8",), 10)
    yield Transition("too close", (view, coast), passing, cycle.too_close, {**kept, **fresh}, ("RFL-D2",), 10)
    yield Transition("reflector passed", passing, odometry, cycle.gone_by, left, ("RFL-D2",), 10)
    yield Transition("backs away", passing, coast, ~cycle.too_close, {**kept, **fresh}, ("RFL-D2",), 11)
    yield Transition("reflector lost", (view, coast), odometry, cycle.lost, left, ("RFL-D2",), 11)
    paused, missed = {**kept, own.pauses: own.pauses + 1}, {**kept, own.misses: own.misses + 1}
    yield Transition("measurement pauses", (view, coast), coast, ~own.frame, paused, ("RFL-D2",), 12)
    yield Transition("echo missing", (view, coast), coast, own.frame, missed, ("RFL-D2",), 12)
    yield Transition("passing goes on", passing, passing, set=kept, requirements=("RFL-D2",), rank=12)


def _going_on(own: Parts, cycle: Judged, mode: tuple[Lit, ...]) -> Iterator[Transition]:
    """Nothing happened but distance."""
    lost, unready, reference, odometry, search, *_ = mode
    hold = _hold(cycle)
    waiting = {**hold, **cycle.untested(), **own.anchor.become(cycle.anchored), own.run: cycle.run}
    yield Transition(
        "reference measurement goes on", reference, reference, set=waiting, requirements=("RFL-6",), rank=13
    )
    yield Transition("search goes on", search, search, set=hold, requirements=("RFL-1", "RFL-8"), rank=13)
    yield Transition("odometry zone", odometry, odometry, set=hold, requirements=("RFL-1",), rank=13)
    idle = {**hold, **cycle.untested()}
    yield Transition("not ready", unready, unready, set=idle, requirements=("RFL-D3",), rank=13)
    placed = _unready(cycle, NO_SELF_TEST)
    yield Transition(
        "balise without self-test", lost, unready, own.balise.read & cycle.tolerable, placed, ("RFL-5",), 13
    )
    yield Transition("wait for a balise", lost, lost, set=_drop(cycle, None), requirements=("RFL-5",), rank=14)


# ------------------------------------------------------------------ updates


def _unmeasured(own: Parts) -> Updates:
    """Nothing was measured in this cycle."""
    lengths: Updates = dict.fromkeys((own.range, own.range_error, own.lateral), as_num(0, MM))
    return {**lengths, own.recognised: _false()}


def _false() -> Bool:
    return any_of(())


def _hold(cycle: Judged) -> Updates:
    """Odometry goes on from the last position, or from the balise."""
    return {**cycle.listen(), **cycle.own.track.become(cycle.held), **_unmeasured(cycle.own)}


def _measure(cycle: Judged, by: Recognition) -> Updates:
    """The position is the measured one, with the measurement's own margins."""
    own = cycle.own
    return {
        **cycle.listen(),
        **own.track.become(by.fix),
        own.range: by.range,
        own.range_error: by.error,
        own.lateral: by.lateral,
        own.pauses: as_num(0, COUNT),
        own.misses: as_num(0, COUNT),
        own.error: NO_ERROR,
    }


def _charged(cycle: Judged, fix: Interval) -> Interval:
    """A measured interval to run on from."""
    return fix.widened(as_num(cycle.own.odometer.constant_nm, NM))


def _seen(cycle: Judged, by: Recognition, target: Updates, place: Num) -> Updates:
    """A reflector is recognised: a new view zone begins."""
    own = cycle.own
    return {
        **_measure(cycle, by),
        **target,
        **own.anchor.become(_charged(cycle, by.bare)),
        **_no_reference(own),
        own.found: place,
        own.recognised: any_of([True]),
    }


def _unready(cycle: Judged, why: Num) -> Updates:
    """No precise positioning until another balise: odometry alone."""
    own = cycle.own
    return {
        **_hold(cycle),
        **cycle.untested(),
        **own.target.nothing(),
        **own.anchor.nothing(),
        **_no_reference(own),
        own.found: _none_found(own),
        own.pauses: as_num(0, COUNT),
        own.misses: as_num(0, COUNT),
        own.error: why,
    }


def _drop(cycle: Judged, why: Lit | None) -> Updates:
    """The position is gone; without a reason the one that stands stays."""
    own = cycle.own
    return {
        **_unready(cycle, own.error if why is None else why),
        **own.track.nothing(),
        own.procedure: as_num(0, COUNT),
    }


def _no_reference(own: Parts) -> Updates:
    return dict.fromkeys((own.reference, own.search_from, own.run), as_num(0, MM))


def _none_found(own: Parts) -> Num:
    return as_num(own.found.low, MM)
