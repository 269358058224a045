"""Terms of one cycle of the fibre machine: section edges, the run, and every disagreement."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

from safeloc.language.expr import (
    Bool,
    Lit,
    Num,
    abs_,
    any_of,
    as_num,
    ceil_to,
    exact_to,
    floor_div,
    ite,
    minimum,
)
from safeloc.language.units import COUNT, MM, NM, NM_PER_MM, PPM
from safeloc.models.fibre import variables as v
from safeloc.models.fibre.variables import Parts
from safeloc.models.vocabulary.first_of import first_of


@dataclass(frozen=True, eq=False)
class Cycle:
    """Terms over the inputs of a cycle and the state before it."""

    own: Parts

    # -------------------------------------------------------------- edges

    @cached_property
    def band(self) -> Num:
        """Amplitude band after the cycle: with hysteresis, and through normal from one changed band to the other."""
        own, config, value = self.own, self.own.config, self.own.amplitude.value
        from_normal = ite(value >= config.change_cdb, v.RAISED, ite(value <= -config.change_cdb, v.LOWERED, v.NORMAL))
        still = own.band.eq(v.RAISED) & (value > config.return_cdb) | own.band.eq(v.LOWERED) & (
            value < -config.return_cdb
        )
        after = ite(own.band.eq(v.NORMAL), from_normal, ite(still, own.band, v.NORMAL))
        return ite(own.amplitude.present, after, own.band)

    @cached_property
    def enters(self) -> Bool:
        """The amplitude leaves normal: a position signal So."""
        return self.own.band.eq(v.NORMAL) & self.band.ne(v.NORMAL)

    @cached_property
    def leaves(self) -> Bool:
        """The amplitude is normal again: no second section."""
        return self.own.band.ne(v.NORMAL) & self.band.eq(v.NORMAL)

    @cached_property
    def forwards(self) -> Bool:
        """Direction of running; the last known one if the end stands or no run is measured."""
        run = self.own.run
        return ite(run.present & run.value.ne(0), run.value > 0, self.own.forwards)

    # -------------------------------------------------------------- the run

    @cached_property
    def added_error(self) -> Num:
        """Greatest error of this cycle's run, nm; without a measured run, the run at the highest speed."""
        own, config = self.own, self.own.config
        rate = abs_(own.run.value) * Lit(config.rate_ppm, PPM)
        moved = ite(own.run.value.eq(0), as_num(0, NM), rate + config.floor_mm * NM_PER_MM)
        return ite(own.run.present, moved, Lit(config.max_cycle_distance_mm * NM_PER_MM, NM))

    @cached_property
    def since(self) -> Num:
        """Run since the last edge, after the cycle."""
        return self.own.run_since_edge + ite(self.own.run.present, self.own.run.value, 0)

    @cached_property
    def drift(self) -> Num:
        """Greatest error of that run, nm."""
        return self.own.drift + self.added_error

    @cached_property
    def slack(self) -> Num:
        """Greatest error of that run, mm rounded up."""
        return ceil_to(self.drift, MM)

    @cached_property
    def fresh(self) -> Num:
        """Greatest run since the last amplitude, nm: the end may have passed an edge anywhere in it."""
        own = self.own
        return (
            own.run_since_amplitude
            + ite(own.run.present, exact_to(abs_(own.run.value), NM), as_num(0, NM))
            + self.added_error
        )

    @cached_property
    def edge_slack(self) -> Num:
        """Greatest error of the run between the last edge and an edge seen in this cycle, mm rounded up."""
        return ceil_to(self.drift + self.fresh, MM)

    @cached_property
    def late(self) -> Bool:
        """The amplitude was absent for so much run that an edge seen in this cycle cannot be placed within the tolerance."""
        return self.own.run_since_amplitude > self._room

    @cached_property
    def place(self) -> Num:
        """Middle of the interval after the cycle, without an edge."""
        return self.own.edge + self.since

    @cached_property
    def silent(self) -> Bool:
        """The detector has not followed the pattern for too long."""
        return ~self.own.run.present & (self.own.silent_cycles >= self.own.config.gap_limit_cycles)

    @cached_property
    def too_wide(self) -> Bool:
        """The interval would exceed the tolerance, or leave the range of positions."""
        edge = (self.enters | self.leaves) & self.late
        return (self.drift > self._room) | edge | (abs_(self.since) > self.own.config.position_limit_mm)

    @property
    def _room(self) -> int:
        """Greatest permitted error of a run, nm."""
        return (self.own.config.tolerance_mm - self.own.config.edge_tolerance_mm) * NM_PER_MM

    # -------------------------------------------------------------- the section being passed

    @cached_property
    def inside(self) -> Num:
        """Run in the section so far, positive in the direction of entry."""
        return ite(self.own.upwards, self.since, -self.since)

    def _reads(self, length: int) -> Bool:
        tolerance = self.own.config.read_tolerance_mm + self.edge_slack
        return abs_(self.inside - length) <= tolerance

    @cached_property
    def reads_long(self) -> Bool:
        """The section left in this cycle can only be a long one."""
        return self._reads(self.own.config.long_mm) & ~self._reads(self.own.config.short_mm)

    @cached_property
    def reads_short(self) -> Bool:
        """The section left in this cycle can only be a short one."""
        others = self._reads(self.own.config.long_mm) | self._reads(0)
        return self._reads(self.own.config.short_mm) & ~others

    @cached_property
    def turned_back(self) -> Bool:
        """The end left the section on the side where it had entered; nothing else fits the run."""
        return self._reads(0) & ~self._reads(self.own.config.short_mm)

    @cached_property
    def read(self) -> Bool:
        """The end passed a section whose length was read."""
        return self.leaves & (self.reads_long | self.reads_short)

    @cached_property
    def endless(self) -> Bool:
        """The amplitude has been changed for longer than any section."""
        longest = self.own.config.long_mm + self.own.config.read_tolerance_mm
        slack = ite(self.leaves, self.edge_slack, self.slack)
        return self.own.band.ne(v.NORMAL) & (abs_(self.since) - slack > longest)

    # -------------------------------------------------------------- disagreements

    @cached_property
    def fits(self) -> Bool:
        """The signal is that of the map's next section: of its kind, and where that can be."""
        known, near, _, rises, _ = self.own.next_to(self.forwards)
        window = self.own.config.read_tolerance_mm + self.edge_slack
        return known & rises.iff(self.band.eq(v.RAISED)) & (abs_(self.place - near) <= window) & ~self.full

    @cached_property
    def full(self) -> Bool:
        """The range of section numbers is exhausted."""
        return abs_(self.own.sections_counted + self.one) > self.own.config.section_limit

    @cached_property
    def overdue(self) -> Bool:
        """The whole interval is beyond an edge of the map, and no signal came."""
        own, reach = self.own, self.own.config.read_tolerance_mm + self.slack
        beyond = own.ahead.known & (self.place - reach > own.ahead.near)
        behind = own.behind.known & (self.place + reach < own.behind.near)
        return own.band.eq(v.NORMAL) & ~self.enters & (beyond | behind)

    @cached_property
    def wrong_length(self) -> Bool:
        """The section left is not the one that the map has there, or its length cannot be read."""
        passed = self.read & self.reads_long.iff(self.own.long_by_map)
        return self.leaves & ~self.turned_back & ~passed

    @cached_property
    def compared(self) -> tuple[Num, Num]:
        """The place with which an additional localization is compared, and its error besides the threshold, mm."""
        _, near, _, _, _ = self.own.next_to(self.forwards)
        return ite(self.enters, near, self.place), ite(self.enters, 0, self.slack)

    @cached_property
    def flight_differs(self) -> Bool:
        """The time of flight gives another place."""
        place, slack = self.compared
        seen = self.own.flight_position
        return seen.present & (abs_(seen.value - place) > self.own.config.flight_threshold_mm + slack)

    @cached_property
    def reflection_differs(self) -> Bool:
        """The pattern coincides with a reflecting point at another place."""
        place, slack = self.compared
        seen = self.own.reflecting_point
        return seen.present & (abs_(seen.value - place) > self.own.config.reflection_threshold_mm + slack)

    @cached_property
    def flaws(self) -> list[tuple[Bool, Lit]]:
        """Every disagreement with its reason; the first that holds is reported."""
        return [
            (self.enters & ~self.fits, v.FALSE_SECTION),
            (self.overdue, v.MISSED_SECTION),
            (self.wrong_length, v.WRONG_LENGTH),
            (self.endless, v.NO_END_OF_SECTION),
            (self.flight_differs, v.FLIGHT_DIFFERS),
            (self.reflection_differs, v.REFLECTION_DIFFERS),
        ]

    @cached_property
    def error(self) -> Bool:
        """The error signal F."""
        return any_of(flaw for flaw, _ in self.flaws)

    @cached_property
    def flaw(self) -> Num:
        """The reason for F."""
        return first_of(*self.flaws, default=v.LOCATED)

    # -------------------------------------------------------------- next values of counters and word

    @cached_property
    def one(self) -> Num:
        """One section, with the sign of the direction."""
        return ite(self.forwards, as_num(1, COUNT), as_num(-1, COUNT))

    @cached_property
    def uncounted(self) -> Num:
        """The count without the section that the end left where it had entered."""
        return self.own.sections_counted + ite(self.own.upwards, as_num(-1, COUNT), as_num(1, COUNT))

    @cached_property
    def gap(self) -> Num:
        """Cycles since the detector last followed the pattern."""
        own = self.own
        return ite(
            own.run.present,
            as_num(0, COUNT),
            ite(own.silent_cycles >= own.silent_cycles.high, own.silent_cycles, own.silent_cycles + 1),
        )

    @cached_property
    def unheard(self) -> Num:
        """Greatest run since the last amplitude, nm, up to the limit that is still told apart."""
        return ite(self.own.amplitude.present, as_num(0, NM), minimum(self.fresh, self.own.run_since_amplitude.high))

    @cached_property
    def word(self) -> Num:
        """The word with the symbol of the section just passed; the oldest symbol is dropped."""
        own = self.own
        symbol = ite(own.band.eq(v.RAISED), as_num(2, COUNT), as_num(0, COUNT)) + ite(
            self.reads_long, as_num(1, COUNT), 0
        )
        oldest: int = v.SYMBOLS ** (own.config.window - 1)
        kept = own.word_read - floor_div(own.word_read, oldest) * oldest
        return kept * v.SYMBOLS + symbol

    @cached_property
    def word_length(self) -> Num:
        """Number of symbols in that word."""
        return ite(self.own.read >= self.own.config.window, self.own.read, self.own.read + 1)
