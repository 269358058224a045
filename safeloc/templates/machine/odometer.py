"""An odometer: where the train is, from the distance that a wheel ran since the last marker, and when that is not known.

    safeloc verify odometer.py:machine

proves the list `properties` at the end of this file for every run that obeys the clauses of `world`, then runs property
tests and replays the `recordings`.

The file has five parts, and each reads only what stands above it: figures, variables, world (what is physically so),
machine (what runs on board), claims (what must hold). A sixth, the simulation, makes recordings.
"""

from __future__ import annotations

from random import Random

from safeloc.language.absence import NO_BOUND, NO_PLACE, shown_if
from safeloc.language.declared import Declared
from safeloc.language.expr import abs_, before, between, ceil_div, ceil_to, exact_to, floor_div, number, optional
from safeloc.language.machine import ANY, Machine, Transition, current_mode, modes
from safeloc.language.spec import always, reachable
from safeloc.language.units import MM, NM, UM
from safeloc.language.world import Law, World

# ------------------------------------------------------------------ figures
# Each has a name, and the name carries the unit: no bare number stands in a guard.

FASTEST_MM = 50_000
"""The farthest that the train runs in one cycle, which lasts a second."""
LINE_MM = 100_000_000
"""The line reaches from -LINE_MM to LINE_MM."""
WHEEL_CONSTANT_UM, WHEEL_RATE_PPM = 500, 12_500
"""The error law of the wheel, cycle by cycle: a constant (its pulses) and a rate (slip and wear) of the distance."""
MARKER_UM = 200_000
"""The reader of the markers gives the train's place at the end of the cycle, off by at most this distance."""
TOLERANCE_MM = 5_000
"""A position with a greater margin is of no use to anybody."""

# ------------------------------------------------------------------ variables
# Each is declared once, with its role, its range and its first value.

declared = Declared()
# Inputs. An `optional` one may be missing: its `.value` counts only where `.present` is asked for as well.
wheel = declared.sensor(optional("wheel_mm", MM, 0, FASTEST_MM))
marker = declared.sensor(optional("marker_mm", MM, -LINE_MM, LINE_MM))
# State: what the machine remembers from step to step.
place = declared.state(number("place_mm", MM, -LINE_MM, LINE_MM), first=0)
margin = declared.state(number("margin_um", UM, 0, TOLERANCE_MM * 1_000), first=0)
# A ghost is so, but no device reads it: here the true position. ANY: it may begin anywhere. Its unit is finer than that
# of the margin; otherwise no proof could notice a margin that is rounded to the wrong side.
truth = declared.ghost(number("truth_nm", NM, -LINE_MM * 1_000_000, LINE_MM * 1_000_000), first=ANY)
# A choice of the world in each step: how far the train really runs.
run = declared.choice(number("run_nm", NM, 0, FASTEST_MM * 1_000_000))

# ------------------------------------------------------------------ world
# What is physically so. Every proof assumes its clauses, so they are written over sensors and ghosts alone. A clause that
# reads what the machine computes is refused: a wrong machine would change the assumption of its own proof.

wheel_error = abs_(exact_to(wheel.value, NM) - run)
wheel_bound = floor_div(exact_to(wheel.value, NM) * WHEEL_RATE_PPM, 1_000_000) + WHEEL_CONSTANT_UM * 1_000
marker_error = abs_(exact_to(marker.value, NM) - (truth + run))

world = World(
    ghosts=declared.ghosts,
    choices=declared.choices,
    moves={truth: truth + run},
    clauses={
        "the wheel keeps its error law": Law(
            wheel.present.implies(wheel_error <= wheel_bound),
            "In each cycle the distance of the wheel is off by at most a constant and a rate.",
            source="[M] to be taken from the data sheet",
            owner="supplier",
        ),
        "markers are read where they are": Law(
            marker.present.implies(marker_error <= MARKER_UM * 1_000),
            "A place that the reader of the markers gives is off by at most the reading distance.",
            source="[M] to be surveyed",
            owner="infrastructure",
        ),
        "the train stays on the line": Law(
            between(truth.low, truth + run, truth.high),
            "The true position does not leave the line.",
            source="[M] the range of the coordinates",
            owner="operator",
        ),
    },
)

# ------------------------------------------------------------------ machine
# What runs on board. Each step takes the first transition whose source is the mode and whose guard holds. Two of the same
# `rank` must exclude each other; a greater rank says: only if none before it fires.

table = LOST, LOCATED = modes("LOST", "LOCATED")
mode = current_mode(table)

moved_to = place + wheel.value
grown = margin + ceil_div(exact_to(wheel.value, UM) * WHEEL_RATE_PPM, 1_000_000) + WHEEL_CONSTANT_UM
fits = (grown <= TOLERANCE_MM * 1_000) & (moved_to <= LINE_MM)

located = mode.eq(LOCATED)
reported_margin = shown_if(located, ceil_to(margin, MM), NO_BOUND)

machine = Machine(
    name="odometer",
    doc="Locates a train by the distance of a wheel since the last marker; withdraws the position when it is too uncertain.",
    modes=table,
    inputs=declared.inputs,
    state=declared.states,
    world=world,
    transitions=[
        Transition("marker", table, LOCATED, marker.present, {place: marker.value, margin: MARKER_UM}, rank=0),
        Transition("no reading", LOCATED, LOST, ~wheel.present, {place: 0, margin: 0}, rank=1),
        Transition("run on", LOCATED, LOCATED, fits, {place: moved_to, margin: grown}, rank=2),
        Transition("too uncertain", LOCATED, LOST, set={place: 0, margin: 0}, rank=3),
    ],
    # The usual names of a reported interval. While it is absent, a host gets None and C a harmless number far away.
    outputs={
        "valid": located,
        "position_mm": shown_if(located, place, NO_PLACE),
        "margin_below_mm": reported_margin,
        "margin_above_mm": reported_margin,
    },
    # A lemma helps the proof; it is proved itself, never assumed. Here: containment in the units of the machine.
    lemmas={"the margin covers the error": located.implies(abs_(exact_to(place, NM) - truth) <= exact_to(margin, NM))},
)

# ------------------------------------------------------------------ claims
# What must hold, in figures of their own, written from the requirement and not from the machine: a figure that is wrong
# in the machine must not be wrong in the claim as well. Guards are claimed both ways: when it must, when it must not.

valid, reported_mm = machine.flag("valid"), machine.output("position_mm")
below_mm, above_mm = machine.output("margin_below_mm"), machine.output("margin_above_mm")
was_located = before(mode).eq(LOCATED)

properties = [
    always(
        "contained",
        valid.implies(between(exact_to(reported_mm - below_mm, NM), truth, exact_to(reported_mm + above_mm, NM))),
        statement="A reported interval contains the true position.",
    ),
    always(
        "never wider than tolerable",
        valid.implies((below_mm <= 5_000) & (above_mm <= 5_000)),
        statement="No margin of a reported position is greater than 5 m.",
    ),
    always(
        "found by a marker only",
        (valid & ~was_located).implies(marker.present),
        statement="A lost position comes back with a marker, and in no other way.",
    ),
    always(
        "withdrawn without a reading",
        (~wheel.present & ~marker.present).implies(~valid),
        statement="In a cycle without any reading no position is reported.",
    ),
    always(
        "kept while it is good",
        (was_located & wheel.present & (before(margin) <= 4_000_000) & (before(place) <= 99_900_000)).implies(valid),
        statement="A position with a margin of up to 4 m is not withdrawn while the wheel measures.",
    ),
    reachable(
        "two hundred metres on the wheel",
        located & (margin >= 2_600_000),
        statement="A position can be kept over two hundred metres without a marker.",
    ),
]

# ------------------------------------------------------------------ recordings and simulation

recordings = ["recordings/run.jsonl"]
"""Recorded runs, by their paths from this file: `safeloc verify` replays them and checks every property on each."""


def simulate(seed: int) -> list[dict[str, int]]:
    """Return a simulated run, a mapping per cycle, for `safeloc simulate odometer.py:machine --out recordings/run.jsonl`.

    The wheel errs within its law. A marker stands every 250 m. In cycle 110 the wheel says nothing: the position is
    withdrawn, and the next marker brings it back. Behind 4 km there is no marker: the margin grows to what is tolerable.
    """
    draw, true_nm, steps = Random(seed), 0, list[dict[str, int]]()
    for cycle in range(200):
        wheel_mm = min(40_000, 500 * cycle)
        error_nm = wheel_mm * WHEEL_RATE_PPM + WHEEL_CONSTANT_UM * 1_000  # ppm of a mm are nm
        run_nm = max(0, wheel_mm * 1_000_000 + draw.randint(-error_nm, error_nm))
        passed = (true_nm + run_nm) // 250_000_000_000 > true_nm // 250_000_000_000
        true_nm += run_nm
        step = {"run_nm": run_nm} if cycle == 110 else {"run_nm": run_nm, "wheel_mm": wheel_mm}
        if passed and true_nm < 4_100_000_000_000:
            step["marker_mm"] = true_nm // 1_000_000 + draw.randint(-150, 150)
        steps.append({**step, "truth_mm": true_nm // 1_000_000})
    return steps
