"""A vehicle with a reader at each end, on a line with a marker every so often: where it may err most.

Figures: the readers are `vehicle_length_mm` apart, the markers `marker_distance_mm`. The front reader meets each marker first and the
rear reader the vehicle's length later; each reading begins the measured run anew. So the longest run between two readings is the
vehicle's length or what is left of the distance between markers, whichever is more: max(L, D - L).
"""

from __future__ import annotations

from collections.abc import Mapping

from safeloc.language.expr import Lit, exact_to, ite, number
from safeloc.language.machine import Machine, Transition, modes
from safeloc.language.spec import Property, always
from safeloc.language.units import MM, NM, NM_PER_MM, PPM
from safeloc.language.world import Law, World

ON, OFF = modes("ON", "OFF")
measured = number("measured_mm", MM, 0, 10_000_000)
last = number("last_measured_mm", MM, 0, 10_000_000)
past_marker = number("true_past_marker_mm", MM, 0, 10_000_000)


def machine(given: Mapping[str, int]) -> Machine:
    """Return the machine for these figures. `measured_mm` counts from the last reading, of either reader."""
    length, constant, tolerance = given["vehicle_length_mm"], given["constant_mm"], given["tolerance_mm"]
    error = measured * Lit(given["rate_ppm"], PPM)
    true_run = ite(past_marker < length, past_marker, past_marker - length)
    return Machine(
        name="two_readers",
        modes=(ON, OFF),
        inputs=[measured],
        state={last: 0},
        outputs={"run_mm": last},
        transitions=[
            Transition(
                "position", (ON, OFF), ON, error <= (tolerance - constant) * NM_PER_MM, {last: measured}, rank=0
            ),
            Transition("too far from the last reading", (ON, OFF), OFF, set={last: measured}, rank=1),
        ],
        world=World(
            choices=[past_marker],
            clauses={
                "markers": Law(past_marker < given["marker_distance_mm"], "There is a marker every so often."),
                "odometer": Law(
                    exact_to(measured - true_run - constant, NM) <= error,
                    "It measures too much by the constant and the rate at most.",
                ),
            },
        ),
    )


def properties(made: Machine) -> list[Property]:
    """The position is withdrawn nowhere between two markers."""
    return [always("a position everywhere", made.mode.eq(ON))]
