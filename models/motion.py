"""The vehicle's own movement: the odometer that all ways of locating on board share, and where the vehicle really is.

    SILENT     no distance can be believed, for longer than permitted
    MEASURING  distances come, or are missing for no longer than permitted

`distance_mm` is the distance estimated for the cycle: the measured one where it is admitted, and none otherwise; nothing
is ever put in the place of a missing distance. No error law is assumed here: whoever uses the distance charges its own.
"""

from __future__ import annotations

from dataclasses import dataclass

from safeloc.config import Config, quantity
from safeloc.expr import TRUE, Expr, NumVar, Var, between, number
from safeloc.machine import ANY, Machine, Transition, current_mode, modes
from safeloc.models.odometry_parts.distance_device import ADMITTED, Limits
from safeloc.models.odometry_parts.error_law import NM_PER_MM, WHEEL, ErrorLaw
from safeloc.models.running.odometer import Odometer, odometer
from safeloc.units import MM, NM

__all__ = ["ADMITTED", "Motion", "MotionConfig", "Parts", "build", "parts"]


class MotionConfig(Config):
    """What a vehicle can do, and its odometer."""

    odometer: ErrorLaw = WHEEL
    period_ms: int = quantity(100, "ms", 10, 1_000, "[S] SUBSET-041: application cycle up to 100 ms")
    max_speed_mm_s: int = quantity(44_445, "mm/s", 1, 138_889, "[D] 160 km/h")
    max_acceleration_mm_s2: int = quantity(2_500, "mm/s2", 1, 10_000, "[M] 2.5 m/s2 with track brake")
    measuring_step_mm: int = quantity(14, "mm", 0, 10_000, "[S] 100 pulses a turn: 13.4 mm")
    gap_limit_cycles: int = quantity(5, "cycles", 0, 1_000, "[D] 0.5 s without any distance")
    position_limit_mm: int = quantity(1_000_000_000, "mm", 1_000, 10_000_000_000, "[D] 1 000 km of line")

    @property
    def limits(self) -> Limits:
        """What the odometer needs, rounded so that gates are no tighter than physics."""
        step = -(-self.max_speed_mm_s * self.period_ms // 1_000) + self.measuring_step_mm
        change = -(-self.max_acceleration_mm_s2 * self.period_ms**2 // 1_000_000) + 2 * self.measuring_step_mm
        gap, tolerance = self.gap_limit_cycles, 1
        return Limits(
            self.period_ms, tolerance, self.max_speed_mm_s, step, change, gap, gap, 0, self.position_limit_mm, False
        )  # fmt: skip


@dataclass(frozen=True, eq=False)
class Parts:
    """The odometer, and the world: where the front end is, and how far it runs in the cycle (ghosts, nm)."""

    config: MotionConfig
    odometer: Odometer
    truth: NumVar
    true_step: NumVar


@dataclass(frozen=True, eq=False)
class Motion:
    """The machine together with the terms it was built from."""

    machine: Machine
    own: Parts


def parts(config: MotionConfig) -> Parts:
    """Fresh variables for one vehicle."""
    limits = config.limits
    reach = config.position_limit_mm * NM_PER_MM
    return Parts(
        config,
        odometer(config.odometer, limits),
        number("truth_nm", NM, -reach, reach),
        number("true_step_nm", NM, -limits.blind_nm, limits.blind_nm),
    )


def build(own: Parts) -> Motion:
    """The machine over the given variables."""
    table = modes("SILENT", "MEASURING")
    silent, measuring = table
    distance = number("distance_mm", MM, -own.odometer.limits.max_step_mm, own.odometer.limits.max_step_mm)
    told: dict[Var, Expr] = {**own.odometer.listen(), distance: own.odometer.distance}
    after = own.truth + own.true_step
    made = Machine(
        name="motion",
        modes=table,
        inputs=[own.odometer.step],
        state={**own.odometer.state(), distance: 0},
        outputs={"distance_mm": distance, "measured": own.odometer.judged},
        transitions=[
            Transition("distance admitted", table, measuring, own.odometer.admitted, told, ("MRK-4",), 0),
            Transition("silent too long", measuring, silent, own.odometer.failed, told, ("MRK-D1",), 1),
            Transition("distance missing", measuring, measuring, TRUE, told, ("MRK-D1",), 2),
            Transition("still silent", silent, silent, TRUE, told, ("MRK-D1",), 2),
        ],
        ghosts={own.truth: ANY},
        ghost_inputs=[own.true_step],
        ghost_moves={own.truth: after},
        assumption=between(own.truth.low, after, own.truth.high),
        mode_variable=current_mode(table),
        doc=(
            "The vehicle's odometer, admitted only where the vehicle can have run the distance, and its true movement: no "
            "faster than its highest speed, and on the line. What a distance is worth is assumed by those who use it."
        ),
    )
    return Motion(made, own)
