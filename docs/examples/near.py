"""A sum of measured steps, to be proved around one of its journeys (docs/around.md)."""

from safeloc.language.expr import TRUE, as_num, ite, maximum, minimum, number, optional
from safeloc.language.machine import Machine, Transition, modes
from safeloc.language.units import COUNT, MM
from safeloc.language.world import Law, World

LINE_MM = 100_000
step, fix = number("distance_mm", MM, -100, 100), optional("fix_mm", MM, 0, 1_000)
place, age = number("place_mm", MM, -LINE_MM, LINE_MM), number("age_cycles", COUNT, 0, 1_000)
truth, true_cycle_distance = number("truth_mm", MM, -LINE_MM, LINE_MM), number("true_cycle_distance_mm", MM, -200, 200)
(RUNNING,) = table = modes("RUNNING")

machine = Machine(
    name="near",
    modes=table,
    inputs=[step, fix],
    state={place: 0, age: 0},
    outputs={"out_mm": place},
    transitions=[
        Transition(
            "go",
            RUNNING,
            RUNNING,
            TRUE,
            {
                place: minimum(maximum(place + step, -LINE_MM), LINE_MM),
                age: ite(fix.present, as_num(0, COUNT), minimum(age + 1, 1_000)),
            },
        )
    ],
    world=World(
        ghosts={truth: 0},
        choices=[true_cycle_distance],
        moves={truth: minimum(maximum(truth + true_cycle_distance, -LINE_MM), LINE_MM)},
        clauses={
            "the step is measured": Law((true_cycle_distance - step <= 5) & (true_cycle_distance - step >= -5)),
            "the vehicle is slow": Law(true_cycle_distance <= 50),
        },
    ),
)


def simulate(seed: int) -> list[dict[str, int]]:
    """Fifty steps of 10 mm, with a fix in every fifth; with another seed than 0 the eighth step is 70 mm."""
    steps = [
        {"distance_mm": 10, "true_cycle_distance_mm": 10, **({"fix_mm": cycle} if cycle % 5 == 0 else {})}
        for cycle in range(1, 51)
    ]
    if seed:
        steps[7] |= {"distance_mm": 70, "true_cycle_distance_mm": 70}
    return steps
