"""One cycle of the reflector machine: the terms that distance, balise reading and echoes give.

Each term is built once; guards and updates share it.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

from safeloc.language.expr import FALSE, Bool, Num, any_of, as_num, between, exact_to, ite, maximum
from safeloc.language.units import MM, NM
from safeloc.models.reflector.echo import Recognition, Situation, recognise
from safeloc.models.reflector.map_data import Reflector
from safeloc.models.reflector.variables import Parts
from safeloc.models.vocabulary.choose import choose
from safeloc.models.vocabulary.interval import Interval


@dataclass(frozen=True, eq=False)
class Zones:
    """Groups of modes in which the machine may be."""

    located: Bool
    ready: Bool
    exact: Bool
    in_view: Bool
    referring: Bool
    searching: Bool


@dataclass(frozen=True, eq=False)
class Judgement:
    """The terms of one cycle.

    predicted  the last interval run on, with the odometer's one-off constant in its margins
    balise     interval that the balise reading gives
    held       interval without an echo: `predicted`, or the balise's where that is narrower
    by_radar   places at which a radar with its systematic error may measure end A, by `held`
    known      interval that a self-test compares the radar with: the balise's, run on since it was read
    open       the most by which the radar may measure too long, and too short, nm: the part that the last self-test could not
               exclude, and the drift since
    stale      `open` exceeds the most that a self-test may leave open: the radar is not precise any longer
    started    a balise reading starts a self-test
    reflector  the reflector that is searched or tracked in this cycle
    reference  prescribed distance from the balise of the self-test to its reflector, mm
    run        measured distance since that balise, mm
    target, ahead  the echoes, judged for that reflector and for the map's next one
    """

    own: Parts
    zones: Zones
    now: Situation
    predicted: Interval
    balise: Interval
    held: Interval
    by_radar: Interval
    known: Interval
    open: tuple[Num, Num]
    stale: Bool
    started: Bool
    reflector: Reflector
    reference: Num
    run: Num
    target: Recognition
    ahead: Recognition

    # ------------------------------------------------------------------ balise

    @cached_property
    def balise_contradicts(self) -> Bool:
        """A balise reading gives an interval that excludes the position."""
        return self.zones.located & self.own.balise.read & ~self.balise.meets(self.predicted)

    # ------------------------------------------------------------------ margins

    @cached_property
    def tolerable(self) -> Bool:
        """The interval without an echo is narrow enough to be kept."""
        return self.held.within(self.own.config.tolerance_nm, self.own.config.position_limit_mm)

    # ------------------------------------------------------------------ the self-test (RFL-6)

    @cached_property
    def reference_holds(self) -> Bool:
        """The measured distance from balise to reflector agrees with the prescribed one; only while `target.accepted`.

        The tolerance is the greatest error of balise, odometer, echo, survey and latencies together: a sound radar always passes.
        """
        fix, known, survey = self.target.fix, self.known, self.own.config.accuracy_nm
        missed = exact_to(self.target.range + self.run - self.own.config.radar_offset_mm - self.reference, NM)
        return between(-(known.above + fix.below + survey), missed, known.below + fix.above + survey)

    @cached_property
    def agrees(self) -> Bool:
        """The reference reflector is measured at the prescribed distance, and at its place on the map."""
        return self.reference_holds & self.target.fix.meets(self.known)

    @cached_property
    def passed(self) -> Bool:
        """The self-test passes: no error of the radar shows."""
        return self.target.accepted & self.agrees

    @cached_property
    def failed(self) -> Bool:
        """The self-test fails: the radar measures wrongly."""
        return self.target.accepted & ~self.agrees

    @cached_property
    def left_open(self) -> tuple[Num, Num]:
        """The most by which the radar may measure too long, and too short, although the self-test passed; nm."""
        fix = self.target.fix
        return self.known.high - fix.low, fix.high - self.known.low

    @cached_property
    def tested_fix(self) -> Interval:
        """The interval of the echo that passed, widened by the radar error that the self-test could not exclude."""
        long, short = self.left_open
        return Interval(self.target.fix.position, self.target.fix.above + long, self.target.fix.below + short)

    @cached_property
    def reference_over(self) -> Bool:
        """A sound radar would have measured the reference reflector by now."""
        limit, search = self.own.config.reference_run_mm, self.own.config.search_run_mm
        searched = self.run > self.own.search_from + search
        return (self.reflector.over(self.held, search) & searched) | ~between(-limit, self.run, limit)

    @cached_property
    def begins_at(self) -> Interval:
        """The balise's interval, to run on from until the reference reflector is measured."""
        return self.balise.widened(self.own.odometer.constant_nm)

    def testable(self, known: Interval) -> Bool:
        """Return whether the interval known without the radar is narrow enough for a self-test."""
        config = self.own.config
        most = config.tolerance_nm + self.own.odometer.constant_nm
        return (known.width <= config.left_open_nm) & known.within(most, config.position_limit_mm)

    @cached_property
    def too_coarse(self) -> Bool:
        """The interval run on since the balise has grown too wide for a self-test."""
        return ~self.testable(self.anchored) & self.tolerable & ~self.started

    @cached_property
    def outdated(self) -> Bool:
        """The last self-test is too long ago: the radar may have drifted by more than the margins may include."""
        return self.stale & self.tolerable & ~self.started

    # ------------------------------------------------------------------ search and view zone

    @cached_property
    def search_over(self) -> Bool:
        """The radar would have measured the target by now."""
        return self.reflector.over(self.held, self.own.config.search_run_mm)

    @cached_property
    def search_left(self) -> Bool:
        """The vehicle has backed out of the search zone."""
        return self.held.high < self.reflector.view_begins()

    @cached_property
    def search_opens(self) -> Bool:
        """The map's next reflector may come into view."""
        return self.own.ahead.known & self.own.ahead.reflector.opens(self.held, self.own.config.search_run_mm)

    @cached_property
    def passed_unseen(self) -> Bool:
        """The radar would have measured the map's next reflector by now, and it lies beyond the one found last."""
        new = self.own.ahead.position.value > self.own.found
        return self.own.ahead.known & new & self.own.ahead.reflector.over(self.held, self.own.config.search_run_mm)

    @cached_property
    def steady(self) -> Bool:
        """The measured position agrees with the distance run since the reflector came into view: the error is constant.

        Both contain the same systematic error. The bound on it is therefore left out, and no deviation can hide in it.
        """
        return self.target.bare.meets(self.drifted)

    @cached_property
    def anchored(self) -> Interval:
        """The anchor run on: the first interval of the view zone, or the interval known in a self-test."""
        return self.own.odometer.run_on(self.own.anchor.interval)

    @cached_property
    def drifted(self) -> Interval:
        """The anchor run on, widened by the radar's drift in the cycle."""
        return self.anchored.widened(self.own.config.drift_nm)

    @cached_property
    def overlap_contradicts(self) -> Bool:
        """Two reflectors are in view and their measurements exclude each other."""
        return self.target.accepted & self.ahead.accepted & ~self.target.bare.meets(self.ahead.bare)

    @cached_property
    def too_close(self) -> Bool:
        """The vehicle may be beyond the end of the view zone."""
        return self.held.high >= exact_to(self.reflector.place - self.reflector.view_to, NM)

    @cached_property
    def gone_by(self) -> Bool:
        """The reflector surely lies behind."""
        return self.held.low >= exact_to(self.reflector.place, NM)

    @cached_property
    def lost(self) -> Bool:
        """Too many cycles without a frame, or too many frames without the target's echo; the two are counted apart."""
        config, own = self.own.config, self.own
        missed = own.frame_present & (own.misses >= config.loss_limit_cycles)
        return missed | (~own.frame_present & (own.pauses >= config.pause_limit_cycles))

    def anchor_after(self, fresh: Interval) -> Interval:
        """Return the anchor run on, or `fresh` once the anchor has grown too wide to tell anything."""
        config = self.own.config
        most = config.tolerance_nm + self.own.odometer.constant_nm
        useful = self.drifted.within(most, config.position_limit_mm)
        return choose(useful, self.drifted, fresh)


def judge(own: Parts, zones: Zones) -> Judgement:
    """Build the terms of one cycle."""
    constant = own.odometer.constant_nm
    base = own.track.interval.widened(ite(zones.exact, as_num(constant, NM), 0))
    predicted, balise = own.odometer.run_on(base), own.balise.fix(own.odometer)
    widened = balise.widened(constant)
    better = balise.meets(predicted) & (widened.margin < predicted.margin)
    taken = own.balise.read & (~zones.located | better)
    held = choose(taken, widened, predicted)
    named, prescribed = _prescribed(own)
    started = own.balise.read & own.balise.identity.value.ne(own.procedure_balise) & own.ahead.known & named
    run = ite(started, own.balise.run, own.run_since_balise + own.odometer.distance)
    reflector = choose(started | ~(zones.referring | zones.searching | zones.in_view), own.ahead.reflector,
                       own.target.reflector)  # fmt: skip
    known = choose(started, balise, own.odometer.run_on(own.anchor.interval))
    long, short = own.open_long + own.config.drift_nm, own.open_short + own.config.drift_nm
    stale = zones.ready & (maximum(long, short) > own.config.left_open_nm)
    lag, testing = own.odometer.lag(own.config.share_ppm(own.config.frame_latency_ms)), started | zones.referring
    by_radar = choose(zones.exact & ~taken, _measured_on(own), _seen_by(held, (long, short)))
    beside = Situation(own.frame_present, held, by_radar, lag, own.config.radar, FALSE, known, (long, short))
    now = replace(beside, testing=testing, open=(ite(testing, 0, long), ite(testing, 0, short)))
    searched = _searched(own, zones, started, run, reflector, held) & (started | ~stale)
    return Judgement(
        own,
        zones,
        now,
        predicted,
        balise,
        held,
        by_radar,
        known,
        (long, short),
        stale,
        started,
        reflector,
        ite(started, prescribed, own.reference),
        run,
        recognise(own.slots, reflector, searched, now),
        recognise(own.slots, own.ahead.reflector, _next_searched(own, zones, started, held) & ~stale, beside),
    )


def _seen_by(interval: Interval, open_: tuple[Num, Num]) -> Interval:
    """Return the places at which the radar may measure an end A in the interval: too long a range puts it farther back."""
    long, short = open_
    return Interval(interval.position, interval.above + short, interval.below + long)


def _measured_on(own: Parts) -> Interval:
    """Return the last cycle's measurement run on, as the radar sees it: its systematic error is the same, but for the drift."""
    last = Interval(own.track.position, own.track.above - own.open_long, own.track.below - own.open_short)
    return own.odometer.run_on(last.widened(own.odometer.constant_nm)).widened(own.config.drift_nm)


def _prescribed(own: Parts) -> tuple[Bool, Num]:
    """Return whether a distance from balise to reflector is prescribed, and the distance: by telegram, map or system variable."""
    telegram, by_map, system = own.balise.reference, own.ahead.reference, own.config.reference_distance_mm
    known = any_of([telegram.present, by_map.present, bool(system)])
    return known, telegram.value_or(by_map.value_or(as_num(system, MM)))


def _searched(own: Parts, zones: Zones, started: Bool, run: Num, reflector: Reflector, held: Interval) -> Bool:
    """Return whether an echo may be taken for the target: from the prescribed distance after the balise, or from the view zone, on."""
    line = ite(started, own.balise.search_from.value_or(as_num(0, MM)), own.search_from)
    reference = ite(line.eq(0), held.high >= reflector.view_begins(), run >= line)
    return ite(started | zones.referring, reference, zones.searching | zones.in_view)


def _next_searched(own: Parts, zones: Zones, started: Bool, held: Interval) -> Bool:
    """Return whether an echo may be taken for the next reflector: while one is in view and the view zones overlap."""
    other = own.ahead.position.value.ne(own.target.position)
    both = other & own.ahead.reflector.comes_into_view(held)
    return ite(started, FALSE, zones.in_view & own.ahead.known & both)
