"""The transition table of the reflector machine, in order of priority."""

from __future__ import annotations

from collections.abc import Iterator

from safeloc.language.expr import TRUE, Lit, Num, as_num
from safeloc.language.machine import Transition
from safeloc.language.rows import Updates, together
from safeloc.language.units import MM, NM
from safeloc.models.reflector.cycle import Judgement
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


class _Groups:
    """Named groups of updates, of which rows are joined; no two groups of one row set the same variable.

    every_cycle    in every row: the odometer's gap, and the verdict on each echo
    drifting, tested, untested  open_long and open_short: with the drift of this cycle, as a self-test that passes leaves them, 0
    held, nowhere  track: the interval that counts without an echo, none
    unmeasured     range, range_error, lateral and recognised: no measurement in this cycle
    next_target, no_target      target: the map's next reflector, none
    kept_anchor, no_anchor      anchor: run on without an echo, none
    no_reference   reference, search_from and run: no self-test is waiting for its reflector
    nothing_found  found: no reflector since the last balise
    counted_anew   pauses and misses: 0
    """

    def __init__(self, own: Parts, cycle: Judgement) -> None:
        self._own, self._cycle = own, cycle
        verdicts: Updates = {one.slot.last_verdict: one.verdict for one in cycle.target.judgements}
        further: Updates = {one.slot.last_verdict_for_next: one.verdict for one in cycle.ahead.judgements}
        self.every_cycle = together({own.odometer.gap: own.odometer.gap_after}, verdicts, further)
        self.drifting = self._opened(cycle.open)
        self.tested = self._opened(cycle.left_open)
        self.untested = self._opened((as_num(0, NM), as_num(0, NM)))
        self.held, self.nowhere = own.track.become(cycle.held), own.track.nothing()
        self.unmeasured: Updates = {own.range: 0, own.measured_error: 0, own.lateral: 0, own.recognised_now: False}
        self.next_target, self.no_target = own.target.become(own.ahead), own.target.nothing()
        self.kept_anchor = own.anchor.become(cycle.anchor_after(cycle.by_radar))
        self.no_anchor = own.anchor.nothing()
        self.no_reference: Updates = {own.reference: 0, own.search_from: 0, own.run_since_balise: 0}
        self.nothing_found: Updates = {own.found: own.found.low}
        self.counted_anew: Updates = {own.pauses: 0, own.misses: 0}

    def _opened(self, sides: tuple[Num, Num]) -> Updates:
        return {self._own.open_long: sides[0], self._own.open_short: sides[1]}

    def measured(self, by: Recognition) -> Updates:
        """Return the updates of range, range_error and lateral: the measurement of this cycle."""
        own = self._own
        return {own.range: by.range, own.measured_error: by.error, own.lateral: by.lateral}

    @property
    def hold(self) -> Updates:
        """Odometry goes on from the last position, or from the balise; what the self-test left open is set beside it."""
        return together(self.every_cycle, self.held, self.unmeasured)

    @property
    def none_sought(self) -> Updates:
        """Neither reflector nor self-test until another balise; track and measurement are set beside it."""
        reflector = together(self.no_target, self.no_anchor, self.nothing_found)
        return together(self.untested, self.no_reference, reflector, self.counted_anew)

    def seen(self, by: Recognition, place: Num) -> Updates:
        """Return the updates of a new view zone; target, track, and what the self-test left open are set beside them."""
        own = self._own
        zone = own.anchor.become(_to_run_on(self._cycle, by.bare))
        fresh: Updates = {own.found: place, own.recognised_now: True, own.error: NO_ERROR}
        return together(self.every_cycle, self.measured(by), zone, self.no_reference, self.counted_anew, fresh)

    def unready(self, why: Lit) -> Updates:
        """Return the updates of the way into NOT_READY: odometry alone, and no self-test."""
        return together(self.hold, self.none_sought, {self._own.error: why})

    def dropped(self, why: Num) -> Updates:
        """Return the updates of the way into DELOCALIZED: no position, and no balise is remembered."""
        gone: Updates = {self._own.error: why, self._own.procedure_balise: 0}
        return together(self.every_cycle, self.nowhere, self.unmeasured, self.none_sought, gone)


def rows(own: Parts, cycle: Judgement, mode: tuple[Lit, ...]) -> Iterator[Transition]:
    """Yield all rows."""
    groups = _Groups(own, cycle)
    yield from _failures(own, cycle, groups, mode)
    yield from _self_test(own, cycle, groups, mode)
    yield from _measured(own, cycle, groups, mode)
    yield from _withdrawn(cycle, groups, mode)
    yield from _missing(cycle, groups, mode)
    yield from _zones(own, cycle, groups, mode)
    yield from _going_on(own, cycle, groups, mode)


def _failures(own: Parts, cycle: Judgement, groups: _Groups, mode: tuple[Lit, ...]) -> Iterator[Transition]:
    """Yield the rows that withdraw the position at once."""
    lost, *located = mode
    view_zone = mode[5:]
    refused = own.contradicted | own.odometer.failed
    yield Transition("nothing to rely on", lost, lost, refused, groups.dropped(own.error), ("RFL-D3",), 0)
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
        yield Transition(name, source, lost, when, groups.dropped(reason), trace, rank)


def _self_test(own: Parts, cycle: Judgement, groups: _Groups, mode: tuple[Lit, ...]) -> Iterator[Transition]:
    """Yield the rows of the self-test that a balise starts (RFL-6, RFL-8)."""
    _, unready, reference, *_ = mode
    view = mode[5]
    here, unseen = cycle.started & cycle.tolerable, cycle.started & cycle.tolerable & ~cycle.target.accepted
    exact = cycle.testable(cycle.begins_at)
    begun: Updates = {own.procedure_balise: own.balise.identity.value}
    proven = together(groups.tested, own.track.become(cycle.tested_fix))
    at_once = together(groups.seen(cycle.target, own.ahead.position.value), proven, groups.next_target, begun)
    later = together(groups.seen(cycle.target, own.target.position), proven)
    search_from = own.balise.search_from.value_or(as_num(0, MM))
    awaited: Updates = {own.reference: cycle.reference, own.search_from: search_from, own.run_since_balise: cycle.run}
    waiting = together(
        groups.hold, groups.untested, groups.next_target, own.anchor.become(cycle.begins_at), awaited,
        groups.nothing_found, groups.counted_anew, begun, {own.error: NO_SELF_TEST},
    )  # fmt: skip
    wrong_here, coarse = together(groups.unready(MISMATCH), begun), together(groups.unready(NO_SELF_TEST), begun)
    wrong = cycle.failed & cycle.tolerable & ~cycle.started
    yield Transition(
        "self-test passed at the balise", mode, view, cycle.started & cycle.passed, at_once, ("RFL-5", "RFL-6"), 5
    )
    yield Transition(
        "self-test failed at the balise", mode, unready, here & cycle.failed, wrong_here, ("RFL-6", "RFL-D3"), 5
    )
    yield Transition("reference measurement begins", mode, reference, unseen & exact, waiting, ("RFL-6",), 5)
    yield Transition("balise too coarse for a self-test", mode, unready, unseen & ~exact, coarse, ("RFL-6",), 5)
    yield Transition("self-test passed", reference, view, cycle.passed & ~cycle.started, later, ("RFL-6", "RFL-8"), 6)
    yield Transition("self-test failed", reference, unready, wrong, groups.unready(MISMATCH), ("RFL-6", "RFL-D3"), 6)


def _measured(own: Parts, cycle: Judgement, groups: _Groups, mode: tuple[Lit, ...]) -> Iterator[Transition]:
    """Yield the rows of a measured reflector."""
    search, view, coast, passing = mode[4:]
    in_zone = (view, coast, passing)
    target, ahead = cycle.target.accepted & ~cycle.started, cycle.ahead.accepted & ~cycle.started
    found = together(
        groups.seen(cycle.target, own.target.position), groups.drifting, own.track.become(cycle.target.fix)
    )
    tracked = together(
        groups.every_cycle, groups.drifting, own.track.become(cycle.target.fix), groups.measured(cycle.target),
        own.anchor.become(cycle.anchor_after(_to_run_on(cycle, cycle.target.bare))), groups.counted_anew,
        {own.recognised_now: False, own.error: NO_ERROR},
    )  # fmt: skip
    other = together(
        groups.seen(cycle.ahead, own.ahead.position.value), groups.drifting, own.track.become(cycle.ahead.fix),
        groups.next_target,
    )  # fmt: skip
    trace = ("RFL-1", "RFL-3", "RFL-10")
    yield Transition("reflector found", search, view, target, found, trace, 6)
    yield Transition("reflector tracked", in_zone, view, target, tracked, ("RFL-2", "RFL-3", "RFL-D2"), 6)
    yield Transition("next reflector takes over", in_zone, view, ahead, other, trace, 7)


def _withdrawn(cycle: Judgement, groups: _Groups, mode: tuple[Lit, ...]) -> Iterator[Transition]:
    """Yield the rows of an interval, or of a self-test, that has become too uncertain without an echo."""
    lost, unready, reference, *ready = mode
    too_wide, coarse = groups.dropped(TOLERANCE), groups.unready(NO_SELF_TEST)
    yield Transition("tolerance exceeded", mode[1:], lost, ~cycle.tolerable, too_wide, ("RFL-1",), 8)
    yield Transition("self-test too long ago", tuple(ready), unready, cycle.outdated, coarse, ("RFL-6",), 8)
    yield Transition("self-test grows too coarse", (reference,), unready, cycle.too_coarse, coarse, ("RFL-6",), 8)


def _missing(cycle: Judgement, groups: _Groups, mode: tuple[Lit, ...]) -> Iterator[Transition]:
    """Yield the rows of a reflector that is missing at its place on the map (RFL-D3)."""
    _, unready, reference, odometry, search, *_ = mode
    ended = groups.unready(NOT_FOUND)
    yield Transition(
        "reference reflector not found", reference, unready, cycle.reference_over, ended, ("RFL-6", "RFL-D3"), 9
    )
    yield Transition("reflector not found", search, unready, cycle.search_over, ended, ("RFL-D3",), 9)
    yield Transition("reflector passed unseen", odometry, unready, cycle.passed_unseen, ended, ("RFL-D3",), 9)


def _zones(own: Parts, cycle: Judgement, groups: _Groups, mode: tuple[Lit, ...]) -> Iterator[Transition]:
    """Yield the rows from zone to zone without a measurement."""
    _, _, _, odometry, search, view, coast, passing = mode
    hold, seen = together(groups.hold, groups.drifting), (view, coast)
    sought, none = together(hold, groups.next_target), together(hold, groups.no_target)
    left = together(none, groups.no_anchor, groups.counted_anew)
    kept = together(hold, groups.kept_anchor)
    anew = together(kept, groups.counted_anew)
    paused, missed = together(kept, {own.pauses: own.pauses + 1}), together(kept, {own.misses: own.misses + 1})
    yield Transition("search zone begins", odometry, search, cycle.search_opens, sought, ("RFL-1", "RFL-8"), 10)
    yield Transition("search zone left", search, odometry, cycle.search_left, none, ("RFL-8",), 10)
    yield Transition("too close", seen, passing, cycle.too_close, anew, ("RFL-D2",), 10)
    yield Transition("reflector passed", passing, odometry, cycle.gone_by, left, ("RFL-D2",), 10)
    yield Transition("backs away", passing, coast, ~cycle.too_close, anew, ("RFL-D2",), 11)
    yield Transition("reflector lost", seen, odometry, cycle.lost, left, ("RFL-D2",), 11)
    yield Transition("measurement pauses", seen, coast, ~own.frame_present, paused, ("RFL-D2",), 12)
    yield Transition("echo missing", seen, coast, own.frame_present, missed, ("RFL-D2",), 12)
    yield Transition("passing goes on", passing, passing, TRUE, kept, ("RFL-D2",), 12)


def _going_on(own: Parts, cycle: Judgement, groups: _Groups, mode: tuple[Lit, ...]) -> Iterator[Transition]:
    """Yield the rows of a cycle in which the vehicle only ran on."""
    lost, unready, reference, odometry, search, *_ = mode
    hold, idle = together(groups.hold, groups.drifting), together(groups.hold, groups.untested)
    waiting = together(idle, own.anchor.become(cycle.anchored), {own.run_since_balise: cycle.run})
    placed, wait = groups.unready(NO_SELF_TEST), groups.dropped(own.error)
    read = own.balise.read & cycle.tolerable
    yield Transition("reference measurement goes on", reference, reference, TRUE, waiting, ("RFL-6",), 13)
    yield Transition("search goes on", search, search, TRUE, hold, ("RFL-1", "RFL-8"), 13)
    yield Transition("odometry zone", odometry, odometry, TRUE, hold, ("RFL-1",), 13)
    yield Transition("not ready", unready, unready, TRUE, idle, ("RFL-D3",), 13)
    yield Transition("balise without self-test", lost, unready, read, placed, ("RFL-5",), 13)
    yield Transition("wait for a balise", lost, lost, TRUE, wait, ("RFL-5",), 14)


def _to_run_on(cycle: Judgement, fix: Interval) -> Interval:
    """Return a measured interval to run on from: the odometer's one-off constant is added."""
    return fix.widened(as_num(cycle.own.odometer.constant_nm, NM))
