"""A small machine whose tubes have known answers, and how a tube around a stream of it is asked."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

from safeloc.language.expr import TRUE, as_num, ite, maximum, minimum, number, optional
from safeloc.language.interpret import read_inputs
from safeloc.language.machine import Machine, Transition, modes
from safeloc.language.nodes import Value
from safeloc.language.system import TransitionSystem, lower, without_ghosts
from safeloc.language.units import COUNT, MM
from safeloc.language.world import Law, World
from safeloc.proof.around.claims import written_claim
from safeloc.proof.around.deviations import deviations
from safeloc.proof.around.proving import Around
from safeloc.proof.around.tube import Given
from safeloc.proof.around.windows import Observe
from safeloc.proof.provers.limits import Limits
from safeloc.proof.results import Finding

LINE_MM = 100_000
STEP = number("distance_mm", MM, -100, 100)
FIX = optional("fix_mm", MM, 0, 1000)
PLACE, AGE = number("place_mm", MM, -LINE_MM, LINE_MM), number("age_cycles", COUNT, 0, 1000)
TRUTH, TRUE_STEP = number("truth_mm", MM, -LINE_MM, LINE_MM), number("true_cycle_distance_mm", MM, -200, 200)
(RUNNING,) = TABLE = modes("RUNNING")


def machine() -> Machine:
    """Sums steps, and counts cycles since a fix; in the world a step is wrong by at most 5 mm, and no step is above 50 mm."""
    moved = minimum(maximum(PLACE + STEP, -LINE_MM), LINE_MM)
    aged = ite(FIX.present, as_num(0, COUNT), minimum(AGE + 1, 1000))
    error = TRUE_STEP - STEP
    return Machine(
        "integrator",
        TABLE,
        [STEP, FIX],
        {PLACE: 0, AGE: 0},
        {"out_mm": PLACE},
        [Transition("go", RUNNING, RUNNING, TRUE, {PLACE: moved, AGE: aged})],
        World(
            {TRUTH: 0},
            [TRUE_STEP],
            {TRUTH: minimum(maximum(TRUTH + TRUE_STEP, -LINE_MM), LINE_MM)},
            {
                "the step is measured": Law((error <= 5) & (error >= -5)),
                "the vehicle is slow": Law(TRUE_STEP <= 50),
            },
        ),
    )


def steady(cycles: int, distance_mm: int = 10, every: int = 5) -> list[dict[str, int]]:
    """Equal steps, with a fix in every so-manieth cycle."""
    return [
        {"distance_mm": distance_mm, **({"fix_mm": cycle} if cycle % every == 0 else {})}
        for cycle in range(1, cycles + 1)
    ]


def given(system: TransitionSystem, stream: Sequence[Mapping[str, Value]]) -> Given:
    """The stream without truth."""
    board = without_ghosts(system)
    return Given([read_inputs(board, row) for row in stream])


def around(
    stream: Sequence[Mapping[str, Value]],
    *claims: str,
    within: Mapping[str, int] | None = None,
    drop: Mapping[str, int] | None = None,
    delay: Mapping[str, int] | None = None,
    first: int = 1,
    last: int | None = None,
    system: TransitionSystem | None = None,
    watched: Observe | None = None,
    seconds_in_all: float = math.inf,
) -> list[Finding]:
    """What is found of claims around a stream of the integrator."""
    whole = lower(machine()) if system is None else system
    near = deviations(whole, within or {}, drop or {}, delay or {})
    asked = [written_claim(whole, claim, first, last) for claim in claims]
    around_ = Around(
        whole.name,
        whole,
        "steady",
        given(whole, stream),
        near,
        asked,
        Limits(),
        watched=watched,
        seconds_in_all=seconds_in_all,
    )
    return around_.findings()
