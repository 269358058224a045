"""The claims of a machine: its properties and lemmas, the ranges of its variables, and the mutual exclusion of its rows.

Claims are grouped into layers by what they assume: nothing, the assumption of the machine, or a further assumption of a property.
Each layer is one system with the observers of its properties.
"""

from __future__ import annotations

from collections.abc import Collection, Iterable, Iterator, Mapping
from dataclasses import dataclass, replace
from itertools import combinations
from typing import Literal

from safeloc.assurance.mutation.declared import Declared
from safeloc.language.expr import TRUE, Bool, Expr, NumVar, Var
from safeloc.language.machine import Machine
from safeloc.language.spec import Goal, observe, watch
from safeloc.language.system import TransitionSystem, first_without_the_world, in_range
from safeloc.language.terms import Sharing, Substitution, variables
from safeloc.proof.provers.standing import Standing

_ClaimKind = Literal["property", "lemma", "range", "helper"]


@dataclass(frozen=True, eq=False)
class Claim:
    """One claim: `good` has to hold in every state of its layer's system. `goal` is set for a property and its helper.

    Rows that exclude each other are no claim of a layer: they are judged of one state, apart (`Held.exclusions`).
    """

    kind: _ClaimKind
    name: str
    good: Bool
    goal: Goal | None = None

    def __str__(self) -> str:
        return f"{self.kind} {self.name}"


@dataclass(frozen=True, eq=False)
class Layer:
    """Claims with the same assumption: `system` has this assumption, and their observers.

    hypotheses  ranges and lemmas of earlier layers, which proofs of this layer use
    """

    system: TransitionSystem
    claims: tuple[Claim, ...]
    hypotheses: tuple[Claim, ...]


class Canon:
    """Terms that all mutants of a declaration share: equal terms are one node, observers of one name are one variable.

    Unchanged terms are therefore recognised by identity, and the solver (`asked`) translates each of them once.
    """

    def __init__(self) -> None:
        self.share = Sharing()
        self.asked = Standing()
        self._known: dict[tuple[object, ...], Var] = {}
        self._seconds: dict[tuple[Var, ...], tuple[Substitution, dict[Var, Var]]] = {}

    def observers(self, made: tuple[Var, ...]) -> Substitution:
        """Return a substitution that replaces each observer by the first one of the same name, kind and range."""
        return Substitution({var: self._known.setdefault(_alike(var), var) for var in made})

    def second(self, variables: Iterable[Var]) -> tuple[Substitution, Mapping[Var, Var]]:
        """Return what rewrites terms for the mutant's copy of a machine, with the copy of each variable; terms that were met are not rewritten again."""
        own = tuple(variables)
        if own not in self._seconds:
            twins = {var: self._twin(var) for var in own}
            self._seconds[own] = (Substitution(dict(twins)), twins)
        return self._seconds[own]

    def _twin(self, var: Var) -> Var:
        twin = replace(var, name=f"mutant.{var.name}")
        return self._known.setdefault(_alike(twin), twin)


def _alike(var: Var) -> tuple[object, ...]:
    """Return the key by which variables count as one: the name, and for a number its range."""
    return (var.name, var.low, var.high) if isinstance(var, NumVar) else (var.name,)


@dataclass(frozen=True, eq=False)
class Held:
    """A declaration with all its claims. `system` is the machine in its world, without observers.

    exclusions  for rows of equal rank, by words: a term that says that the two are not enabled together
    """

    declared: Declared
    system: TransitionSystem
    layers: tuple[Layer, ...]
    exclusions: Mapping[str, Bool]


def held(declared: Declared, canon: Canon, under_assumption: Collection[str] = ()) -> Held:
    """Return all claims of a declaration but the `reachable` ones; ModelError or PropertyError if it is not valid.

    under_assumption  lemmas that read no ghost, but hold only under the assumption
    """
    system = settled(declared.lowered(), canon)
    goals = [observe(system, prop) for prop in declared.properties if prop.kind != "reachable"]
    free = [goal for goal in goals if goal.prop.unconditional and goal.prop.further_assumption is TRUE]
    bound = [goal for goal in goals if not goal.prop.unconditional and goal.prop.further_assumption is TRUE]
    on_board = replace(system, assume=TRUE, init=first_without_the_world(system))
    own, others = _facts(system, under_assumption)
    board = _layer(on_board, free, own, (), canon)
    facts = tuple(claim for claim in board.claims if claim.goal is None and claim.kind != "helper")
    world = _layer(system, bound, others, facts, canon)
    known = tuple(claim for claim in world.claims if claim.goal is None and claim.kind != "helper")
    further = [
        _layer(goal.plain, [goal], (), facts if goal.prop.unconditional else (*facts, *known), canon)
        for goal in goals
        if goal.prop.further_assumption is not TRUE
    ]
    return Held(declared, system, (board, world, *further), dict(_exclusions(declared.machine, canon)))


def settled(system: TransitionSystem, canon: Canon) -> TransitionSystem:
    """Return the system with its terms replaced by the shared nodes."""
    share = canon.share
    return replace(
        system,
        init=share.bool(system.init),
        next={var: share(term) for var, term in system.next.items()},
        assume=share.bool(system.assume),
        outputs={name: share(term) for name, term in system.outputs.items()},
        fired={var: share.num(term) for var, term in system.fired.items()},
        lemmas={name: share.bool(term) for name, term in system.lemmas.items()},
    )


def _facts(system: TransitionSystem, under_assumption: Collection[str]) -> tuple[tuple[Claim, ...], tuple[Claim, ...]]:
    """Return ranges and lemmas in two groups: those for all inputs, and those that read ghosts or need the assumption."""
    facts: tuple[list[Claim], list[Claim]] = [], []
    for var in system.state:
        if isinstance(var, NumVar):
            facts[var in system.ghosts].append(Claim("range", var.name, in_range([var])))
    for name, term in system.lemmas.items():
        bound = name in under_assumption or not system.ghosts.isdisjoint(variables([term]))
        facts[bound].append(Claim("lemma", name, term))
    return tuple(facts[0]), tuple(facts[1])


def _layer(
    system: TransitionSystem, goals: list[Goal], facts: tuple[Claim, ...], hypotheses: tuple[Claim, ...], canon: Canon
) -> Layer:
    watched = watch(system, goals)
    settle = canon.observers(watched.observers)
    moves: dict[Var, Expr] = {
        variable(settle(var)): canon.share(settle(term)) for var, term in watched.system.next.items()
    }
    initial = {variable(settle(var)): value for var, value in watched.system.initial.items()}
    made = replace(
        watched.system,
        state=tuple(variable(settle(var)) for var in watched.system.state),
        next=moves,
        initial=initial,
        init=canon.share.bool(settle.bool(watched.system.init)),
        assume=canon.share.bool(watched.system.assume),
    )
    claims = [Claim("property", goal.prop.name, canon.share.bool(settle.bool(goal.good)), goal) for goal in goals]
    helpers = [Claim("helper", goal.prop.name, _helper(goal, settle, canon), goal) for goal in goals if goal.observers]
    facts = tuple(replace(one, good=canon.share.bool(one.good)) for one in facts)
    return Layer(made, (*claims, *facts, *helpers), hypotheses)


def _helper(goal: Goal, settle: Substitution, canon: Canon) -> Bool:
    return canon.share.bool(settle.bool(goal.helper & in_range(goal.observers)))


def layer_of(system: TransitionSystem, goals: list[Goal], canon: Canon) -> Layer:
    """Return a layer of these goals alone, without facts."""
    return _layer(system, goals, (), (), canon)


def variable(term: Expr) -> Var:
    """Return the term, which has to be a variable, with the type of a variable."""
    assert isinstance(term, Var)
    return term


def _exclusions(machine: Machine, canon: Canon) -> Iterator[tuple[str, Bool]]:
    """Return for each two rows of equal rank with a common source mode the claim that they are never enabled together."""
    for first, second in combinations(machine.transitions, 2):
        if first.rank == second.rank and set(first.sources) & set(second.sources):
            one, other = (machine.mode.one_of(*row.sources) & row.when for row in (first, second))
            yield f"{first.name!r} and {second.name!r}", canon.share.bool(~(one & other))
