"""Runs of the machine as it is go the way that the interpreter goes, in whatever order the world says how its ghosts move."""

from __future__ import annotations

from safeloc.assurance.mutation.claims import Canon, held
from safeloc.assurance.mutation.corpus import Run
from safeloc.assurance.mutation.declared import Declared
from safeloc.assurance.mutation.playing import WORLD, trodden
from safeloc.language.expr import Bool, Num, NumVar, boolean, number
from safeloc.language.interpret import start, step
from safeloc.language.machine import Machine, Transition, modes
from safeloc.language.nodes import BoolVar
from safeloc.language.units import COUNT
from safeloc.language.world import World

FAR, NEAR, NEXT = number("far", COUNT, 0, 90), number("near", COUNT, 0, 90), boolean("next")


def _machine(*, turned: bool) -> Machine:
    waits, works = table = modes("WAITS", "WORKS")
    moves: dict[NumVar | BoolVar, Num | Bool] = {FAR: NEAR + 1, NEAR: FAR + 2}
    told = dict(reversed(moves.items())) if turned else moves
    rows = [Transition("works", waits, works, NEXT), Transition("waits", works, waits, ~NEXT)]
    return Machine(
        name="pair", modes=table, inputs=[NEXT], state={}, outputs={}, transitions=rows,
        world=World({FAR: 10, NEAR: 20}, [], told, {"both are near": (FAR < 80) & (NEAR < 80)}),
    )  # fmt: skip


def test_the_order_of_moves() -> None:
    """State after state the interpreter's, also where the moves stand in another order than the ghosts."""
    run = Run("there and back", {}, ((True,), (False,), (False,), (True,)))
    for turned in (False, True):
        whole = held(Declared(_machine(turned=turned), ()), Canon())
        [path] = trodden(whole, [run]).layers[WORLD]
        system = whole.layers[WORLD].system
        state = start(system, {})
        for inputs, found in zip((None, *run.rows), path.states, strict=True):
            if inputs is not None:
                state, _ = step(system, state, dict(zip(system.inputs, inputs, strict=True)))
            assert tuple(state[var] for var in system.state) == found
