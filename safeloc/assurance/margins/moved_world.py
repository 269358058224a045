"""A target in a world whose figures have moved, while the machine keeps the figures that it was configured with."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

from safeloc.assurance.margins.figures import Refused
from safeloc.assurance.mutation.declared import claimed
from safeloc.language.expr import Bool, BoolVar, Expr, NumVar, Var, all_of, before_step
from safeloc.language.spec import Property
from safeloc.language.system import Part, TransitionSystem
from safeloc.language.terms import Sharing, Substitution, variables
from safeloc.proof.cores.clauses import ClauseId, assumed_clauses


@dataclass(frozen=True, eq=False)
class MovedWorld:
    """A system in another world.

    clauses  the clauses that differ from those of the original
    moves    names of ghosts that move by another term
    ranges   variables of the world that have another range, each with the variable that stands in its place
    """

    system: TransitionSystem
    clauses: tuple[ClauseId, ...]
    moves: tuple[str, ...]
    ranges: Mapping[Var, Var]

    @property
    def differs(self) -> bool:
        """True if the world is not the original one."""
        return bool(self.clauses or self.moves or self.ranges)

    @property
    def ranges_are_within(self) -> bool:
        """True if no variable has a value in its range that was not in its range before."""
        return all(_within(mine, theirs) for mine, theirs in self.ranges.items())

    def before(self, term: Bool) -> Bool:
        """Return a term of the original over the variables of this world."""
        return Substitution(self.ranges).bool(term)

    def claim(self, prop: Property) -> Property:
        """Return a claim of the original over the variables of this world."""
        if not self.ranges:
            return prop
        earlier = {
            var: before_step(self.ranges[var.before])
            for var in _variables_of(prop)
            if var.before is not None and var.before in self.ranges
        }
        return claimed(prop, Substitution({**self.ranges, **earlier}))


def in_world_of(base: TransitionSystem, other: TransitionSystem) -> MovedWorld:
    """Return `base` with the clauses and the moves of ghosts that `other` has.

    Both have the same variables by name; a variable of the world has the range that the other gives it. Refused if the other
    has other variables or clauses: the figure is then one of the form of the world, and cannot move alone.
    """
    mine, theirs = _by_name(base), _by_name(other)
    if set(mine) != set(theirs) or set(assumed_clauses(base)) != set(assumed_clauses(other)):
        raise Refused("another value gives the world other variables or clauses")
    ranges = {var: theirs[var.name] for var in base.ghosts if not _alike(var, theirs[var.name])}
    if ranges and base.parts:
        names = ", ".join(var.name for var in ranges)
        raise Refused(
            f"another value gives another range to {names} of the world; move the figure on its machine alone"
        )
    base = _over(base, Substitution(ranges), ranges)
    mine = _by_name(base)
    read = Substitution({theirs[name]: var for name, var in mine.items() if theirs[name] is not var})
    clauses = {one: read.bool(term) for one, term in assumed_clauses(other).items()}
    moves = {mine[var.name]: read(other.next[theirs[var.name]]) for var in base.ghosts if var in base.next}
    return _placed(base, clauses, moves, other, ranges)


def _placed(
    base: TransitionSystem,
    clauses: Mapping[ClauseId, Bool],
    moves: Mapping[Var, Expr],
    other: TransitionSystem,
    ranges: Mapping[Var, Var],
) -> MovedWorld:
    share = Sharing()
    original = _clauses_over(base, ranges)
    changed = tuple(one for one, term in clauses.items() if share(term) is not share(original[one]))
    moving = tuple(var.name for var, term in moves.items() if share(term) is not share(base.next[var]))
    others = {part.name: part for part in other.parts}
    parts = tuple(_part(part, others[part.name], clauses) for part in base.parts)
    system = replace(base, assume=all_of(clauses.values()), next={**base.next, **moves}, parts=parts)
    return MovedWorld(system, changed, moving, ranges)


def _part(part: Part, other: Part, clauses: Mapping[ClauseId, Bool]) -> Part:
    """Return a part whose machine by itself stands in the moved world; what other machines guarantee it stays as it is."""
    mine = {name: clauses.get(ClauseId(part.name, name), term) for name, term in part.clauses.items()}
    alone = _in_world_of_alone(part.alone, other.alone, part.guaranteed)
    return replace(part, clauses=mine, alone=alone)


def _in_world_of_alone(
    alone: TransitionSystem, other: TransitionSystem, guaranteed: tuple[str, ...]
) -> TransitionSystem:
    """Return a machine of a composition by itself, in the other's world; the guaranteed clauses stay its own."""
    terms, theirs = alone.machines[0].world.terms, other.machines[0].world.terms
    names = {var.name: var for var in (*alone.state, *alone.inputs)}
    read = Substitution({var: names[var.name] for var in (*other.state, *other.inputs) if names[var.name] is not var})
    clauses = [terms[name] if name in guaranteed else read.bool(theirs[name]) for name in terms]
    by_name = {var.name: var for var in other.state}
    moves = {var: read(other.next[by_name[var.name]]) for var in alone.ghosts if var in alone.next}
    return replace(alone, assume=all_of(clauses), next={**alone.next, **moves})


def _by_name(system: TransitionSystem) -> dict[str, Var]:
    return {var.name: var for var in (*system.state, *system.inputs)}


def _alike(var: Var, other: Var) -> bool:
    """Return whether two variables of one name have the same unit and range."""
    if isinstance(var, NumVar) and isinstance(other, NumVar):
        return (var.unit, var.low, var.high) == (other.unit, other.low, other.high)
    return type(var) is type(other)


def _within(var: Var, other: Var) -> bool:
    """Return whether the range of a variable has each value of the other's."""
    return not isinstance(var, NumVar) or (isinstance(other, NumVar) and var.low <= other.low <= other.high <= var.high)


def _over(system: TransitionSystem, change: Substitution, ranges: Mapping[Var, Var]) -> TransitionSystem:
    """Return a system with other variables in place of some; its machines, as declared, keep theirs."""
    if not ranges:
        return system
    placed = {var: ranges.get(var, var) for var in (*system.state, *system.inputs)}
    return replace(
        system,
        state=tuple(placed[var] for var in system.state),
        inputs=tuple(placed[var] for var in system.inputs),
        init=change.bool(system.init),
        next={placed[var]: change(term) for var, term in system.next.items()},
        assume=change.bool(system.assume),
        outputs={name: change(term) for name, term in system.outputs.items()},
        fired={var: change.num(term) for var, term in system.fired.items()},
        lemmas={name: change.bool(term) for name, term in system.lemmas.items()},
        ghosts=frozenset(placed[var] for var in system.ghosts),
        initial={placed[var]: value for var, value in system.initial.items()},
    )


def _clauses_over(base: TransitionSystem, ranges: Mapping[Var, Var]) -> dict[ClauseId, Bool]:
    change = Substitution(ranges)
    return {one: change.bool(term) for one, term in assumed_clauses(base).items()}


def _variables_of(prop: Property) -> list[NumVar | BoolVar]:
    terms = variables([prop.term, prop.response, prop.further_assumption])
    return [var for var in terms if isinstance(var, NumVar | BoolVar)]
