"""Clauses that exclude each other are named, none of which could be left out, with the length of which there is no run."""

from __future__ import annotations

import pytest

from safeloc.language.composition import compose
from safeloc.language.expr import FALSE, Bool, number
from safeloc.language.machine import Machine, Transition, modes
from safeloc.language.system import TransitionSystem, lower
from safeloc.language.units import COUNT
from safeloc.language.world import World
from safeloc.proof.provers.contradiction import NO_RUN, excluding, no_run
from safeloc.proof.provers.limits import deadline

(ONLY,) = modes("ONLY")
X, Y, DRIVEN = number("x", COUNT, 0, 9), number("y", COUNT, 0, 9), number("driven", COUNT, 0, 99)


def system(clauses: dict[str, Bool], initially: Bool | None = None) -> TransitionSystem:
    """A machine whose world counts what x adds up to."""
    world = World(ghosts={DRIVEN: 0}, moves={DRIVEN: DRIVEN + X}, clauses=clauses)
    first = {} if initially is None else {"initially": initially}
    return lower(
        Machine("adding", (ONLY,), [X, Y], {}, {}, [Transition("go", ONLY, ONLY, X > 3)], world=world, **first)
    )


@pytest.mark.parametrize(
    ("clauses", "says"),
    [
        (
            {"small": X < 3, "any": Y < 8, "great": X > 5},
            "exclude each other in the first step: 'adding: small', 'adding: great'",
        ),
        (
            {"any": Y < 8, "never": X > Y + 9},
            "The clause 'adding: never' excludes every run by itself, in the first step",
        ),
        (
            {"moving": X > 3, "any": Y < 8, "near": DRIVEN < 10},
            "exclude each other within 4 steps: 'adding: moving', 'adding: near'",
        ),
        (
            {"below": X < Y, "least": X > 4, "most": Y < 6, "more": Y < 7},
            "'adding: below', 'adding: least', 'adding: most'",
        ),
    ],
)
def test_the_clauses_that_exclude_each_other_are_named(clauses: dict[str, Bool], says: str) -> None:
    """Others are not, and the shortest length without a run is told."""
    told = no_run(system(clauses), 5, deadline(10))
    assert told.startswith(f"{NO_RUN}. ")
    assert told.endswith(says)


def test_of_a_composition_the_machines_are_named() -> None:
    """Two machines may ask the impossible of an input that both read."""
    low, high = (
        Machine(name, (ONLY,), [X], {}, {}, [Transition("go", ONLY, ONLY, X > 3)], world=World(clauses={"law": law}))
        for name, law in (("low", X < 3), ("high", X > 5))
    )
    composed = compose("both", [low, high], {}, shared=[X]).system
    assert no_run(composed, 5, deadline(10)).endswith("in the first step: 'low: law', 'high: law'")


def test_without_a_clause_that_excludes_it() -> None:
    """A run that exists has nothing to name; neither has a solver without time, and a first state that cannot be."""
    lawful = system({"small": X < 3})
    assert excluding(lawful, 5, deadline(10)) is None
    assert NO_RUN == no_run(lawful, 5, deadline(10)) == no_run(system({"small": X < 3, "great": X > 5}), 5, deadline(0))
    nowhere = no_run(system({"small": X < 3}, (DRIVEN > 5) & FALSE), 5, deadline(10))
    assert nowhere.endswith("The first state and the ranges have no run, whatever the clauses (in the first step)")
