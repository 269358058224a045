"""A train's speed and who acts on it: a speedometer, and a supervisor that brakes. Two machines, composed into one.

    safeloc verify supervised.py:whole
    safeloc prove supervised.py:supervisor      one of them alone; `properties` gives the claims of either

The supervisor alone has to assume that the number it gets is an upper bound of the true speed. In the composition this is
not assumed: it is a contract that the speedometer fulfils, and `discharge` has it proved.
"""

from __future__ import annotations

from random import Random

from safeloc.language.composition import Composition, compose
from safeloc.language.declared import Declared
from safeloc.language.expr import before, boolean, minimum, number, optional
from safeloc.language.machine import ANY, Machine, Transition, current_mode, modes
from safeloc.language.spec import Property, always, never
from safeloc.language.units import MM_S
from safeloc.language.world import Law, World

# ------------------------------------------------------------------ figures
# Each has a name, and the name carries the unit.

FASTEST_MM_S = 60_000
"""The vehicle cannot run faster."""
MEASURED_WITHIN_MM_S = 400
"""The error law of the speed sensor: a constant."""
GAIN_MM_S = 300
"""The most that the speed grows in one cycle."""
LIMIT_MM_S, RELEASE_MM_S = 40_000, 38_000
"""Above the limit the train has to brake; the brake may be released at a speed that is certainly lower."""

# ------------------------------------------------------------------ the first machine: a speedometer
# It gives an upper bound of the speed in every cycle, also in one without a measurement: the bound grows then.

of_sensor = Declared()
measured = of_sensor.sensor(optional("measured_mm_s", MM_S, 0, FASTEST_MM_S))
bound = of_sensor.state(number("bound_mm_s", MM_S, 0, FASTEST_MM_S), first=FASTEST_MM_S)
# A ghost is so, but no device reads it. Here it is the true speed; ANY: it may have any value at first.
speed = of_sensor.ghost(number("speed_mm_s", MM_S, 0, FASTEST_MM_S), first=ANY)
next_speed = of_sensor.choice(number("next_speed_mm_s", MM_S, 0, FASTEST_MM_S))

FRESH, AGEING = sensor_modes = modes("FRESH", "AGEING")
speedometer = Machine(
    name="speedometer",
    doc="An upper bound of the speed: measured, or grown since the last measurement.",
    modes=sensor_modes,
    inputs=of_sensor.inputs,
    state=of_sensor.states,
    transitions=[
        Transition(
            "measure",
            sensor_modes,
            FRESH,
            measured.present,
            {bound: minimum(measured.value + MEASURED_WITHIN_MM_S, FASTEST_MM_S)},
            rank=0,
        ),
        Transition("age", sensor_modes, AGEING, set={bound: minimum(bound + GAIN_MM_S, FASTEST_MM_S)}, rank=1),
    ],
    outputs={"bound_mm_s": bound, "fresh": current_mode(sensor_modes).eq(FRESH)},
    # The clauses of the world are the assumption of every proof: what supplier and physics answer for.
    world=World(
        ghosts=of_sensor.ghosts,
        choices=of_sensor.choices,
        moves={speed: next_speed},
        clauses={
            "the sensor keeps its error law": Law(
                measured.present.implies(next_speed <= measured.value + MEASURED_WITHIN_MM_S),
                "The true speed is above a measured one by at most a constant.",
                source="[M] to be taken from the data sheet",
                owner="supplier",
            ),
            "the speed grows slowly": Law(
                next_speed <= speed + GAIN_MM_S,
                "In one cycle the speed grows by at most the gain.",
                source="[M] from the power of the drive",
                owner="operator",
            ),
        },
    ),
    # A lemma is proved, never assumed. This one is the contract: what the machine guarantees to those behind it.
    lemmas={"the bound is a bound": speed <= bound},
)

# ------------------------------------------------------------------ the second machine: a supervisor
# It knows no sensor: a number that bounds the speed, and a driver who asks for release.

of_supervisor = Declared()
speed_bound = of_supervisor.sensor(number("speed_bound_mm_s", MM_S, 0, FASTEST_MM_S))
released = of_supervisor.sensor(boolean("release_asked"))
speed_then = of_supervisor.choice(number("speed_then_mm_s", MM_S, 0, FASTEST_MM_S))

# The first mode is the one at the start. FREE would be wrong: at the start the train may run at any speed. Try it.
BRAKING, FREE = supervisor_modes = modes("BRAKING", "FREE")
may_release = released & (speed_bound <= RELEASE_MM_S)
supervisor = Machine(
    name="supervisor",
    doc="Brakes as long as the train may be faster than the limit, and until the driver asks for release.",
    modes=supervisor_modes,
    inputs=of_supervisor.inputs,
    state=of_supervisor.states,
    transitions=[
        Transition("brake", FREE, BRAKING, speed_bound > LIMIT_MM_S),
        Transition("release", BRAKING, FREE, may_release),
    ],
    outputs={"brake": current_mode(supervisor_modes).eq(BRAKING)},
    world=World(
        choices=of_supervisor.choices,
        clauses={
            "the bound holds": Law(
                speed_then <= speed_bound, "The bound is not below the true speed.", owner="supplier", source="contract"
            )
        },
    ),
)

# ------------------------------------------------------------------ both together
# They take one step together, in this order. A wire gives an input of a later machine the value that an earlier one
# computed in the same step. `discharge`: what the supervisor assumes is proved from the machines before it.

whole: Composition = compose(
    "supervised_speed",
    [speedometer, supervisor],
    wires={speed_bound: speedometer.output("bound_mm_s"), speed_then: speed},
    discharge=[supervisor],
)

# ------------------------------------------------------------------ claims
# In figures of their own, written from the requirement, and in both directions: when it must brake, when it must not.

braking = supervisor.mode.eq(BRAKING)
was_braking = before(supervisor.mode).eq(BRAKING)
of_the_supervisor = [
    always(
        "brakes when too fast",
        (speed_then > 40_000).implies(braking),
        statement="In every cycle at the end of which the train is faster than 144 km/h the brake is on.",
    ),
    never(
        "released while it may be fast",
        was_braking & ~braking & (speed_then > 38_000),
        statement="The brake is not released above 136.8 km/h.",
    ),
    always(
        "no brake without need",
        (~was_braking & (speed_bound <= 40_000)).implies(~braking),
        statement="The brake does not come on as long as the bound is not above the limit.",
    ),
]
of_the_speedometer = [always("bounded", speed <= bound, statement="The bound is not below the true speed.")]


def properties(of: Machine | Composition) -> list[Property]:
    """Return the claims of what is verified: of one machine alone, or of the composition.

    A property that a machine has alone holds in the composition as well: `inherited` states it there, and the proof is the
    machine's own.
    """
    if of is supervisor:
        return of_the_supervisor
    if of is speedometer:
        return of_the_speedometer
    # A claim of both: `of` rewrites the terms of one machine as terms of the composition.
    too_fast, brakes = whole.of(speedometer).bool(speed > 40_000), whole.of(supervisor).bool(braking)
    return [
        always(
            "too fast, so it brakes", too_fast.implies(brakes), statement="No train above 144 km/h runs without brake."
        ),
        *(whole.inherited(supervisor, one) for one in of_the_supervisor),
        *(whole.inherited(speedometer, one) for one in of_the_speedometer),
    ]


# ------------------------------------------------------------------ recordings and simulation


def recordings(of: Machine | Composition) -> list[str]:
    """Return the recorded runs, by their paths from this file: `safeloc verify` replays them and checks every property on each."""
    return ["recordings/run.jsonl"] if of is whole else []


def simulate(seed: int) -> list[dict[str, int | bool]]:
    """Return a simulated run, a mapping per cycle, for `safeloc simulate supervised.py:whole --out recordings/run.jsonl`.

    The train speeds up until the brake comes on, slows down, is released, and runs below the limit while the sensor is
    silent; then the bound grows over the limit, and the train brakes again. Variables are named "machine.variable".
    """
    draw, true, steps = Random(seed), 0, list[dict[str, int | bool]]()
    for cycle in range(600):
        slows = 150 <= cycle < 250 or cycle >= 450
        true = max(0, true - 200) if slows else min(true + 280, 41_000 if cycle < 150 else 38_500)
        step: dict[str, int | bool] = {
            "speedometer.next_speed_mm_s": true,
            "supervisor.release_asked": cycle % 100 == 99,
        }
        if not 400 <= cycle < 440:
            step["speedometer.measured_mm_s"] = max(0, true + draw.randint(-MEASURED_WITHIN_MM_S, MEASURED_WITHIN_MM_S))
        steps.append(step)
    return steps
