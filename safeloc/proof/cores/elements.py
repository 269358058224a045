"""The elements that a proof may use: clauses of worlds, contracts, lemmas, ranges of ghosts, and rows of the machine.

To leave out a row like a clause, the values after a step become variables of their own, and each row is a condition on them
when it fires. Without the row they may be anything in range. The claim reads these variables too, instead of the row's terms.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from types import MappingProxyType
from typing import Literal

from safeloc.language.expr import Bool, Lit, Num, Var, all_of, as_bool, as_num
from safeloc.language.nodes import Expr, Value
from safeloc.language.spec import Goal, Property, observe
from safeloc.language.system import TransitionSystem
from safeloc.language.terms import Substitution, variables
from safeloc.proof.cores.clauses import assumed_clauses
from safeloc.proof.provers.kinduction import given_facts
from safeloc.proof.provers.proved_base import Base

Kind = Literal["clause", "contract", "lemma", "range", "row", "move"]


@dataclass(frozen=True, order=True)
class Element:
    """An element that a proof may use.

    clause    a clause of a world
    contract  of a composition: earlier machines guarantee the discharged assumption of a machine
    lemma     a proved lemma
    range     a ghost stays in its declared range
    row       a transition of the machine
    move      how a ghost of the world moves; an element only of `asked_of_the_world`
    """

    kind: Kind
    machine: str
    name: str


@dataclass(frozen=True, eq=False)
class Asked:
    """A claim as a goal, with all elements that its proof may use.

    steps     clause, contract or row -> condition in each step
    states    lemma or range -> condition in each state
    together  True if lemmas in use have to be proved together with the claim; in a composition the machines prove them
    """

    goal: Goal
    steps: Mapping[Element, Bool]
    states: Mapping[Element, Bool]
    together: bool

    @property
    def elements(self) -> tuple[Element, ...]:
        """All elements that the proof may use."""
        return (*self.steps, *self.states)


def asked(
    system: TransitionSystem, prop: Property, known: Base, found: Mapping[Element, Bool] = MappingProxyType({})
) -> Asked:
    """Return the claim with all elements that its proof may use; a composition has no rows among them.

    found  further invariants, over the state and observers of the claim
    """
    rows = dict[Element, Bool]()
    stepped = system
    if not system.parts:
        after = {var: _after(var) for var in system.state if var not in system.ghosts}
        stepped = replace(system, inputs=(*system.inputs, *after.values()), next={**system.next, **after})
        rows = dict(_rows(system, after))
    goal = observe(stepped, prop)
    bound = dict[Element, Bool]() if prop.unconditional else {**_clauses(system), **_contracts(known)}
    by_name = {var.name: var for var in goal.system.state}
    again = Substitution({var: by_name[var.name] for term in found.values() for var in variables([term])})
    further = {one: again.bool(term) for one, term in found.items()}
    return Asked(goal, {**bound, **rows}, {**_facts(goal, known), **further}, together=not system.parts)


def asked_of_the_world(system: TransitionSystem, prop: Property, known: Base) -> Asked:
    """Return the claim on a single machine with the elements of its world, and lemmas; the rows of the machine are as they are."""
    after = {var: _after(var) for var in system.state if var in system.ghosts}
    stepped = replace(system, inputs=(*system.inputs, *after.values()), next={**system.next, **after})
    goal = observe(stepped, prop)
    moves = {Element("move", system.name, var.name): _same(later, system.next[var]) for var, later in after.items()}
    bound = dict[Element, Bool]() if prop.unconditional else _clauses(system)
    return Asked(goal, {**bound, **moves}, _facts(goal, known), together=True)


def _after(var: Var) -> Var:
    return replace(var, name=f"{var.name} after the step")


def _clauses(system: TransitionSystem) -> dict[Element, Bool]:
    return {Element("clause", one.machine, one.name): term for one, term in assumed_clauses(system).items()}


def _contracts(known: Base) -> dict[Element, Bool]:
    return {Element("contract", fact.of, str(fact)): term for fact, term in known.kept.items()}


def _facts(goal: Goal, known: Base) -> dict[Element, Bool]:
    """Return the lemmas and ranges of ghosts that the claim may use; on-board ranges hold for all inputs and are no elements."""
    usable = {id(term) for term in given_facts(goal, known)}
    ghosts = {var.name for var in goal.original.ghosts}
    found = dict[Element, Bool]()
    for fact, term in {**known.always, **known.facts}.items():
        if id(term) in usable and (fact.kind == "lemma" or (fact.kind == "range" and fact.of in ghosts)):
            found[Element("range" if fact.kind == "range" else "lemma", goal.original.name, str(fact))] = term
    return found


def _rows(system: TransitionSystem, after: Mapping[Var, Var]) -> Iterator[tuple[Element, Bool]]:
    """Yield each row with the condition on the values that it sets when it fires."""
    [machine], [(name, fired)] = system.machines, system.fired.items()
    for number, row in enumerate(machine.transitions, 1):
        new: dict[Var, Expr | Value] = {machine.mode: row.target, **row.set}
        sets = all_of(_same(later, new.get(var, var)) for var, later in after.items())
        yield Element("row", machine.name, row.name), fired.eq(Lit(number, name.unit)).implies(sets)


def nothing_fires(system: TransitionSystem, goal: Goal) -> Bool:
    """Return the condition that on-board state stays if no row fires; TRUE for a composition, whose terms state this."""
    if system.parts:
        return all_of(())
    [(name, fired)] = system.fired.items()
    moved = goal.system.next
    on_board = [var for var in system.state if var not in system.ghosts]
    return fired.eq(Lit(0, name.unit)).implies(all_of(_same(moved[var], var) for var in on_board))


def _same(var: Expr, value: Expr | Value) -> Bool:
    if isinstance(var, Num):
        return var.eq(value if isinstance(value, Num) else as_num(int(value), var.unit))  # type: ignore[arg-type]
    assert isinstance(var, Bool)
    return var.iff(value if isinstance(value, Bool) else as_bool(bool(value)))
