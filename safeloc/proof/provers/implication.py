"""Check with z3 that goals follow from hypotheses: find the hypotheses that the proof needs, or a countermodel of each
goal that fails.
"""

from __future__ import annotations

import weakref
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import z3

from safeloc.codegen.smt import Terms, constant, implied, require, value_of
from safeloc.codegen.smtlib import Key, Query, to_smtlib
from safeloc.language.expr import Bool, Var
from safeloc.language.nodes import Value
from safeloc.language.terms import conjuncts, variables
from safeloc.language.trace import shown
from safeloc.proof.cache.answers import keep_proved, keep_unproved, keeping, proved_before, unproved_before
from safeloc.proof.provers.asking import ask, plain_solver, why_unknown
from safeloc.proof.provers.limits import Deadline, deadline
from safeloc.proof.provers.once import alone_in_asking


@dataclass(frozen=True)
class Refuted:
    """The goal does not follow; `example` gives values under which the hypotheses hold and it does not."""

    example: Mapping[str, str]

    @property
    def values(self) -> str:
        """The example as text."""
        return ", ".join(f"{name} = {value}" for name, value in self.example.items())

    def __str__(self) -> str:
        return f"does not follow, for example when {self.values}"


@dataclass(frozen=True)
class Undecided:
    """The solver gave up, for the stated reason."""

    reason: str

    def __str__(self) -> str:
        return f"undecided: {self.reason}"


Failure = Refuted | Undecided
CORE_SECONDS = 10.0
"""Seconds of effort to prove all goals together and find the hypotheses needed; most queries take 0.1 s."""
_CORES: weakref.WeakKeyDictionary[Query[Any], Sequence[int]] = weakref.WeakKeyDictionary()
"""Numbers of the hypotheses that z3's proof of a query used. A proposal only: the second solver decides from these hypotheses."""

_TEXTS: weakref.WeakKeyDictionary[Query[Any], str] = weakref.WeakKeyDictionary()


def text_of(query: Query[Key]) -> str:
    """Return the query as text, under which its answers are cached; written once for each query."""
    if query not in _TEXTS:
        _TEXTS[query] = to_smtlib(query)
    return _TEXTS[query]


def parts_of(query: Query[Key]) -> list[Bool]:
    """Return the hypotheses, conjunct by conjunct, each once."""
    return list(dict.fromkeys(part for term in query.hypotheses for part in conjuncts(term)))


def core_of(query: Query[Key]) -> Sequence[int] | None:
    """Return the numbers of the parts that z3's proof of all goals used, if this process has found that proof."""
    return _CORES.get(query)


def find_core(query: Query[Key], seconds: float) -> Sequence[int] | None:
    """Search for that proof now; None if z3 finds no proof of all goals together within the seconds of effort."""
    _Asked(query, 0).with_core(deadline(seconds))
    return core_of(query)


def unproved(
    query: Query[Key], seconds: float, seed: int = 0, core_seconds: float = CORE_SECONDS
) -> dict[Key, Failure]:
    """Return the goals, by key, that do not follow or are undecided within `seconds` for all goals together.

    core_seconds  how much of them, at most half, is for a proof of all goals that tells the hypotheses that it needs; 0 where nobody
                  asks for these: a hypothesis with a switch makes z3 slower
    """
    if not keeping():
        return _failures(query, seconds, seed, core_seconds)
    text = text_of(query)
    if proved_before(text):
        return {}
    with alone_in_asking("z3", text):
        failed = {} if proved_before(text) else _failures(query, seconds, seed, core_seconds)
        if not failed:
            keep_proved(text)
    return failed


def following(query: Query[Key], seconds: float) -> set[Key]:
    """Return the goals that z3 proves within `seconds` for all goals together; nobody asks why the others do not follow.

    Which ones these are is kept, unless the clock ended the search: asked again, the query is answered by the proof of the rest.
    """
    if not keeping():
        return query.goals.keys() - _failures(query, seconds, 0, 0.0).keys()
    text = text_of(query)
    with alone_in_asking("z3", text):
        found = _following_before(query, text, seconds)
        if found is None:
            ends = deadline(seconds)
            found = query.goals.keys() - _failures(query, seconds, 0, 0.0).keys()
            if found:
                keep_proved(text_of(_only(query, found)))
            if not ends.overdue:
                keep_unproved(text, seconds, [number for number, key in enumerate(query.goals) if key not in found])
    return found


def _following_before(query: Query[Key], text: str, seconds: float) -> set[Key] | None:
    """Return the goals that followed before; None if that is not known of each goal, with so much effort."""
    if proved_before(text):
        return set(query.goals)
    left = unproved_before(text, len(query.goals), seconds)
    if left is None:
        return None
    found = {key for number, key in enumerate(query.goals) if number not in left}
    return found if not found or proved_before(text_of(_only(query, found))) else None


def _only(query: Query[Key], keys: Collection[Key]) -> Query[Key]:
    """Return the query with these goals."""
    return Query(query.name, query.hypotheses, {key: goal for key, goal in query.goals.items() if key in keys})


def countermodel(query: Query[Key], seconds: float, seed: int = 0) -> dict[Var, Value] | None:
    """Return values of the query's variables under which all hypotheses hold and some goal does not.

    None if every goal follows, or if z3 does not decide within the seconds of effort.
    """
    return _Asked(query, seed).countermodel(deadline(seconds))


def _failures(query: Query[Key], seconds: float, seed: int, core_seconds: float) -> dict[Key, Failure]:
    asked, ends = _Asked(query, seed), deadline(seconds)
    failed = asked.with_core(deadline(min(core_seconds, seconds / 2))) if core_seconds else {}
    if len(asked.left) > 1:
        failed |= asked.together(deadline(ends.left / 2))
    if asked.left:
        failed |= asked.one_by_one(ends)
    return {key: failed[key] for key in query.goals if key in failed}


class _Asked:
    """A query translated to z3; `left` holds the goals that are not decided yet.

    Each question gets a new solver: one that pushes and pops questions can take a hundred times as long.
    """

    def __init__(self, query: Query[Key], seed: int) -> None:
        self._query, self._goals, self._seed = query, query.goals, seed
        self._named = {var: constant(var) for var in variables([*query.hypotheses, *query.goals.values()])}
        terms = Terms(self._named)
        self._hypotheses = [terms.bool(term) for term in parts_of(query)]
        self.left = {key: terms.bool(goal) for key, goal in query.goals.items()}

    def with_core(self, ends: Deadline) -> dict[Any, Failure]:
        """Ask for all goals at once, with a switch for each hypothesis: a proof gives the core, a model refutes some
        goals.
        """
        if not self.left:
            return {}
        solver = plain_solver(self._seed)
        switches = [z3.Bool(number) for number in range(len(self._hypotheses))]  # no variable's name is a number
        for switch, hypothesis in zip(switches, self._hypotheses, strict=True):
            require(solver, implied(switch, hypothesis))
        solver.add(z3.Not(z3.And(*self.left.values())))
        answer = ask(solver, ends.left, *switches)
        if answer == z3.sat:
            return self._taken_out(solver.model())
        if answer == z3.unsat:
            used = {switch.get_id() for switch in solver.unsat_core()}  # pyright: ignore[reportAttributeAccessIssue, reportOptionalMemberAccess] # a term
            _CORES[self._query] = [number for number, switch in enumerate(switches) if switch.get_id() in used]
            self.left = {}
        return {}

    def countermodel(self, ends: Deadline) -> dict[Var, Value] | None:
        """Return the values of all variables in a model of the hypotheses in which some goal is false, if z3 finds one."""
        solver = self._solver(z3.Not(z3.And(*self.left.values())))
        if ask(solver, ends.left) != z3.sat:
            return None
        model = solver.model()
        return {var: value_of(model, term) for var, term in self._named.items()}

    def together(self, ends: Deadline) -> dict[Any, Failure]:
        """Ask for all goals left together: each model refutes the goals that are false in it, until the rest follows or
        time is up.
        """
        failed: dict[Any, Failure] = {}
        while self.left and not ends.passed:
            solver = self._solver(z3.Not(z3.And(*self.left.values())))
            answer = ask(solver, ends.left)
            if answer == z3.unknown:
                break
            if answer == z3.unsat:
                self.left = {}
                break
            failed |= self._taken_out(solver.model())
        return failed

    def _taken_out(self, model: z3.ModelRef) -> dict[Any, Failure]:
        """Return the goals that are false in the model, and remove them from `left`."""
        false = [key for key, goal in self.left.items() if z3.is_false(model.eval(goal, model_completion=True))]
        self.left = {key: goal for key, goal in self.left.items() if key not in false}
        return {key: self._refuted(key, model) for key in false}

    def one_by_one(self, ends: Deadline) -> dict[Any, Failure]:
        """Ask for each goal left alone; return those that do not follow or are undecided."""
        failed: dict[Any, Failure] = {}
        for key, goal in self.left.items():
            solver = self._solver(z3.Not(goal))
            answer = ask(solver, ends.left)
            if answer == z3.sat:
                failed[key] = self._refuted(key, solver.model())
            elif answer == z3.unknown:
                failed[key] = Undecided("limit reached" if ends.passed else f"solver: {why_unknown(solver)}")
        self.left = {}
        return failed

    def _solver(self, condition: z3.BoolRef | z3.Probe) -> z3.Solver:
        solver = plain_solver(self._seed)
        solver.add(*self._hypotheses, condition)
        return solver

    def _refuted(self, key: Any, model: z3.ModelRef) -> Refuted:
        return Refuted(
            {var.name: shown(var, value_of(model, self._named[var])) for var in variables([self._goals[key]])}
        )
