"""The cycles of a window from a set of states, made anew, and what has to follow from them: claims, and the set handed over.

A set of states is a union of pieces; a piece names constants and ranges of variables, and a number that it does not name is in
its declared range. The solvers get the cycles as folded terms of the checker's own, with the bounds of all variables.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

from safeloc.checker.around.folding import Folding
from safeloc.checker.around.question import bounds_of
from safeloc.checker.around.tube import Tube, between, free
from safeloc.checker.dag import BOOL, INT
from safeloc.checker.solve import Opinion, Opinions
from safeloc.checker.terms import Translation
from safeloc.checker.text import Certificate
from safeloc.errors import InputError
from safeloc.language.expr import Lit, NumVar, Var
from safeloc.language.spec import Goal
from safeloc.language.system import TransitionSystem, environment

Bounds = tuple[int, int]
LATE = "not decided in time"


@dataclass(frozen=True)
class Piece:
    """Constants and ranges of variables, by name."""

    fixed: Mapping[str, int | bool]
    ranges: Mapping[str, Bounds]


@dataclass(frozen=True)
class Stretch:
    """Cycles from a piece on, or from the first state (None), and what has to follow.

    claims  number of a claim, and the cycles in which it is to hold
    to      the pieces of which one has to hold after the last cycle; None: nothing is handed over
    """

    begin: int
    piece: Piece | None
    end: int
    claims: tuple[tuple[int, range], ...] = ()
    to: tuple[Piece, ...] | None = None


@dataclass(frozen=True, eq=False)
class Setting:
    """Everything that the stretches of a passage share.

    system    with the observers of all claims
    facts     nodes over state that hold in every state
    restarts  by cycle, the values that observers take after it
    """

    system: TransitionSystem
    goals: Sequence[Goal]
    tube: Tube
    write: Translation
    facts: Sequence[int]
    restarts: Mapping[int, Mapping[Var, int | bool]]

    def bounds(self) -> dict[str, Bounds | None]:
        """Return the declared range of every state variable, those of the tube included, by name."""
        known = {var.name: bounds_of(var) for var in self.system.state}
        return {**known, **{counter.name: (0, counter.high) for counter in self.tube.counters}}

    def nodes(self) -> dict[str, int]:
        """Return the node of every state variable, by name."""
        known = {var.name: self.write(var) for var in self.system.state}
        return {**known, **{one.name: self.write.dag.variable(one.name, INT) for one in self.tube.counters}}


def show(setting: Setting, stretch: Stretch, seconds: float) -> list[tuple[str, Opinion]]:
    """Return what was asked of a stretch, with the answers of the solvers: all of it has to follow."""
    opinions = Opinions(setting.write.dag, seconds)
    return [
        (
            f"{what}, from cycle {stretch.begin}",
            opinions(Certificate(what, {}, (), frozenset(given), tuple(goals)), None),
        )
        for what, given, goals in _Cycles(setting, stretch).questions()
    ]


def not_shown(what: str, found: Opinion) -> str:
    """Return why something that was asked is not shown; "" if both solvers say that it follows."""
    if found.contradicted():
        return f"{what}: it does not follow, says {' and '.join(found.contradicted())}"
    return "" if all(map(found.confirmed, range(found.goals))) else f"{what}: {LATE}"


class _Cycles:
    """The cycles of a stretch: states, and the conditions up to each of them."""

    def __init__(self, setting: Setting, stretch: Stretch) -> None:
        self.of, self.stretch = setting, stretch
        self.folding = Folding(setting.write.dag)
        self.names = setting.nodes()
        self.states = [self._first()]
        self.conditions: list[list[int]] = [self._of_first()]
        write, system = setting.write, setting.system
        self._environment = write(environment(system))
        self._next = {write(var): write(term) for var, term in system.next.items()}
        while len(self.states) <= stretch.end - stretch.begin:
            self._step()

    def questions(self) -> Iterator[tuple[str, list[int], list[int]]]:
        """Yield what is asked, the hypotheses, and the goals that have to follow."""
        yield from self._claims()
        if self.stretch.to is not None:
            yield from self._handed_over(self.stretch.to)

    # -------------------------------------------------------------- cycles

    def _first(self) -> dict[int, int]:
        bounds, found = self.of.bounds(), dict[int, int]()
        fixed, ranges = self._begun()
        if not {*fixed, *ranges} <= self.names.keys() or fixed.keys() & ranges.keys():
            raise InputError("a set of states names a variable that there is not, or one twice")
        for name, node in self.names.items():
            declared = bounds[name]
            if name in fixed:
                value = fixed[name]
                if isinstance(value, bool) != (declared is None):
                    raise InputError(f"{name} is no {type(value).__name__}")
                found[node] = self.folding.dag.truth[value] if isinstance(value, bool) else self.folding.number(value)
            else:
                found[node] = free(self.folding, f"{name}@{self.stretch.begin}", ranges.get(name, declared))
        return found

    def _begun(self) -> tuple[Mapping[str, int | bool], Mapping[str, Bounds]]:
        """Return constants and ranges: of the piece, or of the first state as it is declared and given."""
        if self.stretch.piece is not None:
            return self.stretch.piece.fixed, self.stretch.piece.ranges
        system, fixed = self.of.system, dict[str, int | bool]()
        for var in system.state:
            declared = system.initial[var]
            if isinstance(declared, Lit):
                fixed[var.name] = declared.value
            elif isinstance(declared, (bool, int)):
                fixed[var.name] = declared
            elif var not in system.ghosts:
                fixed[var.name] = self.of.tube.given.board[0][var]
        return {**fixed, **{counter.name: 0 for counter in self.of.tube.counters}}, {}

    def _of_first(self) -> list[int]:
        replacing, found = self.folding.replacing(self.states[0]), list[int]()
        for fact in self.of.facts:
            found += replacing.conjuncts(fact)
        if self.stretch.piece is None:
            found += replacing.conjuncts(self.of.write(self.of.system.init))
            found += self.of.tube.ghosts_near(0, self.states[0], self.folding)
        return found

    def _step(self) -> None:
        number, before = self.stretch.begin + len(self.states), self.states[-1]
        counters = {one.name: before[self.names[one.name]] for one in self.of.tube.counters}
        cycle = self.of.tube.cycle(number, self.folding, counters)
        replacing = self.folding.replacing({**before, **cycle.inputs})
        after = {var: replacing(term) for var, term in self._next.items()}
        after |= {self.names[name]: term for name, term in cycle.counters.items()}
        for var, value in self.of.restarts.get(number, {}).items():
            node = self.of.write(var)
            after[node] = self.folding.dag.truth[value] if isinstance(value, bool) else self.folding.number(value)
        self.states.append(after)
        allowed = [*cycle.conditions, *replacing.conjuncts(self._environment)]
        allowed += self.of.tube.ghosts_near(number, after, self.folding)
        self.conditions.append([one for one in allowed if one != self.folding.dag.truth[True]])

    def _hypotheses(self, cycle: int) -> list[int]:
        """Return all conditions up to a cycle, with the bounds of every variable."""
        dag = self.folding.dag
        count = cycle - self.stretch.begin + 1
        bounds = list[int]()
        for node, (low, high) in self.folding.bounds.items():
            if dag.nodes[node][0] == "var":
                bounds += [dag.make("<=", [dag.number(low), node]), dag.make("<=", [node, dag.number(high)])]
        return [*bounds, *(one for some in self.conditions[:count] for one in some)]

    # -------------------------------------------------------------- what has to follow

    def _claims(self) -> Iterator[tuple[str, list[int], list[int]]]:
        """Yield the claims that folding leaves open, those together that have the same conditions."""
        by_count: dict[int, tuple[int, list[int]]] = {}
        for number, cycles in self.stretch.claims:
            good = self.of.write(self.of.goals[number].good)
            for cycle in cycles:
                at = cycle - self.stretch.begin
                goal = self.folding.replacing(self.states[at])(good)
                if goal != self.folding.dag.truth[True]:
                    count = sum(map(len, self.conditions[: at + 1]))
                    by_count.setdefault(count, (cycle, []))[1].append(goal)
        for cycle, goals in by_count.values():
            yield f"the claims up to cycle {cycle}", self._hypotheses(cycle), list(dict.fromkeys(goals))

    def _handed_over(self, pieces: Sequence[Piece]) -> Iterator[tuple[str, list[int], list[int]]]:
        """Yield that one of the pieces holds after the last cycle: their labels first, then each piece where its labels hold.

        Labels are constants that all pieces name; pieces with the same labels are asked for as they are.
        """
        dag, end, end_state = self.folding.dag, self.stretch.end, self.states[-1]
        given, what = self._hypotheses(end), f"the states after cycle {end}"
        whole = [list(self._holds(end_state, piece)) for piece in pieces]
        labels = self._labels(pieces)
        parted = [[self._equals(end_state, name, piece.fixed[name]) for name in labels] for piece in pieces]
        if len(pieces) > 1 and len({tuple(one) for one in parted}) < len(pieces):
            yield what, given, [dag.make("or", [dag.make("and", one) for one in whole])]
            return
        if len(pieces) != 1:
            yield what, given, [dag.make("or", [dag.make("and", one) for one in parted])]
        for label, conditions in zip(parted, whole, strict=True):
            goals = [one for one in dict.fromkeys(conditions) if one != dag.truth[True]]
            if goals:
                yield what, [*given, *label], goals

    def _labels(self, pieces: Sequence[Piece]) -> list[str]:
        if len(pieces) < 2:
            return []
        shared = frozenset(pieces[0].fixed).intersection(*(piece.fixed for piece in pieces))
        return [name for name in self.names if name in shared and len({piece.fixed[name] for piece in pieces}) > 1]

    def _holds(self, state: Mapping[int, int], piece: Piece) -> Iterator[int]:
        """Yield the conditions that a state belongs to a piece."""
        if not {*piece.fixed, *piece.ranges} <= self.names.keys():
            raise InputError("a set of states names a variable that there is not")
        for name, declared in self.of.bounds().items():
            if name in piece.fixed:
                yield self._equals(state, name, piece.fixed[name])
            elif declared is not None:
                yield from between(self.folding, state[self.names[name]], piece.ranges.get(name, declared))

    def _equals(self, state: Mapping[int, int], name: str, value: int | bool) -> int:
        term = state[self.names[name]]
        if isinstance(value, bool):
            if self.folding.dag.sort(term) != BOOL:
                raise InputError(f"{name} is no truth value")
            return term if value else self.folding.make("not", [term])
        return self.folding.make("=", [term, self.folding.number(value)])


def first_values(goal: Goal) -> dict[Var, int | bool]:
    """Return the observers of a goal with their first values."""
    found = dict[Var, int | bool]()
    for var in goal.observers:
        value = goal.system.initial[var]
        found[var] = (
            value.value
            if isinstance(value, Lit)
            else value
            if isinstance(value, (bool, int))
            else not isinstance(var, NumVar)
        )
    return found
