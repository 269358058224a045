"""Cover of a system: the states in which some known witness function gives lawful inputs.

The conditions on a step fall into groups that share no inputs, whose inputs can be chosen independently. A state is
covered if in every group some witness function (safeloc.proof.provers.witness_functions) meets the group's conditions.
From a state that is not covered, a further witness function is learned.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from enum import Enum

import z3

from safeloc.codegen.smt import Terms, constant, value_of
from safeloc.language.expr import Bool, Var, all_of, any_of
from safeloc.language.interpret import Program
from safeloc.language.nodes import Value
from safeloc.language.system import TransitionSystem, environment
from safeloc.language.terms import Substitution, conjuncts, variables
from safeloc.proof.provers.asking import ask, new_solver
from safeloc.proof.provers.limits import Deadline, deadline
from safeloc.proof.provers.witness_functions import Generalisation, Witness, at_rest, constants

FIRST_SECONDS = 3.0  # for the first try of a question; another seed is often quick where one is slow
State = Mapping[Var, Value]


class Learned(Enum):
    """The result for a state that was not covered."""

    COVERED = "more witness functions: it is covered now"
    DEAD = "no inputs are lawful in it"
    UNDECIDED = "the solver did not decide in time whether every state is covered, or can be"


class Group:
    """Conditions on some of the inputs, with the witness functions known for them."""

    def __init__(self, inputs: Sequence[Var], condition: Bool) -> None:
        self.inputs, self.condition = tuple(inputs), condition
        self._rest = at_rest(inputs)
        self._general = Generalisation(condition, self.inputs)
        self.met: list[Bool] = []
        self.witnesses: list[Witness] = []
        self._program, self._programs = Program([condition]), list[Program]()
        self._conditions = _Conditions(condition, self.inputs)
        self._moving = set[Var]()
        self._add(constants(self._rest))

    def _add(self, witness: Witness) -> None:
        self.met.append(Substitution(dict(witness)).bool(self.condition))
        self.witnesses.append(witness)
        self._programs.append(Program(witness.values()))

    def _take_back(self) -> None:
        """Forget the witness function that was added last."""
        for kept in (self.met, self.witnesses, self._programs):
            kept.pop()

    def _covers(self, number: int, state: State) -> bool:
        """Return whether a witness function meets the conditions in this state: its inputs are computed, and then the conditions."""
        given = zip(self.witnesses[number], self._programs[number](state), strict=True)
        return bool(self._program({**state, **dict(given)})[0])

    @property
    def covered(self) -> Bool:
        """The condition, over state, that some witness function meets the conditions."""
        return any_of(self.met)

    def learn(self, state: State, seconds: float) -> Learned:
        """Learn witness functions until this state is covered, if any inputs are lawful in it."""
        if any(self._covers(number, state) for number in range(len(self.witnesses))):
            return Learned.COVERED
        return self.cover(state, seconds)

    def cover(self, state: State, seconds: float) -> Learned:
        """Do the same for a state of which it is known that no witness function covers it yet."""
        inputs = _lawful(self._conditions.in_(state), self._conditions.inputs, self._rest, self._moving, seconds)
        if isinstance(inputs, Learned):
            return inputs
        for eager, resting in ((True, True), (True, False), (False, False)):
            self._add(self._general.witness(state, inputs, eager=eager, resting=resting))
            if self._covers(-1, state):
                return Learned.COVERED
            self._take_back()
        self._add(constants(inputs))
        return Learned.COVERED


class _Conditions:
    """The conditions of a group as a term of the solver, made once; the values of a state are put in."""

    def __init__(self, condition: Bool, inputs: Sequence[Var]) -> None:
        self.inputs = {var: constant(var) for var in inputs}
        self._state = {var: constant(var) for var in variables([condition]) if var not in self.inputs}
        self._term = Terms({**self._state, **self.inputs}).bool(condition)

    def in_(self, state: State) -> z3.ExprRef:
        """Return the conditions on the inputs in a state: with its values in them little is left to solve."""
        return z3.simplify(
            z3.substitute(self._term, *((term, _value(state[var])) for var, term in self._state.items()))
        )


def _value(value: Value) -> z3.ExprRef:
    return z3.BoolVal(value) if isinstance(value, bool) else z3.IntVal(value)


def _lawful(
    conditions: z3.ExprRef, named: Mapping[Var, z3.ExprRef], rest: State, moving: set[Var], seconds: float
) -> dict[Var, Value] | Learned:
    """Find inputs that meet the conditions, with as many of them at rest as can easily be found.

    moving  inputs that could not rest in the state asked before: each is tried when the others have been found; those of this state are kept in it
    """
    solver, ends = new_solver(), deadline(seconds)
    solver.add(conditions)
    wishes = {var: z3.FreshBool("rest") for var in named}
    solver.add(*(z3.Implies(wish, named[var] == rest[var]) for var, wish in wishes.items()))
    of_wish = {str(wish): var for var, wish in wishes.items()}
    wished = {var: wish for var, wish in wishes.items() if var not in moving}
    while (answer := ask(solver, ends.left, *wished.values())) == z3.unsat:
        core = {of_wish[str(part)] for part in solver.unsat_core()}
        if not core:
            return Learned.DEAD
        wished = {var: wish for var, wish in wished.items() if var not in core}
    if answer != z3.sat:
        return Learned.UNDECIDED
    model = solver.model()
    for var in [var for var in named if var not in wished]:
        if ask(solver, ends.left, *wished.values(), wishes[var]) == z3.sat:
            wished[var], model = wishes[var], solver.model()
    moving.clear()
    moving.update(var for var in named if var not in wished)
    return {var: value_of(model, term) for var, term in named.items()}


class Cover:
    """The groups of a system's inputs, with the witness functions of each."""

    def __init__(self, system: TransitionSystem) -> None:
        self.groups = list(_groups(system))

    @property
    def covered(self) -> Bool:
        """The condition, over state, that in every group some witness function meets the conditions."""
        return all_of(group.covered for group in self.groups)

    def learn(self, state: State, seconds: float) -> Learned:
        """Learn until the state is covered; return the result of the first group in which it cannot be covered, if any."""
        for group in self.groups:
            found = group.learn(state, seconds)
            if found is not Learned.COVERED:
                return found
        return Learned.COVERED

    def goals(self) -> dict[str, Bool]:
        """Return one goal for each group: some witness function meets its conditions."""
        many = len(self.groups) > 1
        return {
            f"a lawful step, group {number} of inputs" if many else "a lawful step": group.covered
            for number, group in enumerate(self.groups, 1)
        }


def _groups(system: TransitionSystem) -> Iterator[Group]:
    """Group the conditions on a step by shared inputs; conditions that read no input form a group without inputs."""
    inputs = set(system.inputs)
    parts = list(conjuncts(environment(system)))
    read = [[var for var in variables([part]) if var in inputs] for part in parts]
    leader = {var: var for var in system.inputs}
    for shared in read:
        for var in shared[1:]:
            leader[_first(leader, var)] = _first(leader, shared[0])
    members: dict[Var | None, list[Bool]] = {}
    for part, shared in zip(parts, read, strict=True):
        members.setdefault(_first(leader, shared[0]) if shared else None, []).append(part)
    for head, conditions in members.items():
        yield Group([var for var in system.inputs if _first(leader, var) is head], all_of(conditions))


def _first(leader: Mapping[Var, Var], var: Var) -> Var:
    while leader[var] is not var:
        var = leader[var]
    return var


def cover_facts(group: Group, facts: Sequence[Bool], ends: Deadline, seed: int) -> Learned:
    """Learn until the group covers every state with these facts, or a state is found that it cannot cover."""
    asked = _Asked(group, facts, seed)
    while True:
        answer = asked.uncovered(ends)
        if answer != z3.sat:
            return Learned.COVERED if answer == z3.unsat else Learned.UNDECIDED
        found = group.cover(asked.state(), ends.left)
        if found is not Learned.COVERED:
            return found


class _Asked:
    """A solver that searches for uncovered states; after a time without an answer, one with another seed replaces it."""

    def __init__(self, group: Group, facts: Sequence[Bool], seed: int) -> None:
        self._group, self._facts, self._seed = group, facts, seed
        self._named = {var: constant(var) for var in variables([*facts, group.condition])}
        self._terms, self._patience = Terms(self._named), FIRST_SECONDS
        self._begin()

    def _begin(self) -> None:
        self._solver, self._used = new_solver(self._seed), 0
        self._solver.add(*(self._terms.bool(fact) for fact in self._facts))

    def uncovered(self, ends: Deadline) -> z3.CheckSatResult:
        """Search for a state that satisfies the facts and that no known witness function covers."""
        while not ends.passed:
            new = self._group.met[self._used :]
            self._solver.add(*(z3.Not(self._terms.bool(met)) for met in new))
            self._used += len(new)
            answer = ask(self._solver, min(self._patience, ends.left))
            if answer != z3.unknown:
                return answer
            self._seed, self._patience = self._seed + 1, self._patience * 1.5
            self._begin()
        return z3.unknown

    def state(self) -> State:
        """Return the state that the solver found."""
        model, inputs = self._solver.model(), set(self._group.inputs)
        return {var: value_of(model, term) for var, term in self._named.items() if var not in inputs}
