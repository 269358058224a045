"""Observable consequences of a world's laws: conditions that can be checked in operation without knowing the truth.

    seen(system).stated       every clause of every machine, with wires substituted
    seen(system).observables  the conditions that follow from the clauses and read no hidden variable

An observer knows inputs and on-board state. It can also compute some ghosts, because they start at a known value and move
only by inputs, on-board state and each other: "the last distance that was delivered", "a train is in the area". These are
the observer's memory. All other ghosts are hidden.

A clause is observable as a whole if it reads no hidden variable, and in part if some of its conjuncts read none. Two clauses
are observable together if both bound the same hidden quantity: two sources whose intervals exclude each other cannot both
contain the truth. If an observable condition is violated, at least one of its clauses certainly is. The reverse does not
hold: a clause may be violated although all its observable conditions hold.
"""

from __future__ import annotations

import weakref
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import combinations

from safeloc.language.expr import Bool, Expr, Lit, Var, all_of
from safeloc.language.first_values import ANY
from safeloc.language.hidden_bounds import Divided, Hidden, all_compatible, compatible, divided
from safeloc.language.machine import Machine
from safeloc.language.nodes import Value
from safeloc.language.running_sums import Running, running, steady
from safeloc.language.system import TransitionSystem
from safeloc.language.terms import Sharing, Substitution, variables
from safeloc.language.world import Law


@dataclass(frozen=True, eq=False)
class Stated:
    """A clause of a machine's world, written over the variables of the system.

    term        over state before the step, inputs, and the variables of `Seen.after` for state after the step
    guaranteed  earlier machines of the composition guarantee the clause, and this is proved
    """

    machine: Machine
    name: str
    term: Bool
    guaranteed: bool = False

    @property
    def law(self) -> Law:
        """The clause as it was declared."""
        return self.machine.world.laws[self.name]

    def __str__(self) -> str:
        return f"{self.machine.name}: {self.name}"


@dataclass(frozen=True, eq=False)
class Observable:
    """A condition that follows from one clause, or from two together, and that reads no hidden variable.

    is_equivalent  the condition is equivalent to its clause
    """

    clauses: tuple[Stated, ...]
    term: Bool
    is_equivalent: bool = False

    def __str__(self) -> str:
        return " / ".join(map(str, self.clauses))


@dataclass(frozen=True, eq=False)
class Seen:
    """A system from the point of view of an observer on board.

    at_once  one short condition: while it holds, no observable condition that reads no memory is violated
    recalled the conjunction of the observable conditions that read the memory
    hidden   the ghosts that nobody on board can know
    after    variable that represents a state variable after the step -> that state variable
    memory   ghosts and running sums that the observer computes and that observable conditions read -> next value
    first    the first values of the memory
    """

    stated: tuple[Stated, ...]
    observables: tuple[Observable, ...]
    at_once: Bool
    recalled: Bool
    hidden: Hidden
    after: Mapping[Var, Var]
    memory: Mapping[Var, Expr]
    first: Mapping[Var, Value]

    def of(self, clause: Stated) -> list[Observable]:
        """Return the observable conditions of a clause, alone and together with other clauses."""
        return [one for one in self.observables if clause in one.clauses]

    def recalls(self, one: Observable) -> bool:
        """Return whether the condition reads the observer's memory."""
        return not self.memory.keys().isdisjoint(variables([one.term]))


_SEEN: weakref.WeakKeyDictionary[TransitionSystem, Seen] = weakref.WeakKeyDictionary()


def seen(system: TransitionSystem) -> Seen:
    """Return the view of an observer on board of a system with ghosts; computed once for each system."""
    if system not in _SEEN:
        _SEEN[system] = _seen(system)
    return _SEEN[system]


def _seen(system: TransitionSystem) -> Seen:
    computable = _computable_ghosts(system)
    hidden = system.ghosts - computable
    after = {replace(var, name=f"{var.name} after"): var for var in system.state if var not in system.ghosts}
    cut = Substitution({}, _ends(system, after))
    stated = tuple(replace(one, term=cut.bool(one.term)) for one in _stated(system))
    known = {one: divided(one.term, hidden) for one in stated}
    sums = dict(_running(known, system))
    observables = (*_alone(known), *_together(known), *sums)
    first: dict[Var, Value] = {var: _initial(system, var) for var in system.state if var in computable}
    moves: dict[Var, Expr] = {var: cut(system.next[var]) for var in first}
    for one in (one for found in sums.values() for one in found):
        first[one.total], moves[one.total] = 0, one.move
    memory = _memory([one.term for one in observables], moves)
    recalling = [one for one in observables if not memory.keys().isdisjoint(variables([one.term]))]
    at_once = _at_once([one for one in observables if one not in recalling], known, frozenset(memory))
    share = Sharing()  # so that parts common to conditions and memory are computed once
    return Seen(
        stated, observables, share.bool(at_once), share.bool(all_of(one.term for one in recalling)), hidden, after,
        {var: share(move) for var, move in memory.items()}, {var: first[var] for var in memory},
    )  # fmt: skip


def _stated(system: TransitionSystem) -> Iterator[Stated]:
    if not system.parts:
        for machine in system.machines:
            yield from (Stated(machine, name, term) for name, term in machine.world.terms.items())
    for part in system.parts:
        for name, term in part.clauses.items():
            yield Stated(part.machine, name, term, name in part.guaranteed)


def _ends(system: TransitionSystem, after: Mapping[Var, Var]) -> list[tuple[Expr, Expr]]:
    """Return next values with the variable that represents each: no bare variables or constants, of equal ones the first."""
    ends = [(system.next[var], stands) for stands, var in after.items()]
    return [(term, stands) for term, stands in reversed(ends) if not isinstance(term, Var) and variables([term])]


def _computable_ghosts(system: TransitionSystem) -> Hidden:
    """Return the ghosts that start at a known value and move only by inputs, on-board state, and each other."""
    found = {var for var in system.ghosts if var in system.next and system.initial[var] is not ANY}
    reads = {var: system.ghosts.intersection(variables([system.next[var]])) for var in found}
    while unknown := {var for var in found if not reads[var] <= found}:
        found -= unknown
    return frozenset(found)


def _initial(system: TransitionSystem, var: Var) -> Value:
    """Return the declared first value of a variable."""
    value = system.initial[var]
    assert isinstance(value, (int, Lit))
    return value.value if isinstance(value, Lit) else value


def _memory(terms: Iterable[Expr], moves: Mapping[Var, Expr]) -> dict[Var, Expr]:
    """Return the part of the memory that the terms read, directly or through the moves of other memory."""
    read, new = set[Var](), set(variables(terms))
    while new:
        read |= new
        new = set(variables(moves[var] for var in new if var in moves)) - read
    return {var: move for var, move in moves.items() if var in read}


def _alone(known: Mapping[Stated, Divided]) -> Iterator[Observable]:
    for one, part in known.items():
        if part.visible:
            yield Observable((one,), one.term if part.is_equivalent else all_of(part.visible), part.is_equivalent)


def _together(known: Mapping[Stated, Divided]) -> Iterator[Observable]:
    """Yield conditions of two clauses that bound the same sum; if pairs give equal conditions (two machines on one line), one."""
    bounding = [one for one, part in known.items() if part.bounds]
    share, met = Sharing(), set[Bool]()
    for one, other in combinations(bounding, 2):
        parts = compatible(known[one].bounds, known[other].bounds)
        term = share.bool(all_of(parts))
        if parts and term not in met:
            met.add(term)
            yield Observable((one, other), term)


def _running(known: Mapping[Stated, Divided], system: TransitionSystem) -> Iterator[tuple[Observable, list[Running]]]:
    """Yield conditions of two clauses that bound the same sum except for a wandering error: running sums compare them."""
    bounds = {one: [steady(bound, system.next) for bound in part.bounds] for one, part in known.items()}
    for one, other in combinations([one for one, found in bounds.items() if found], 2):
        found = list(running(bounds[one], bounds[other], (str(one), str(other))))
        if found:
            yield Observable((one, other), all_of(part.term for part in found)), found


def _at_once(observables: Sequence[Observable], known: Mapping[Stated, Divided], memory: frozenset[Var]) -> Bool:
    """Return a short condition that implies all of these; it may fail although none of them is violated."""
    alone = [one.term for one in observables if len(one.clauses) == 1]
    paired = dict.fromkeys(clause for one in observables if len(one.clauses) > 1 for clause in one.clauses)
    bounds = [bound for clause in paired for bound in known[clause].bounds if memory.isdisjoint(bound.reads)]
    return all_of([*alone, all_compatible(bounds)])
