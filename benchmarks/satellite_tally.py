"""What became of a trial's cycles: exclusions against the truth of the signals, errors against what was stated."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np

from safeloc.report.stanford import Report, Reports

HARMLESS_M = 0.1
"""What is added below this is no disturbance."""


@dataclass(frozen=True)
class Cycle:
    """One cycle of a trial.

    truth_mm      where the train is along the track
    reported      lower end, position, upper end, mm; None: nothing is reported
    drift_bound   how far the truth may be from the position although every signal were false, mm; None: not checked
    solution      its place and protection level, mm; None: none was made
    accepted      the machine took the solution on
    usable, used  satellites in the list of usable ones, and in the solution
    error_m       of every judged satellite the whole error of its pseudorange; added_m: what disturbs it
    hidden_m      of every judged satellite what prediction and clock make of its difference
    """

    truth_mm: int
    reported: tuple[int, int, int] | None
    drift_bound: int | None
    solution: tuple[int, int] | None
    accepted: bool
    judged: str
    usable: frozenset[str]
    used: frozenset[str]
    error_m: Mapping[str, float]
    added_m: Mapping[str, float]
    hidden_m: Mapping[str, float]


@dataclass
class Tally:
    """Counts over the cycles of one condition.

    healthy_m  up to here a signal's error is that of a healthy one; bound_m: what a solution counts for a used one
    hidden_m   what prediction and clock are assumed to make of a difference at most
    """

    name: str
    healthy_m: float
    bound_m: float
    hidden_m: float = 0.0
    cycles: int = 0
    signals: Counter[str] = field(default_factory=Counter)
    kept: Counter[str] = field(default_factory=Counter)
    judged: Counter[str] = field(default_factory=Counter)
    errors_mm: list[int] = field(default_factory=list)
    levels_mm: list[int] = field(default_factory=list)
    reports: list[Report] = field(default_factory=list)
    beyond_level: Counter[str] = field(default_factory=Counter)
    wrong: Counter[str] = field(default_factory=Counter)
    drifted_beyond: int = 0
    broken: bool = False
    uncompared: int = 0
    unseen: int = 0
    longest_unseen: int = 0

    def add(self, cycles: Iterable[Cycle]) -> None:
        """One run: where the assumption broke in it, everything after counts as after that."""
        self.broken, self.unseen = False, 0
        for cycle in cycles:
            self.cycles += 1
            self._signals(cycle)
            self.judged[cycle.judged] += 1
            assumed = all(abs(cycle.error_m[name]) <= self.bound_m for name in cycle.used)
            self._solution(cycle, "kept" if assumed else "broken")
            self.broken |= cycle.accepted and not assumed
            self.uncompared += any(abs(cycle.hidden_m.get(name, 0.0)) > self.hidden_m for name in cycle.used)
            self._report(cycle)

    def _signals(self, cycle: Cycle) -> None:
        for name, error in cycle.error_m.items():
            kind = self.kind(error, cycle.added_m.get(name, 0.0))
            self.signals[kind] += 1
            self.kept[kind] += name in cycle.usable

    def kind(self, error_m: float, added_m: float) -> str:
        """healthy; disturbed, the whole error within the bound; beyond it; far beyond: more than twice."""
        if abs(added_m) < HARMLESS_M and abs(error_m) <= self.healthy_m:
            return "healthy"
        if abs(error_m) <= self.bound_m:
            return "within"
        return "beyond" if abs(error_m) <= 2 * self.bound_m else "far beyond"

    def _solution(self, cycle: Cycle, assumed: str) -> None:
        if cycle.solution is None:
            return
        place, level = cycle.solution
        error = abs(place - cycle.truth_mm)
        self.beyond_level[assumed] += error > level
        if cycle.accepted:
            self.errors_mm.append(error)
            self.levels_mm.append(level)

    def _report(self, cycle: Cycle) -> None:
        if cycle.reported is None:
            self.unseen = 0
            return
        low, position, high = cycle.reported
        self.unseen = 0 if low <= cycle.truth_mm <= high else self.unseen + 1
        self.longest_unseen = max(self.longest_unseen, self.unseen)
        margin = high - position if cycle.truth_mm >= position else position - low
        self.reports.append(Report(abs(cycle.truth_mm - position), margin))
        self.drifted_beyond += cycle.drift_bound is not None and abs(cycle.truth_mm - position) > cycle.drift_bound
        self.wrong["broken" if self.broken else "kept"] += not low <= cycle.truth_mm <= high

    @property
    def reported(self) -> int:
        """Cycles with a reported interval."""
        return len(self.reports)

    def all_reports(self) -> Reports:
        """For a Stanford diagram."""
        return Reports(tuple(self.reports), self.cycles - self.reported, 0)

    def excluded(self, kind: str) -> float | None:
        """Share of the signals of a kind that were not usable; None where there were none."""
        return None if not self.signals[kind] else 1 - self.kept[kind] / self.signals[kind]


def quantiles(values: Sequence[int]) -> tuple[float, float, float] | None:
    """Median, 95 % and worst, in m."""
    if not values:
        return None
    middle, most, worst = np.percentile(values, [50, 95, 100]) / 1_000
    return float(middle), float(most), float(worst)
