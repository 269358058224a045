"""What one cycle means to the reflector machine: distance run, balise, echoes, and what follows from them.

Every term is built once and shared by all transitions, the assumption and the properties.
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
    """In which kind of mode the machine is."""

    located: Bool
    ready: Bool
    exact: Bool
    in_view: Bool
    referring: Bool
    searching: Bool


@dataclass(frozen=True, eq=False)
class Judged:
    """One cycle, judged.

    predicted  the interval run on from the last one, its constant charged
    held       the same, or the balise's where that is better: what counts without an echo
    by_radar   where the radar, with its systematic error, may have end A by what counts without an echo of this cycle
    known      what a self-test compares the radar with: the balise's interval, run on since it was read
    open       by how much the radar may measure too long, and too short: as the last self-test left it, and its drift since, nm
    stale      that is more than a self-test may leave open: what the radar measures is not precise any longer
    reflector  what is looked for in this cycle
    run        measured distance since the balise of the reference measurement, mm
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
        """A balise was read whose interval excludes the position."""
        return self.zones.located & self.own.balise.read & ~self.balise.meets(self.predicted)

    # ------------------------------------------------------------------ margins

    @cached_property
    def tolerable(self) -> Bool:
        """What counts without an echo may be kept."""
        return self.held.within(self.own.config.tolerance_nm, self.own.config.position_limit_mm)

    # ------------------------------------------------------------------ the self-test (RFL-6)

    @cached_property
    def reference_holds(self) -> Bool:
        """Measured distance from balise to reflector agrees with the prescribed one; only while `target.accepted`.

        The tolerance is what balise, odometer, echo, survey and latencies may be wrong by: a right radar always passes.
        """
        fix, known, survey = self.target.fix, self.known, self.own.config.accuracy_nm
        missed = exact_to(self.target.range + self.run - self.own.config.radar_offset_mm - self.reference, NM)
        return between(-(known.above + fix.below + survey), missed, known.below + fix.above + survey)

    @cached_property
    def agrees(self) -> Bool:
        """The reference reflector is measured where it has to be: by the prescribed distance, and by its place on the map."""
        return self.reference_holds & self.target.fix.meets(self.known)

    @cached_property
    def passed(self) -> Bool:
        """The radar is right, as far as can be seen."""
        return self.target.accepted & self.agrees

    @cached_property
    def failed(self) -> Bool:
        """The radar is wrong."""
        return self.target.accepted & ~self.agrees

    @cached_property
    def left_open(self) -> tuple[Num, Num]:
        """By how much the radar may measure too long, and too short, though the self-test passed; nm."""
        fix = self.target.fix
        return self.known.high - fix.low, fix.high - self.known.low

    @cached_property
    def tested_fix(self) -> Interval:
        """The interval of the echo that passed, charged with what the self-test left open."""
        long, short = self.left_open
        return Interval(self.target.fix.position, self.target.fix.above + long, self.target.fix.below + short)

    @cached_property
    def reference_over(self) -> Bool:
        """The reference reflector would have been seen by now."""
        limit, search = self.own.config.reference_run_mm, self.own.config.search_run_mm
        searched = self.run > self.own.search_from + search
        return (self.reflector.over(self.held, search) & searched) | ~between(-limit, self.run, limit)

    @cached_property
    def begins_at(self) -> Interval:
        """What the balise says, to run on from while the reference reflector is waited for."""
        return self.balise.widened(self.own.odometer.constant_nm)

    def testable(self, known: Interval) -> Bool:
        """What is known without the radar is exact enough for a self-test."""
        config = self.own.config
        most = config.tolerance_nm + self.own.odometer.constant_nm
        return (known.width <= config.left_open_nm) & known.within(most, config.position_limit_mm)

    @cached_property
    def too_coarse(self) -> Bool:
        """The run since the balise has become too uncertain for a self-test."""
        return ~self.testable(self.anchored) & self.tolerable & ~self.started

    @cached_property
    def outdated(self) -> Bool:
        """The last self-test is too long ago: the radar may have drifted by more than may be charged."""
        return self.stale & self.tolerable & ~self.started

    # ------------------------------------------------------------------ search and view zone

    @cached_property
    def search_over(self) -> Bool:
        """The target would have been found by now."""
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
        """The map's next reflector would have been found by now, and is not the one found last or one before it."""
        new = self.own.ahead.position.value > self.own.found
        return self.own.ahead.known & new & self.own.ahead.reflector.over(self.held, self.own.config.search_run_mm)

    @cached_property
    def steady(self) -> Bool:
        """The measured position agrees with what was run since the reflector came into view: the error is constant.

        The systematic error is in both, so that what is left open of it hides nothing here.
        """
        return self.target.bare.meets(self.drifted)

    @cached_property
    def anchored(self) -> Interval:
        """The first interval of the view zone, or what is known in a self-test, run on."""
        return self.own.odometer.run_on(self.own.anchor.interval)

    @cached_property
    def drifted(self) -> Interval:
        """The first interval of the view zone, run on, by a radar that drifts."""
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
        """Neither measured nor excused any longer: pauses and misses are counted apart."""
        config, own = self.own.config, self.own
        missed = own.frame & (own.misses >= config.loss_limit_cycles)
        return missed | (~own.frame & (own.pauses >= config.pause_limit_cycles))

    def anchor_after(self, fresh: Interval) -> Interval:
        """Return the anchor run on, or `fresh` once the anchor has grown too wide to tell anything."""
        config = self.own.config
        most = config.tolerance_nm + self.own.odometer.constant_nm
        useful = self.drifted.within(most, config.position_limit_mm)
        return choose(useful, self.drifted, fresh)


def judge(own: Parts, zones: Zones) -> Judged:
    """Judge one cycle."""
    constant = own.odometer.constant_nm
    base = own.track.interval.widened(ite(zones.exact, as_num(constant, NM), 0))
    predicted, balise = own.odometer.run_on(base), own.balise.fix(own.odometer)
    charged = balise.widened(constant)
    better = balise.meets(predicted) & (charged.margin < predicted.margin)
    taken = own.balise.read & (~zones.located | better)
    held = choose(taken, charged, predicted)
    told, prescribed = _prescribed(own)
    started = own.balise.read & own.balise.identity.value.ne(own.procedure) & own.ahead.known & told
    run = ite(started, own.balise.run, own.run + own.odometer.distance)
    reflector = choose(started | ~(zones.referring | zones.searching | zones.in_view), own.ahead.reflector,
                       own.target.reflector)  # fmt: skip
    known = choose(started, balise, own.odometer.run_on(own.anchor.interval))
    long, short = own.open_long + own.config.drift_nm, own.open_short + own.config.drift_nm
    stale = zones.ready & (maximum(long, short) > own.config.left_open_nm)
    lag, testing = own.odometer.lag(own.config.share_ppm(own.config.frame_latency_ms)), started | zones.referring
    by_radar = choose(zones.exact & ~taken, _measured_on(own), _seen_by(held, (long, short)))
    beside = Situation(own.frame, held, by_radar, lag, own.config.radar, FALSE, known, (long, short))
    now = replace(beside, testing=testing, open=(ite(testing, 0, long), ite(testing, 0, short)))
    searched = _searched(own, zones, started, run, reflector, held) & (started | ~stale)
    return Judged(
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
    """Where the radar may have end A that is in the interval: measuring too long, it has it farther back."""
    long, short = open_
    return Interval(interval.position, interval.above + short, interval.below + long)


def _measured_on(own: Parts) -> Interval:
    """Where the radar had end A when it measured it in the last cycle, run on: what is wrong with it is the same, but for drift."""
    last = Interval(own.track.position, own.track.above - own.open_long, own.track.below - own.open_short)
    return own.odometer.run_on(last.widened(own.odometer.constant_nm)).widened(own.config.drift_nm)


def _prescribed(own: Parts) -> tuple[Bool, Num]:
    """Whether the distance from balise to reflector is prescribed, and what it is: telegram, map, system variable."""
    telegram, by_map, system = own.balise.reference, own.ahead.reference, own.config.reference_distance_mm
    known = any_of([telegram.present, by_map.present, bool(system)])
    return known, telegram.value_or(by_map.value_or(as_num(system, MM)))


def _searched(own: Parts, zones: Zones, started: Bool, run: Num, reflector: Reflector, held: Interval) -> Bool:
    """Whether an echo may be taken for the target: from the prescribed line after the balise, or by the map, on."""
    line = ite(started, own.balise.search.value_or(as_num(0, MM)), own.search_from)
    reference = ite(line.eq(0), held.high >= reflector.view_begins(), run >= line)
    return ite(started | zones.referring, reference, zones.searching | zones.in_view)


def _next_searched(own: Parts, zones: Zones, started: Bool, held: Interval) -> Bool:
    """While a reflector is in view, the next one may be in view too, for as long as the zones overlap."""
    other = own.ahead.position.value.ne(own.target.position)
    both = other & own.ahead.reflector.comes_into_view(held)
    return ite(started, FALSE, zones.in_view & own.ahead.known & both)
