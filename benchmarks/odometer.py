"""What every contender runs: the small odometer of the shared examples, and one seeded stream."""

from __future__ import annotations

import random

from safeloc.language.interpret import start, step
from safeloc.language.system import TransitionSystem, lower, without_ghosts
from tests.examples import LINE_MM, Odometer, build_odometer

TOLERANCE_MM = 30_000
REFERENCE_EVERY = 100
SEED = 20_250_101

Row = tuple[int, bool, int]
Last = tuple[int, int, int]


def odometer() -> Odometer:
    """The machine."""
    return build_odometer(TOLERANCE_MM)


def on_board() -> TransitionSystem:
    """The machine without its environment: movement, presence and value of a reference."""
    return without_ghosts(lower(odometer().machine))


def stream(steps: int) -> list[Row]:
    """Rows of (movement mm, a reference is present, reference mm); about one reference in a hundred steps."""
    draw = random.Random(SEED)
    rows: list[Row] = []
    for _ in range(steps):
        present = draw.randrange(REFERENCE_EVERY) == 0
        rows.append((draw.randint(-5000, 5000), present, draw.randint(0, LINE_MM) if present else 0))
    return rows


def expected(steps: int) -> Last:
    """Mode, position and margin after so many steps, as the interpreter has them: no contender may differ."""
    system = on_board()
    state = start(system)
    for row in stream(steps):
        state, _ = step(system, state, dict(zip(system.inputs, row, strict=True)))
    mode, position, margin = state.values()
    return mode, position, margin
