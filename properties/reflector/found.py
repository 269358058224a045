"""Claims of when a reflector counts as found: by the echoes of the cycle, the map and what was known before it, both ways (RFL-D3)."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import cached_property, partial

from safeloc.language.expr import FALSE, Bool, Num, abs_, all_of, any_of, as_num, before, between, exact_to, ite
from safeloc.language.spec import Property, always
from safeloc.language.units import MM, NM
from safeloc.models.reflector import ReflectorMachine
from safeloc.models.reflector.echo import Slot
from safeloc.models.reflector.variables import Parts
from safeloc.models.vocabulary.choose import choose
from safeloc.models.vocabulary.interval import Interval
from safeloc.models.vocabulary.reflectors import NO_MODEL
from safeloc.properties.reflector.figures import (
    IN_ZONE,
    LAW,
    balise_read,
    counts,
    echo_sides,
    law_nm,
    ran_late,
    ran_mm,
    reading_sides,
    run_since,
    strong,
    was,
)

for_all_inputs = partial(always, requirements=("RFL-D3", "RFL-1", "RFL-10"), unconditional=True)


def found(model: ReflectorMachine) -> Iterator[Property]:
    """Yield the properties of a reflector that is found: where one is searched, in a view zone, in a self-test, and elsewhere."""
    cycle, now = _Cycle(model), model.own.recognised_now
    target, ahead = _target(model.own), _next(model.own)
    yield for_all_inputs(
        "a searched reflector is found exactly when an echo fits it",
        (was(model, "SEARCH") & ~cycle.starts).implies(
            now.iff(cycle.undisturbed & cycle.measured(target, cycle.fits_place))
        ),
        statement="in the search zone a reflector counts as found exactly in a cycle with an echo of its model that has the minimum intensity and "
        "fits its place, and with no other that fits and excludes it",
    )
    yield for_all_inputs(
        "in a view zone another reflector is found exactly when an echo fits it alone",
        (was(model, *IN_ZONE) & ~cycle.starts).implies(
            now.iff(
                cycle.undisturbed
                & ~cycle.measured(target, cycle.fits_place)
                & cycle.next_in_view(ahead)
                & cycle.measured(ahead, cycle.fits_place)
            )
        ),
        statement="in a view zone a reflector counts as found exactly when an echo fits the map's next one, whose view zone may have begun, and "
        "the one in view is not measured: an echo that fits it never counts as another reflector",
    )
    yield for_all_inputs(
        "a reference reflector is found exactly when an echo passes the self-test",
        (was(model, "REFERENCE") | cycle.starts).implies(
            now.iff(cycle.undisturbed & ite(cycle.starts, cycle.passes(ahead), cycle.passes(target)))
        ),
        statement="in a self-test a reflector counts as found exactly when an echo fits it that has the prescribed distance from the balise and "
        "its place on the map",
        requirements=("RFL-D3", "RFL-6", "RFL-10"),
    )
    yield for_all_inputs(
        "where no reflector is looked for, none is found",
        (was(model, "ODOMETRY", "NOT_READY", "DELOCALIZED") & ~cycle.starts).implies(~now),
        statement="in the odometry zone, not ready or without a position no echo counts as a reflector, unless a balise begins a self-test",
    )
    yield _truly(cycle, target)


def _truly(cycle: _Cycle, target: _Sought) -> Property:
    """Return the property that ties a reflector that is found to the reflector that truly sent the echo."""
    model, own = cycle.model, cycle.own
    sent = zip(own.slots, own.ghosts.kind, own.ghosts.on_map, strict=True)
    heard = any_of(
        all_of([
            cycle.heard(slot, target), kind.eq(target.model), place.eq(before(own.target.position)),
            cycle.exact(slot, target), cycle.unlike(slot, target), ~cycle.stale,
        ])
        for slot, kind, place in sent
    )  # fmt: skip
    return always(
        "a searched reflector is found exactly when its own echo is measured",
        (was(model, "SEARCH") & ~cycle.starts).implies(own.recognised_now.iff(cycle.undisturbed & heard)),
        statement="in the search zone a reflector counts as found exactly when that very reflector truly sent an echo of the cycle that shows its "
        "model with the minimum intensity, from beyond the least range, exact enough for a position and for no equal model to be as near",
        requirements=("RFL-D3", "RFL-1", "RFL-10"),
        assumption=LAW,
    )


@dataclass(frozen=True, eq=False)
class _Sought:
    """A reflector that is looked for: the place of end A when the range to it is 0, its model, and lengths, mm."""

    place: Num
    model: Num
    view_from: Num
    clear: Num


def _target(own: Parts) -> _Sought:
    """Return the reflector that was the target before the cycle."""
    offset, target = own.config.radar_offset_mm, own.target
    return _Sought(
        before(target.position) + offset, before(target.model), before(target.view_from), before(target.clear)
    )


def _next(own: Parts) -> _Sought:
    """Return the map's next reflector."""
    ahead = own.ahead
    return _Sought(ahead.position.value + own.config.radar_offset_mm, ahead.model, ahead.view_from, ahead.clear)


@dataclass(frozen=True, eq=False)
class _Cycle:
    """One cycle: everything that is known without its echoes, and what they add."""

    model: ReflectorMachine

    @property
    def own(self) -> Parts:
        """The machine's variables."""
        return self.model.own

    # ------------------------------------------------------------------ without an echo

    @cached_property
    def starts(self) -> Bool:
        """A balise starts a self-test: not the last one again, and with a prescribed distance to a reflector that the map has."""
        own, tells = self.own, self.own.balise
        prescribed: list[Bool | bool] = [
            tells.reference.present,
            own.ahead.reference.present,
            bool(own.config.reference_distance_mm),
        ]
        other = tells.identity.value.ne(before(own.procedure_balise))
        return all_of([balise_read(own), other, self._next_known, any_of(prescribed)])

    @cached_property
    def undisturbed(self) -> Bool:
        """Neither route nor balise contradict, and a distance was measured lately."""
        own = self.own
        lately = counts(own) | (before(own.odometer.gap) < own.config.gap_limit_cycles)
        stray = balise_read(own) & ~was(self.model, "DELOCALIZED") & ~self._reading.meets(self._predicted)
        return ~own.contradicted & lately & ~stray

    @cached_property
    def stale(self) -> Bool:
        """The radar may have drifted by more than a self-test may leave open."""
        most = exact_to(as_num(self.own.config.reference_tolerance_mm, MM), NM)
        return any_of(side > most for side in self._open)

    @cached_property
    def _next_known(self) -> Bool:
        return self.own.ahead.model.ne(NO_MODEL) & self.own.ahead.position.present

    @cached_property
    def _constant(self) -> Num:
        return exact_to(as_num(self.own.config.odometer.constant_mm, MM), NM)

    @cached_property
    def _drift(self) -> Num:
        return as_num(self.own.config.radar_drift_mm_s * self.own.config.period_ms * 1_000, NM)

    @cached_property
    def _open(self) -> tuple[Num, Num]:
        """The most by which the radar may measure too long, and too short, nm."""
        return before(self.own.open_long) + self._drift, before(self.own.open_short) + self._drift

    @cached_property
    def _predicted(self) -> Interval:
        """The interval before the cycle, run on."""
        own, track = self.own, self.own.track
        more = ite(was(self.model, "VIEW"), law_nm(own) + self._constant, law_nm(own))
        return Interval(before(track.position) + ran_mm(own), before(track.above) + more, before(track.below) + more)

    @cached_property
    def _reading(self) -> Interval:
        """The interval by the balise that was read."""
        return Interval(self.own.balise.position.value + run_since(self.own), *reading_sides(self.own))

    @cached_property
    def _by_balise(self) -> Bool:
        """The balise tells the place, since nothing else does or since it is the narrower one."""
        narrower = self._reading.widened(self._constant).margin < self._predicted.margin
        better = narrower & self._reading.meets(self._predicted)
        return balise_read(self.own) & (was(self.model, "DELOCALIZED") | better)

    @cached_property
    def _held(self) -> Interval:
        return choose(self._by_balise, self._reading.widened(self._constant), self._predicted)

    @cached_property
    def _by_radar(self) -> Interval:
        """The places at which a radar may measure end A: its error is open, but the same as that of the measurement before, apart from the drift."""
        own, track, (long, short) = self.own, self.own.track, self._open
        more = law_nm(own) + self._constant + self._drift
        again = Interval(
            before(track.position) + ran_mm(own),
            before(track.above) - before(own.open_long) + more,
            before(track.below) - before(own.open_short) + more,
        )
        afresh = Interval(self._held.position, self._held.above + short, self._held.below + long)
        return choose(was(self.model, "VIEW") & ~self._by_balise, again, afresh)

    @cached_property
    def _known(self) -> Interval:
        """The interval that a self-test compares the radar with."""
        own, anchor = self.own, self.own.anchor
        above, below = before(anchor.above) + law_nm(own), before(anchor.below) + law_nm(own)
        return choose(self.starts, self._reading, Interval(before(anchor.position) + ran_mm(own), above, below))

    # ------------------------------------------------------------------ an echo

    def _bare(self, slot: Slot, sought: _Sought) -> Interval:
        """Return the interval by the echo, if the radar has no systematic error."""
        return Interval(-slot.range.value + sought.place, *echo_sides(self.own, slot.range.value, slot.error))

    def _fix(self, slot: Slot, sought: _Sought) -> Interval:
        bare, (long, short) = self._bare(slot, sought), self._open
        return Interval(bare.position, bare.above + long, bare.below + short)

    def heard(self, slot: Slot, sought: _Sought) -> Bool:
        """Return whether the echo has the minimum intensity, the least range, and the model."""
        far = slot.range.value >= self.own.config.near_range_mm
        return strong(self.own, slot) & far & slot.model.eq(sought.model)

    def _tolerable(self, interval: Interval) -> Bool:
        config = self.own.config
        most = exact_to(as_num(config.tolerance_mm, MM), NM)
        on_line = abs_(interval.position) <= config.position_limit_mm
        return (interval.above <= most) & (interval.below <= most) & on_line

    def exact(self, slot: Slot, sought: _Sought) -> Bool:
        """Return whether the position by the echo is tolerable."""
        return self._tolerable(self._fix(slot, sought))

    def unlike(self, slot: Slot, sought: _Sought) -> Bool:
        """Return whether the next equal model is farther away than the echo and the interval without it can be wrong."""
        room, fix = exact_to(sought.clear, NM) - self._held.width, self._fix(slot, sought)
        return (room > fix.above * 2) & (room > fix.below * 2)

    def fits_place(self, slot: Slot, sought: _Sought) -> Bool:
        """Return whether the echo is one of the reflector, by its place."""
        near = self._bare(slot, sought).meets(self._by_radar)
        return all_of([near, self.exact(slot, sought), self.unlike(slot, sought), ~self.stale])

    def fits_test(self, slot: Slot, sought: _Sought) -> Bool:
        """Return whether a self-test may be made with the echo."""
        own, bare = self.own, self._bare(slot, sought)
        line = ite(
            self.starts, _or_zero(own.balise.search_from.present, own.balise.search_from.value), before(own.search_from)
        )
        by_map = self._held.high + exact_to(sought.view_from, NM) >= exact_to(sought.place, NM)
        sought_here = ite(line.eq(0), by_map, self._run >= line)
        spread = self._known.width + bare.width
        narrow = spread <= exact_to(as_num(own.config.reference_tolerance_mm, MM), NM)
        exact = self._tolerable(bare) & self._tolerable(bare.widened(spread))
        return all_of([sought_here, narrow, exact, self._no_other_in_range(sought)])

    def _no_other_in_range(self, sought: _Sought) -> Bool:
        forward, backward = ran_late(self.own, self.own.config.frame_latency_ms)
        away = exact_to(sought.clear - self.own.config.map_accuracy_mm, NM)
        reach = exact_to(as_num(self.own.config.strong_range_mm, MM), NM)
        nearer, farther = exact_to(sought.place, NM) - away, exact_to(sought.place, NM) + away
        return (nearer < self._held.low - forward) & (farther > self._held.high + backward + reach)

    @cached_property
    def _run(self) -> Num:
        """Distance run since the balise of the self-test, mm."""
        return ite(self.starts, run_since(self.own), before(self.own.run_since_balise) + ran_mm(self.own))

    @cached_property
    def _prescribed(self) -> Num:
        """Distance that is prescribed from that balise to its reflector, mm."""
        own, telegram, by_map = self.own, self.own.balise.reference, self.own.ahead.reference
        on_map = ite(~by_map.present, as_num(own.config.reference_distance_mm, MM), by_map.value)
        return ite(self.starts, ite(~telegram.present, on_map, telegram.value), before(own.reference))

    def _agrees(self, slot: Slot, sought: _Sought) -> Bool:
        """Return whether the echo has the prescribed distance from the balise, and its place on the map."""
        bare, known = self._bare(slot, sought), self._known
        survey = exact_to(as_num(self.own.config.map_accuracy_mm, MM), NM)
        measured = slot.range.value + self._run - self.own.config.radar_offset_mm
        missed = exact_to(measured - self._prescribed, NM)
        kept = between(-(known.above + bare.below + survey), missed, known.below + bare.above + survey)
        return kept & bare.meets(known)

    # ------------------------------------------------------------------ all echoes of a frame

    def next_in_view(self, ahead: _Sought) -> Bool:
        """Return whether the map has another reflector whose view zone may have begun, and no equal one within the interval."""
        other = self.own.ahead.position.value.ne(before(self.own.target.position))
        begun = self._held.high + exact_to(ahead.view_from, NM) >= exact_to(ahead.place, NM)
        return all_of([self._next_known, other, begun, exact_to(ahead.clear, NM) > self._held.width])

    def measured(self, sought: _Sought, fits: Callable[[Slot, _Sought], Bool]) -> Bool:
        """Return whether an echo fits, and none that fits excludes the first of them."""
        return any_of(one for one, _ in self._first(sought, fits)) & ~self._excluded(sought, fits)

    def passes(self, sought: _Sought) -> Bool:
        """Return whether the first echo that fits passes the self-test, and none excludes it."""
        agrees = any_of(one & self._agrees(slot, sought) for one, slot in self._first(sought, self.fits_test))
        return agrees & ~self._excluded(sought, self.fits_test)

    def _first(self, sought: _Sought, fits: Callable[[Slot, _Sought], Bool]) -> list[tuple[Bool, Slot]]:
        """Return, of each echo, whether it is the first that fits."""
        made: list[tuple[Bool, Slot]] = []
        earlier: Bool = FALSE
        for slot in self.own.slots:
            one = self.heard(slot, sought) & fits(slot, sought)
            made.append((one & ~earlier, slot))
            earlier = earlier | one
        return made

    def _excluded(self, sought: _Sought, fits: Callable[[Slot, _Sought], Bool]) -> Bool:
        firsts = self._first(sought, fits)
        return any_of(
            first & self.heard(other, sought) & fits(other, sought) & ~self._bare(slot, sought).meets(self._bare(other, sought))
            for number, (first, slot) in enumerate(firsts)
            for _, other in firsts[number + 1 :]
        )  # fmt: skip


def _or_zero(there: Bool, value: Num) -> Num:
    return ite(~there, as_num(0, MM), value)
