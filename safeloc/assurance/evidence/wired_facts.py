"""Facts of a composition that its wires make true: a ghost that moves to where another one moves is equal to it after every step.

A law that only says so again is needed by the machine by itself, but not by the composition. Its effect there is decided with these
facts, as further lemmas. They are proved like any lemma, and dropped if they do not hold.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

from safeloc.language.expr import Bool, NumVar, Var
from safeloc.language.nodes import BoolVar
from safeloc.language.system import TransitionSystem


def with_wired_facts(system: TransitionSystem) -> TransitionSystem:
    """Return the system with a lemma for each two ghosts of different machines that move to the same value in every step."""
    found = (
        {f"by wires: {one.name} is {other.name}": term for one, other, term in _facts(system)} if system.parts else {}
    )
    return replace(system, lemmas={**system.lemmas, **found}) if found else system


def _facts(system: TransitionSystem) -> Iterator[tuple[Var, Var, Bool]]:
    """Yield ghosts that move alike, with their equality once the later one's machine has left its first mode.

    In the first state they may differ; a machine that has left its first mode has made a step.
    """
    by_move = dict[int, Var]()
    for ghost in system.state:
        if ghost in system.ghosts:
            earlier = by_move.setdefault(id(system.next[ghost]), ghost)
            if earlier is not ghost and _owner(earlier) != _owner(ghost):
                yield ghost, earlier, _has_left(system, _owner(ghost)).implies(_equal(ghost, earlier))


def _owner(var: Var) -> str:
    return var.name.partition(".")[0]


def _has_left(system: TransitionSystem, owner: str) -> Bool:
    machine = next(one for one in system.machines if one.name == owner)
    mode = next(var for var in system.state if var.name == f"{owner}.mode")
    assert isinstance(mode, NumVar)
    return mode.ne(machine.modes[0])


def _equal(one: Var, other: Var) -> Bool:
    if isinstance(one, NumVar) and isinstance(other, NumVar):
        return one.eq(other)
    assert isinstance(one, BoolVar) and isinstance(other, BoolVar)
    return one.iff(other)
