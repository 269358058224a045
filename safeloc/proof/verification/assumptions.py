"""Check of the laws of the worlds on a recording: how near each came to a breach, and every cycle with a breach.

    judge_recording(target, path)  ->  Judged(laws=[...], clocks=[...], ...)

A recording with the ghosts of the machine holds the truth, and every law is checked. In a recording without them only
observable conditions are: laws that read no ghost, and two laws together if they can exclude each other
(safeloc.language.observable).
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Literal

from safeloc.language.distance import Distance, distance
from safeloc.language.expr import Bool, Var
from safeloc.language.nodes import Value
from safeloc.language.observable import Observable, Seen, Stated, seen
from safeloc.language.system import without_ghosts
from safeloc.language.terms import variables
from safeloc.language.trace import Trace
from safeloc.proof.drawn_runs.quick import Quick
from safeloc.proof.verification.recordings import recorded_times
from safeloc.proof.verification.replay import has_truth, read_recording, run_of
from safeloc.runtime.breaches import Breach, BrokenLaw
from safeloc.runtime.embedding.laws import broken, read_values
from safeloc.runtime.source_clocks import CLOCK_LAW, SourceClocks
from safeloc.target import Target

By = Literal["inputs", "part", "truth"]
"""The data that a law was checked by: inputs that decide all of it, inputs that decide a part of it, or the recorded truth."""


@dataclass(frozen=True)
class AtCycle:
    """A breach and its cycle. `seen` is true if inputs alone show the breach; otherwise only the truth does."""

    cycle: int
    breach: Breach
    seen: bool


@dataclass(frozen=True)
class JudgedLaw:
    """The result of one law, or of two that may exclude each other, on a recording.

    least   the least distance to a violation, in `unit`; below 0 if violated, None if no cycle had a distance
    cycle   the cycle with that distance
    """

    laws: tuple[BrokenLaw, ...]
    by: By
    unit: str
    least: int | None = None
    cycle: int | None = None
    breaches: tuple[AtCycle, ...] = ()


@dataclass(frozen=True)
class SourceClock:
    """Lag of a source's records behind the latest time of another source, in ms; below 0 if they were the latest.

    A `least_ms` far above 0 means that the clock of the source is behind, or that every record is delayed.
    """

    source: str
    least_ms: int
    greatest_ms: int
    behind: str


@dataclass(frozen=True)
class Judged:
    """The results of all laws of a target on one recording.

    laws      the laws that were checked
    unjudged  the laws that this recording cannot check
    clocks    of a recording of single records: the lags of its sources
    """

    target: str
    cycles: int
    with_truth: bool
    laws: tuple[JudgedLaw, ...]
    unjudged: tuple[BrokenLaw, ...] = ()
    clocks: tuple[SourceClock, ...] = ()
    one_clock: JudgedLaw | None = None

    @property
    def every(self) -> tuple[JudgedLaw, ...]:
        """All laws that were checked, the law of one clock included."""
        return self.laws if self.one_clock is None else (*self.laws, self.one_clock)

    @property
    def broken(self) -> list[JudgedLaw]:
        """The laws that were violated in some cycle."""
        return [one for one in self.every if one.breaches]


def judge_recording(target: Target, path: Path, *, period_ms: int | None = None, run: str | None = None) -> Judged:
    """Judge the laws of a target on a recording; arguments and errors are those of `replay_stream`."""
    stream, _ = read_recording(target, path, period_ms=period_ms, run=run)
    truth_known = has_truth(target, stream)
    trace = run_of(target.system if truth_known else without_ghosts(target.system), path, stream)
    around = seen(target.system)
    asked = _asked(around, with_truth=truth_known)
    found = _Judging(asked, around).on(trace)
    checked = {law for one in found for law in one.laws}
    unjudged = tuple(law for one in around.stated if (law := broken(one)) not in checked)
    if period_ms is None:  # steps do not hold the times of their records
        return Judged(target.name, len(trace.steps), truth_known, found, (*unjudged, CLOCK_LAW))
    return Judged(target.name, len(trace.steps), truth_known, found, unjudged, *_clocks(target, path, period_ms))


# ------------------------------------------------------------------ the conditions, cycle by cycle


@dataclass(frozen=True, eq=False)
class _Asked:
    """A condition to be checked: one clause or two, with its distance."""

    clauses: tuple[Stated, ...]
    by: By
    term: Bool
    distance: Distance

    def breach(self, values: Mapping[Var, Value], by: int) -> Breach:
        """Return the breach of the condition in a cycle with these values and this distance."""
        read = {var: values[var] for var in variables([self.term])}
        laws = tuple(map(broken, self.clauses))
        return Breach(laws, self.distance.of_value(by), self.distance.unit.name, read_values(read))


def _asked(around: Seen, *, with_truth: bool) -> list[_Asked]:
    """Return the conditions that a recording can check, with the truth or without it."""
    observables = [one for one in around.observables if len(one.clauses) > 1 or not with_truth]
    stated = around.stated if with_truth else ()
    return [*(_clause(around, one) for one in stated), *map(_observable, observables)]


def _clause(around: Seen, one: Stated) -> _Asked:
    hides = not around.hidden.isdisjoint(variables([one.term]))
    return _Asked((one,), "truth" if hides else "inputs", one.term, distance(one.term, around.hidden))


def _observable(one: Observable) -> _Asked:
    is_part = len(one.clauses) == 1 and not one.is_equivalent
    return _Asked(one.clauses, "part" if is_part else "inputs", one.term, distance(one.term))


class _Judging:
    """Checks the conditions in every cycle of a run, by generated code that the interpreter checks on samples."""

    def __init__(self, asked: Sequence[_Asked], around: Seen) -> None:
        self._asked, self._around = asked, around
        self._shown_by_inputs = {one: around.of(one) for one in around.stated}
        terms = [term for one in asked for term in (one.term, one.distance.term)]
        self._judge = Quick(terms)
        self._seen = Quick([one.term for one in around.observables])
        self._remember = Quick(list(around.memory.values()))

    def on(self, trace: Trace) -> tuple[JudgedLaw, ...]:
        """Return the result of each condition over all cycles of the run."""
        found = [_Found() for _ in self._asked]
        for cycle, values in enumerate(self._cycles(trace), 1):
            results = self._judge(values)
            for one, so_far, holds, by in zip(self._asked, found, results[::2], results[1::2], strict=True):
                so_far.near(cycle, one.distance.of_value(int(by)))
                if not holds:
                    seen_by_inputs = one.by != "truth" or self._is_seen(one.clauses[0], values)
                    so_far.breaches.append(AtCycle(cycle, one.breach(values, int(by)), seen_by_inputs))
        return tuple(so_far.law(one) for one, so_far in zip(self._asked, found, strict=True))

    def _is_seen(self, clause: Stated, values: Mapping[Var, Value]) -> bool:
        """Return whether an observable condition of the clause is violated in this cycle too."""
        holds = dict(zip(self._around.observables, self._seen(values), strict=True))
        return not all(holds[one] for one in self._shown_by_inputs[clause])

    def _cycles(self, trace: Trace) -> Iterator[dict[Var, Value]]:
        """Yield the values of each cycle: state before it, inputs, state after it, and the memory of the observers."""
        system, before = trace.system, trace.initial
        memory = dict(self._around.first)
        for step in trace.steps:
            values: dict[Var, Value] = {
                **{var: step.state[now.name] for var, now in self._around.after.items()},
                **memory,
                **{var: before[var.name] for var in system.state},
                **{var: step.inputs[var.name] for var in system.inputs},
            }
            yield values
            memory = dict(zip(memory, self._remember(values), strict=True))
            before = step.state


@dataclass
class _Found:
    """The result so far of one condition."""

    least: int | None = None
    cycle: int | None = None
    breaches: list[AtCycle] = field(default_factory=list)

    def near(self, cycle: int, by: int | None) -> None:
        """Take the distance of a cycle into account, if it has one."""
        if by is not None and (self.least is None or by < self.least):
            self.least, self.cycle = by, cycle

    def law(self, one: _Asked) -> JudgedLaw:
        """Return the final result."""
        laws = tuple(map(broken, one.clauses))
        return JudgedLaw(laws, one.by, one.distance.unit.name, self.least, self.cycle, tuple(self.breaches))


# ------------------------------------------------------------------ the clocks of sources


def _clocks(target: Target, path: Path, period_ms: int) -> tuple[tuple[SourceClock, ...], JudgedLaw]:
    """Return the lags of the sources of a recording of single records, and the result of the law of one clock."""
    clocks, found, latest_ms = SourceClocks(), _Found(), 0
    for source, time_ms in recorded_times(target, path):
        latest_ms = max(latest_ms, time_ms)
        cycle = max(1, -(-latest_ms // period_ms))
        lag = clocks.take(source, time_ms)
        if lag is None:
            continue
        found.near(cycle, lag.distance_ms(period_ms))
        if lag.distance_ms(period_ms) < 0:
            found.breaches.append(AtCycle(cycle, lag.breach(period_ms), seen=True))
    lags = tuple(
        SourceClock(source, clocks.least[source], lag.lag_ms, lag.behind) for source, lag in clocks.greatest.items()
    )
    return lags, JudgedLaw((CLOCK_LAW,), "inputs", "ms", found.least, found.cycle, tuple(found.breaches))
