"""The part of its world that the proof of a claim uses. A change outside this part leaves the proof valid, so the claim
is not proved again.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import asdict, dataclass
from typing import Any

from safeloc.assurance.margins.moved_world import MovedWorld
from safeloc.language.expr import Bool
from safeloc.language.spec import Property
from safeloc.language.system import TransitionSystem
from safeloc.language.terms import conjuncts, variables
from safeloc.proof.cores.clauses import ClauseId
from safeloc.proof.cores.cores import of_the_world
from safeloc.proof.cores.elements import Asked
from safeloc.proof.provers.limits import Limits


@dataclass(frozen=True)
class RestsOn:
    """The part of the world that a proof of a claim uses.

    clauses, moves  the clauses, and the ghosts whose moves it uses, by name
    reads           the variables of the terms that it uses: the range of another variable has no part in it
    """

    clauses: frozenset[ClauseId]
    moves: frozenset[str]
    reads: frozenset[str]

    def is_moved_by(self, world: MovedWorld) -> bool:
        """Return whether something that the proof uses is another in this world."""
        changed = self.clauses.isdisjoint(world.clauses) and self.moves.isdisjoint(world.moves)
        return not changed or not self.reads.isdisjoint(var.name for var in world.ranges)


def rests_on(system: TransitionSystem, prop: Property, limits: Limits) -> RestsOn | None:
    """Return what a claim on a single machine rests on; None if it is not known, as for a composition."""
    if system.parts:
        return None
    used = of_the_world(system, prop, limits)
    if used is None:
        return None
    names = {kind: frozenset(one.name for one in used.steps if one.kind == kind) for kind in ("clause", "move")}
    reads = frozenset(var.name for var in variables(_terms(used)))
    return RestsOn(frozenset(ClauseId(system.name, name) for name in names["clause"]), names["move"], reads)


def _terms(used: Asked) -> Iterator[Bool]:
    """Yield all terms of the proof; of the first state those that tie variables to each other.

    A condition of the first state on one variable alone, which no other term reads, has no part in the proof.
    """
    goal = used.goal
    yield from (goal.good, goal.helper, goal.prop.further_assumption)
    yield from used.steps.values()
    yield from used.states.values()
    yield from (part for part in conjuncts(goal.system.init) if len(variables([part])) > 1)


def to_data(found: RestsOn | None) -> Any:
    """Return it as plain data."""
    if found is None:
        return "unknown"
    clauses = [asdict(one) for one in sorted(found.clauses)]
    return {"clauses": clauses, "moves": sorted(found.moves), "reads": sorted(found.reads)}


def from_data(data: Any) -> RestsOn | None:
    """Return it from its plain data."""
    if not isinstance(data, Mapping):
        return None
    clauses = frozenset(ClauseId(**one) for one in data["clauses"])
    return RestsOn(clauses, frozenset(data["moves"]), frozenset(data["reads"]))
