"""Common part of the intervals that sources state in a cycle, and the leading source."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

from safeloc.language.expr import (
    Bool,
    Lit,
    Num,
    NumVar,
    any_of,
    as_num,
    ite,
    maximum,
    minimum,
)
from safeloc.language.units import MM
from safeloc.models.arbitration.variables import Parts, Source
from safeloc.models.vocabulary.reasons import LOCATED, NO_REFERENCE


@dataclass(frozen=True, eq=False)
class Cycle:
    """Common part of the sources' intervals in a cycle, and the leading source."""

    own: Parts
    mode: NumVar
    table: tuple[Lit, ...]

    @property
    def any_valid(self) -> Bool:
        """Some source states an interval."""
        return any_of(source.valid for source in self.own.sources)

    @cached_property
    def low(self) -> Num:
        """The greatest of all lower ends; far below the line where nothing is stated."""
        found: Num = as_num(-self._far, MM)
        for source in self.own.sources:
            found = maximum(found, ite(source.valid, source.low, -self._far))
        return found

    @cached_property
    def high(self) -> Num:
        """The smallest of all upper ends; far above the line where nothing is stated."""
        found: Num = as_num(self._far, MM)
        for source in self.own.sources:
            found = minimum(found, ite(source.valid, source.high, self._far))
        return found

    @property
    def _far(self) -> int:
        return 2 * (self.own.config.position_limit_mm + 10 * self.own.config.tolerance_mm)

    @cached_property
    def agree(self) -> Bool:
        """All that is stated has a place in common."""
        return self.low <= self.high

    @cached_property
    def least(self) -> Num:
        """The smallest margin of all that is stated."""
        found: Num = as_num(self._far, MM)
        for source in self.own.sources:
            found = minimum(found, ite(source.valid, source.margin, self._far))
        return found

    def steadiest(self, source: Source) -> Bool:
        """Return whether the source states an interval, and no other has a smaller margin."""
        return source.valid & source.margin.eq(self.least)

    def led_by(self, source: Source) -> Bool:
        """Return whether the source led before the cycle."""
        return self.mode.eq(self.table[1 + self.own.sources.index(source)])

    @cached_property
    def lead_lasts(self) -> Bool:
        """Whoever led has still the smallest margin."""
        return any_of(self.led_by(source) & self.steadiest(source) for source in self.own.sources)

    @cached_property
    def leader_valid(self) -> Bool:
        """Whoever led still states an interval."""
        return any_of(self.led_by(source) & source.valid for source in self.own.sources)

    def leads(self, source: Source) -> Bool:
        """Return whether the source leads after the cycle: it has the smallest margin; of equal ones the one that led, or else the first declared."""
        earlier = self.own.sources[: self.own.sources.index(source)]
        comes_first = ~any_of(self.steadiest(one) for one in earlier)
        return self.steadiest(source) & ite(self.lead_lasts, self.led_by(source), comes_first)

    @cached_property
    def estimate(self) -> Num:
        """The leader's estimate, moved into the intersection of all intervals."""
        *others, last = self.own.sources
        found: Num = last.position
        for source in reversed(others):
            found = ite(self.leads(source), source.position, found)
        return maximum(self.low, minimum(self.high, found))

    @cached_property
    def tolerable(self) -> Bool:
        """The common part is no wider than tolerable, on either side."""
        most = self.own.config.tolerance_mm
        return (self.estimate - self.low <= most) & (self.high - self.estimate <= most)

    @cached_property
    def usable(self) -> Bool:
        """A position can be reported."""
        return self.any_valid & self.agree & self.tolerable

    @property
    def referred(self) -> Bool:
        """Some source that states an interval has accepted an absolute reference in this cycle."""
        return any_of(source.valid & source.reference for source in self.own.sources)

    @cached_property
    def estimated(self) -> Num:
        """The distance estimated for the cycle."""
        most = self.own.config.max_cycle_distance_mm
        change = maximum(minimum(self.estimate - self.own.position, most), -most)
        return ite(self.own.distance.present, self.own.distance.value, change)

    @cached_property
    def lag(self) -> Num:
        """Distance of the min safe front end behind the lower end after the cycle."""
        before = self.own.position - self.own.below
        return maximum(self.own.lag + (self.low - before) - self.estimated, 0)

    def highest_low(self) -> Num:
        """Return the source with the greatest lower end, as a member of the enumeration."""
        return self._first([source.valid & source.low.eq(self.low) for source in self.own.sources])

    def lowest_high(self) -> Num:
        """Return the source with the smallest upper end."""
        return self._first([source.valid & source.high.eq(self.high) for source in self.own.sources])

    def _first(self, conditions: Sequence[Bool]) -> Num:
        found: Num = Lit(0, self.own.named)
        for index, one in reversed(list(enumerate(conditions, 1))):
            found = ite(one, Lit(index, self.own.named), found)
        return found

    def why_withdrawn(self) -> Num:
        """Return the reason why the source that led states no interval any more."""
        found: Num = NO_REFERENCE
        for source in self.own.sources:
            found = ite(self.led_by(source) & source.reason.ne(LOCATED), source.reason, found)
        return found
