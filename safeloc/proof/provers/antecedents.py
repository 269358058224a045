"""Vacuity check: find out if the cases of a property ever occur. A property without them is true but worthless.

All cases of a system are searched together: in recordings, by one bounded search, and, for an inherited property, in runs
of its machine. A case that is not found is excluded by induction if possible; otherwise it stays open.
"""

from __future__ import annotations

import weakref
from collections.abc import Callable, Container, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import TypeAlias

from safeloc.codegen.smtlib import Query
from safeloc.language.antecedents import Antecedent, antecedents, case_name, cases, occurs, occurs_alone
from safeloc.language.expr import TRUE, Bool
from safeloc.language.spec import Goal, Property, watch
from safeloc.language.system import Part, TransitionSystem, environment, first_without_the_world, in_range
from safeloc.language.terms import Substitution
from safeloc.language.trace import Trace
from safeloc.language.verdict import SEVERAL_RUNS, Proved, Unknown, Vacuous, Verdict
from safeloc.proof.drawn_runs.quick import run_again
from safeloc.proof.provers.beside import beside
from safeloc.proof.provers.drawn import drawn
from safeloc.proof.provers.implication import following
from safeloc.proof.provers.kinduction import given_facts, kinduction
from safeloc.proof.provers.limits import CLOCK, Deadline, Limits, deadline
from safeloc.proof.provers.obligation import Obligation
from safeloc.proof.provers.onward import onward
from safeloc.proof.provers.proved_base import base
from safeloc.proof.provers.recorded_witnesses import NO_WITNESSES, Recording, Witnesses, come_to
from safeloc.proof.provers.recorded_witnesses import shown as shown_by
from safeloc.proof.provers.searches import AT_FIRST, first_runs, sparing_runs
from safeloc.proof.provers.spacer import spacer
from safeloc.proof.provers.verdicts_as_data import PackedTrace, pack_trace, unpack_trace
from safeloc.proof.provers.workers import Lost, Task

__all__ = [
    "Case",
    "Found",
    "all_cases",
    "all_known",
    "antecedents",
    "found",
    "known_runs_task",
    "remember",
    "search_task",
]

REMEDY = (
    "so the property requires nothing. Remove it or mend it; if you meant it the other way round, write the "
    "condition first, with implies."
)
RANDOM, SHIPPED = "in random runs", "in a shipped witness"
ENGINES = {RANDOM: "drawn", SHIPPED: "witness"}
"""Where a run was found that no search made -> the engine that a result names."""
PATIENCE = 3  # time limits of one property that all cases of a system get together


@dataclass(frozen=True)
class Seen:
    """The case occurs. `where` says how that is known; `run` is the witness if a search found one."""

    where: str
    run: PackedTrace | None = None


@dataclass(frozen=True)
class Never:
    """The case is proved never to occur."""

    engine: str


@dataclass(frozen=True)
class Open:
    """The case is neither found nor excluded."""

    reason: str


Outcome: TypeAlias = Seen | Never | Open


@dataclass(frozen=True, eq=False)
class Case:
    """A case and the outcome of its search."""

    antecedent: Antecedent
    outcome: Outcome


@dataclass(frozen=True, eq=False)
class Found:
    """The results of the search for the cases of some properties."""

    system: TransitionSystem
    cases: tuple[Case, ...]

    def judged(self, prop: Property, verdict: Verdict) -> Verdict:
        """Return the verdict on a property: Vacuous instead of Proved if one of its cases never occurs."""
        never = [case for case in self.cases if case.antecedent.prop is prop and isinstance(case.outcome, Never)]
        if not isinstance(verdict, Proved) or not never:
            return verdict
        names = "; ".join(f"{_words(case)}" for case in never)
        return Vacuous(f"{names}: {REMEDY}")

    def runs(self) -> list[Trace]:
        """Return the runs that a search found, made again; recorded runs are known already.

        The run of a case of an unconditional property may begin in a first state that the environment excludes.
        """
        packed = {id(run_): run_ for run_ in map(_run, self.cases) if run_ is not None and not run_.part}
        return [run_again(self._anyhow, one.stream, first=one.initial) for one in packed.values()]

    def obligation(self) -> Iterator[Obligation]:
        """Yield the obligation that all cases occur, and one for each run that a search found; nothing if there are no
        cases.
        """
        if self.cases:
            seen = [case.outcome.where for case in self.cases if isinstance(case.outcome, Seen)]
            counts = ", ".join(f"{seen.count(where)} {where}" for where in dict.fromkeys(seen))
            statement = "every case of every property occurs: each trigger, and each condition before `implies`"
            method = f"{len(seen)} of {len(self.cases)} cases occur" + (f": {counts}" if counts else "")
            yield Obligation("antecedents", statement, self._verdict(), method)
            yield from self._each()

    def _each(self) -> Iterator[Obligation]:
        """Yield one obligation for each case that a search found, with its run.

        Cases seen in recordings need none: every replay of the recording shows them again.
        """
        for prop in dict.fromkeys(case.antecedent.prop for case in self.cases):
            own = (case for case in self.cases if case.antecedent.prop is prop)
            for place, case in enumerate(own, 1):
                if isinstance(case.outcome, Seen) and case.outcome.run is not None:
                    witness = unpack_trace(case.outcome.run, self._anyhow)
                    steps = len(case.outcome.run.stream)
                    engine = ENGINES.get(case.outcome.where, "bmc")
                    verdict = Proved(None, engine, steps, ("interpreter",), witness=witness)
                    alone = f" in {case.outcome.run.part}, by itself" if case.outcome.run.part else ""
                    name, text = case_name(prop, place), f"{_named(case)} occurs{alone}"
                    yield Obligation(name, text, verdict, f"a run of {steps} steps, {case.outcome.where}")

    @property
    def _anyhow(self) -> TransitionSystem:
        return replace(self.system, assume=TRUE, init=first_without_the_world(self.system))

    def _verdict(self) -> Verdict:
        open_ = [case for case in self.cases if isinstance(case.outcome, Open)]
        never = [case for case in self.cases if isinstance(case.outcome, Never)]
        if open_:
            return Unknown("; ".join(f"{_named(case)} is neither found nor excluded" for case in open_))
        if never:
            return Vacuous("; ".join(map(_never, never)))
        return Proved(None, SEVERAL_RUNS)


def _named(case: Case) -> str:
    return f"{case.antecedent.prop.name!r}: {case.antecedent.words}"


def _never(case: Case) -> str:
    return f"{case.antecedent.prop.name!r}: {_words(case)}"


def _words(case: Case) -> str:
    assert isinstance(case.outcome, Never)
    return f"{case.antecedent.words} never occurs (proved by {case.outcome.engine})"


def _run(case: Case) -> PackedTrace | None:
    return case.outcome.run if isinstance(case.outcome, Seen) else None


# ------------------------------------------------------------------ earlier results


@dataclass(frozen=True, eq=False)
class _Known:
    """Outcomes of a property's cases, with the time limit and the number of recordings of that search."""

    outcomes: tuple[Outcome, ...]
    seconds: float
    recordings: int

    def serves(self, limits: Limits, recordings: int) -> bool:
        """Return whether another search could find no more."""
        tried = self.seconds >= limits.seconds and self.recordings >= recordings
        return tried or not any(isinstance(outcome, Open) for outcome in self.outcomes)


_KNOWN: weakref.WeakKeyDictionary[TransitionSystem, dict[Property, _Known]] = weakref.WeakKeyDictionary()


def all_known(system: TransitionSystem, properties: Sequence[Property], limits: Limits, recordings: int) -> bool:
    """Return whether the outcomes of all cases are stored, and another search with that many recordings could find no more."""
    known = _KNOWN.get(system, {})
    return all(prop in known and known[prop].serves(limits, recordings) for prop in properties if antecedents(prop))


def known_runs_task(
    system: TransitionSystem,
    properties: Sequence[Property],
    limits: Limits,
    recordings: Sequence[Recording],
    witnesses: Witnesses,
) -> Task:
    """Return a task that returns the cases, by number, that recordings and shipped witnesses show; it needs no proved fact."""
    asked, ends = all_cases(properties), PATIENCE * limits.seconds
    name = f"{system.name}: cases in known runs"
    return Task(name, lambda: in_known_runs(system, asked, recordings, witnesses, deadline(ends)), CLOCK * ends)


def search_task(
    system: TransitionSystem,
    properties: Sequence[Property],
    limits: Limits,
    recordings: Sequence[Recording],
    witnesses: Witnesses,
    shown: Mapping[int, Outcome],
) -> Task:
    """Return a task that returns the outcome of each case, in order; `shown` are those of known runs, by number."""
    most = CLOCK * 2 * (PATIENCE + 1) * limits.seconds
    name = f"{system.name}: cases of its properties"
    return Task(name, lambda: search(system, all_cases(properties), limits, recordings, witnesses, shown), most)


def remember(
    system: TransitionSystem,
    properties: Sequence[Property],
    limits: Limits,
    recordings: int,
    outcomes: Sequence[Outcome] | Lost,
) -> None:
    """Store the outcomes of a search in another process, in the order of the cases.

    All cases stay open if that process was lost.
    """
    mine = _KNOWN.setdefault(system, {})
    asked = all_cases(properties)
    if isinstance(outcomes, Lost):
        outcomes = [Open(outcomes.reason)] * len(asked)
    for prop in properties:
        own = [outcome for one, outcome in zip(asked, outcomes, strict=True) if one.prop is prop]
        mine[prop] = _Known(tuple(own), limits.seconds, recordings)


def found(system: TransitionSystem, properties: Sequence[Property]) -> Found:
    """Return the known outcomes of the cases of these properties; a case that was never searched is open."""
    known = _KNOWN.get(system, {})
    made: list[Case] = []
    for prop in properties:
        own = cases(prop)
        outcomes = known[prop].outcomes if prop in known else [Open("nobody looked")] * len(own)
        made += [Case(one, outcome) for one, outcome in zip(own, outcomes, strict=True)]
    return Found(system, tuple(made))


def all_cases(properties: Sequence[Property]) -> list[Antecedent]:
    """Return the cases of all properties, in order; a search numbers them so."""
    return [one for prop in properties for one in cases(prop)]


# ------------------------------------------------------------------ the search


def search(
    system: TransitionSystem,
    asked: Sequence[Antecedent],
    limits: Limits,
    recordings: Sequence[Recording] = (),
    witnesses: Witnesses = NO_WITNESSES,
    shown: Mapping[int, Outcome] | None = None,
) -> list[Outcome]:
    """Return the outcome of each case, in order. Cases that rely on the same assumption are searched together.

    shown  outcomes that known runs show, by number of the case; None: they are looked for here
    """
    ends = deadline(PATIENCE * limits.seconds)
    known = in_known_runs(system, asked, recordings, witnesses, ends) if shown is None else shown
    outcomes, groups = dict(known), _groups(_goals(system, asked), known)
    for left, group in zip(range(len(groups), 0, -1), groups, strict=True):
        outcomes |= _Together(system, asked, group, limits, ends.left / left).outcomes(recordings, witnesses)
    return [outcomes[number] for number in range(len(asked))]


def in_known_runs(
    system: TransitionSystem,
    asked: Sequence[Antecedent],
    recordings: Sequence[Recording],
    witnesses: Witnesses,
    ends: Deadline,
) -> dict[int, Outcome]:
    """Return the cases, by number, that occur in recordings or in shipped witnesses of the whole."""
    goals = _goals(system, asked)
    found: dict[int, Outcome] = dict.fromkeys(come_to(system, goals, recordings, ends), Seen("in recordings"))
    for group in _groups(goals, found):
        numbers = {goal: number for number, goal in group.items()}
        for goal, trace in shown_by(list(numbers), witnesses.get(system.name, ())).items():
            found[numbers[goal]] = Seen(SHIPPED, pack_trace(trace))
    return found


def _goals(system: TransitionSystem, asked: Sequence[Antecedent]) -> dict[int, Goal]:
    return {number: occurs(system, one, f"case {number}") for number, one in enumerate(asked)}


def _groups(goals: Mapping[int, Goal], known: Container[int]) -> list[dict[int, Goal]]:
    """Return the goals that are not known, by number; those of a group rely on the same assumption."""
    groups: dict[Bool, dict[int, Goal]] = {}
    for number, goal in goals.items():
        if number not in known:
            groups.setdefault(goal.system.assume, {})[number] = goal
    return list(groups.values())


class _Together:
    """The search for cases, by number, that rely on the same assumption."""

    def __init__(
        self,
        system: TransitionSystem,
        asked: Sequence[Antecedent],
        goals: Mapping[int, Goal],
        limits: Limits,
        seconds: float,
    ) -> None:
        self._system, self._asked, self._goals, self._limits = system, asked, goals, limits
        self._ends = deadline(seconds)
        self._found: dict[int, Outcome] = {}

    def outcomes(self, recordings: Sequence[Recording], witnesses: Witnesses) -> dict[int, Outcome]:
        """Return the outcome of each case.

        Tried in turn: exclusion in one step, random runs, bounded search, search from states of recordings,
        runs of one machine alone, exclusion by k-induction and by Spacer. The rest stays open. In a composition a short search
        and the runs of one machine come first for properties that it inherits from that machine: those of its own need a run
        of the whole. For a case of an inherited property that a shipped witness of one machine alone shows, the whole is not searched:
        that was in vain when the witness was made.
        """
        self._exclude(self._unlikely(), self._ends.left / 3)
        alone = {number: run for number in self._left if (run := self._shipped_alone(number, witnesses)) is not None}
        self._draw([number for number in self._left if number not in alone], recordings)
        if self._system.parts:
            self._find_alone([number for number in self._inherited if number in alone], alone)
            self._search(min(self._ends.left, self._limits.seconds * AT_FIRST))
            self._find_alone(self._inherited, alone)
        self._search(self._ends.left / 2)
        self._beside(recordings)
        self._find_alone(self._left, alone)
        self._exclude(self._left, self._ends.left / 2)
        self._exclude(self._left, self._ends.left, spacer)
        return self._found | {number: Open("not found") for number in self._left}

    @property
    def _inherited(self) -> list[int]:
        """The cases left of properties that the composition inherits from a machine."""
        return [number for number in self._left if self._asked[number].prop.kept_by is not None]

    @property
    def _left(self) -> list[int]:
        return [number for number in self._goals if number not in self._found]

    def _draw(self, some: Sequence[int], recordings: Sequence[Recording]) -> None:
        """Find some cases in random runs, and in a composition beside recordings."""
        numbers = {self._goals[number]: number for number in some}
        found = drawn(list(numbers), self._limits.seed)
        if self._system.parts:
            found |= beside([goal for goal in numbers if goal not in found], recordings, self._limits.seed)
        for goal, trace in found.items():
            self._found[numbers[goal]] = Seen(RANDOM, pack_trace(trace))

    def _search(self, seconds: float) -> None:
        left = self._left
        if not left:
            return
        search = sparing_runs if self._system.parts else first_runs
        runs = search([self._goals[number] for number in left], self._within(seconds))
        for number in left:
            trace = runs.found.get(self._goals[number])
            if trace is not None:
                self._found[number] = Seen("by search", pack_trace(trace))

    def _beside(self, recordings: Sequence[Recording]) -> None:
        left = {number: self._goals[number] for number in self._left}
        for number, trace in onward(self._system, left, recordings, deadline(self._ends.left / 2)).items():
            self._found[number] = Seen("a few steps beside a recording", pack_trace(trace))

    def _unlikely(self) -> list[int]:
        """Return the cases that hold in no first state and after no step from a state with the proved facts."""
        left = self._left
        if not left:
            return []
        goals = {number: self._goals[number] for number in left}
        watched = watch(goals[left[0]].plain, list(goals.values()))
        after = Substitution(dict(watched.system.next))
        first = {number: goal.good for number, goal in goals.items()}
        later = {number: goal.good.implies(after.bool(goal.good)) for number, goal in goals.items()}
        start = Query("first", [watched.system.init, in_range(watched.system.state)], first)
        step = Query("step", [environment(watched.system), *self._facts(self._goals[left[0]])], later)
        seconds = self._ends.left / 4
        never_first, never_later = following(start, seconds), following(step, seconds)
        return [number for number in left if number in never_first and number in never_later]

    def _facts(self, goal: Goal) -> list[Bool]:
        known = base(self._system, seconds=self._limits.seconds)
        kept = [] if goal.prop.unconditional else list(known.kept.values())
        return [*given_facts(goal, known), *kept]

    def _exclude(
        self, numbers: Sequence[int], seconds: float, engine: Callable[[Goal, Limits], Verdict] = kinduction
    ) -> None:
        """Mark the cases that the engine proves never to occur; each gets an equal share of the time left."""
        ends = deadline(seconds)
        for left, number in zip(range(len(numbers), 0, -1), numbers, strict=True):
            verdict = engine(self._goals[number], self._within(ends.left / left))
            if isinstance(verdict, Proved):
                self._found[number] = Never(verdict.engine)

    def _find_alone(self, numbers: Sequence[int], shipped: Mapping[int, Trace]) -> None:
        """Find runs of one machine alone, for inherited properties and cases that read one machine only.

        shipped  such runs of shipped witnesses, by number of the case
        """
        for number in numbers:
            if self._ends.passed:
                return
            own = self._of_one_machine(number)
            if own is not None:
                part, goal = own
                trace = shipped.get(number)
                if trace is None:
                    trace = first_runs([goal], self._within(self._ends.left / 4)).found.get(goal)
                if trace is not None:
                    self._found[number] = Seen(f"of {part.name} by itself, none of the whole", pack_trace(trace))

    def _of_one_machine(self, number: int) -> tuple[Part, Goal] | None:
        """Return the machine in which the case could occur alone, and that goal."""
        prop = self._asked[number].prop
        place = [one for one, case in enumerate(self._asked) if case.prop is prop].index(number)
        return occurs_alone(self._system, prop, place)

    def _shipped_alone(self, number: int, witnesses: Witnesses) -> Trace | None:
        """Return the run of a shipped witness of one machine alone in which the case occurs; None if there is none."""
        own = self._of_one_machine(number)
        return None if own is None else shown_by([own[1]], witnesses.get(own[0].alone.name, ())).get(own[1])

    def _within(self, seconds: float) -> Limits:
        return replace(self._limits, seconds=max(0.001, seconds))
