"""The clauses of a system's worlds by name, and the same system without the assumption of some of them."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass, replace

from safeloc.language.expr import Bool, all_of
from safeloc.language.system import Part, TransitionSystem
from safeloc.language.world import Law


@dataclass(frozen=True, order=True)
class ClauseId:
    """A named clause of a machine's world."""

    machine: str
    name: str

    def __str__(self) -> str:
        return f"{self.machine}: {self.name}"


def assumed_clauses(system: TransitionSystem) -> dict[ClauseId, Bool]:
    """Return the clauses that the system assumes in every step, over its state before the step and inputs.

    Clauses that earlier machines of a composition guarantee are proved, and are not among them.
    """
    if system.parts:
        return {ClauseId(part.name, name): term for part in system.parts for name, term in part.assumed.items()}
    return {ClauseId(one.name, name): term for one in system.machines for name, term in one.world.terms.items()}


def laws(system: TransitionSystem) -> dict[ClauseId, Law]:
    """Return every assumed clause as declared, with its statement and owner."""
    by_machine = {one.name: one.world.laws for one in system.machines}
    return {one: by_machine[one.machine][one.name] for one in assumed_clauses(system)}


def without(system: TransitionSystem, broken: Collection[ClauseId]) -> TransitionSystem:
    """Return the system without the assumption of these clauses; KeyError for a clause that it does not assume."""
    clauses = assumed_clauses(system)
    if unknown := set(broken) - set(clauses):
        raise KeyError(f"{system.name} assumes no clause {min(unknown)}; it assumes {', '.join(map(str, clauses))}.")
    kept = [term for one, term in clauses.items() if one not in broken]
    return replace(system, assume=all_of(kept), parts=tuple(_part_without(part, broken) for part in system.parts))


def _part_without(part: Part, broken: Collection[ClauseId]) -> Part:
    """Return the part with its machine by itself not relying on these clauses either."""
    gone = {one.name for one in broken if one.machine == part.name}
    if not gone:
        return part
    left = [term for name, term in part.machine.world.terms.items() if name not in gone]
    clauses = {name: term for name, term in part.clauses.items() if name not in gone}
    return replace(part, alone=replace(part.alone, assume=all_of(left)), clauses=clauses)
