"""What a machine is held against: its properties, its lemmas, the ranges of its variables, and that rows exclude each other.

Claims are put into layers by what they rely on: nothing at all, the assumption, or a further assumption besides. Each layer is one
system with the observers of its properties.
"""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping
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

_ClaimKind = Literal["property", "lemma", "range", "rows exclude each other", "helper"]


@dataclass(frozen=True, eq=False)
class Claim:
    """One claim: `good` holds in every state of a layer's system. `goal` where it is a property."""

    kind: _ClaimKind
    name: str
    good: Bool
    goal: Goal | None = None

    def __str__(self) -> str:
        return f"{self.kind} {self.name}"


@dataclass(frozen=True, eq=False)
class Layer:
    """Claims with the same assumption: `system` has their observers, and this assumption.

    given  what is known besides, of the layer before
    """

    system: TransitionSystem
    claims: tuple[Claim, ...]
    given: tuple[Claim, ...]


class Canon:
    """One node for equal terms and one variable for each observer, over all mutants of a declaration.

    So what did not change is seen to be the same, and `asked` translates it once.
    """

    def __init__(self) -> None:
        self.share = Sharing()
        self.asked = Standing()
        self._known: dict[tuple[object, ...], Var] = {}

    def observers(self, made: tuple[Var, ...]) -> Substitution:
        """Rewrites observers into those of the same names that came first."""
        return Substitution({var: self._known.setdefault(_alike(var), var) for var in made})

    def twin(self, var: Var) -> Var:
        """The variable of a second copy."""
        twin = replace(var, name=f"mutant.{var.name}")
        return self._known.setdefault(_alike(twin), twin)


def _alike(var: Var) -> tuple[object, ...]:
    """Return the features of an observer that distinguish it: name and kind, and for a number its range."""
    return (var.name, var.low, var.high) if isinstance(var, NumVar) else (var.name,)


@dataclass(frozen=True, eq=False)
class Held:
    """A declaration with all its claims: `system` is the machine in its world, without observers."""

    declared: Declared
    system: TransitionSystem
    layers: tuple[Layer, ...]
    exclusions: Mapping[str, Bool]


def held(declared: Declared, canon: Canon, under_assumption: Collection[str] = ()) -> Held:
    """Return all claims of a declaration; ModelError or PropertyError if it is not valid.

    under_assumption  lemmas that speak of no ghost, and hold under the assumption only
    """
    system = _settled(declared.lowered(), canon)
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


def _settled(system: TransitionSystem, canon: Canon) -> TransitionSystem:
    """The system in the nodes of all others."""
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
    """Return ranges of variables and lemmas: those for all inputs, and those under the assumption."""
    facts: tuple[list[Claim], list[Claim]] = [], []
    for var in system.state:
        if isinstance(var, NumVar):
            facts[var in system.ghosts].append(Claim("range", var.name, in_range([var])))
    for name, term in system.lemmas.items():
        bound = name in under_assumption or not system.ghosts.isdisjoint(variables([term]))
        facts[bound].append(Claim("lemma", name, term))
    return tuple(facts[0]), tuple(facts[1])


def _layer(
    system: TransitionSystem, goals: list[Goal], facts: tuple[Claim, ...], given: tuple[Claim, ...], canon: Canon
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
    return Layer(made, (*claims, *facts, *helpers), given)


def _helper(goal: Goal, settle: Substitution, canon: Canon) -> Bool:
    return canon.share.bool(settle.bool(goal.helper & in_range(goal.observers)))


def layer_of(system: TransitionSystem, goals: list[Goal], canon: Canon) -> Layer:
    """Return these goals as one layer, without further claims or known facts."""
    return _layer(system, goals, (), (), canon)


def variable(term: Expr) -> Var:
    """Return a term that is a variable, as a variable."""
    assert isinstance(term, Var)
    return term


def _exclusions(machine: Machine, canon: Canon) -> Iterator[tuple[str, Bool]]:
    """Return the claims that two rows of equal rank that leave a common mode are never enabled together."""
    for first, second in combinations(machine.transitions, 2):
        if first.rank == second.rank and set(first.sources) & set(second.sources):
            one, other = (machine.mode.one_of(*row.sources) & row.when for row in (first, second))
            yield f"{first.name!r} and {second.name!r}", canon.share.bool(~(one & other))
