"""A vehicle that measures its way from marker to marker, and reports its position while the error is tolerable.

Figures: the odometer may add `constant_mm` and `rate_ppm` of the measured distance, the position is reported up to
`tolerance_mm`, and no stretch between markers is longer than `stretch_mm`.
"""

from __future__ import annotations

from collections.abc import Mapping

from safeloc.language.expr import Lit, exact_to, number
from safeloc.language.machine import Machine, Transition, modes
from safeloc.language.spec import Property, always
from safeloc.language.units import MM, NM, NM_PER_MM, PPM
from safeloc.language.world import Law, World

ON, OFF = modes("ON", "OFF")
measured = number("measured_mm", MM, 0, 10_000_000)
last = number("last_measured_mm", MM, 0, 10_000_000)
true_run = number("true_run_mm", MM, 0, 10_000_000)


def machine(given: Mapping[str, int]) -> Machine:
    """Return the machine for these figures. `measured_mm` and `true_run_mm` count from the last marker."""
    constant, tolerance = given["constant_mm"], given["tolerance_mm"]
    error = measured * Lit(given["rate_ppm"], PPM)
    tolerable = error <= (tolerance - constant) * NM_PER_MM
    beyond = exact_to(measured - true_run - constant, NM)
    return Machine(
        name="marked_line",
        modes=(ON, OFF),
        inputs=[measured],
        state={last: 0},
        outputs={"run_mm": last},
        transitions=[
            Transition("position", (ON, OFF), ON, tolerable, {last: measured}, rank=0),
            Transition("too far from the last marker", (ON, OFF), OFF, set={last: measured}, rank=1),
        ],
        world=World(
            choices=[true_run],
            clauses={
                "odometer": Law(beyond <= error, "It measures too much by the constant and the rate at most."),
                "stretch": Law(true_run <= given["stretch_mm"], "No stretch between markers is longer."),
            },
        ),
    )


def properties(made: Machine) -> list[Property]:
    """The position is withdrawn nowhere between two markers."""
    return [always("a position everywhere", made.mode.eq(ON))]
