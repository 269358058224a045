"""Configuration, variables and the kinematic state of the satellite position machine."""

from __future__ import annotations

from dataclasses import dataclass

from pydantic import model_validator

from safeloc.config import Config, quantity
from safeloc.expr import (
    Bool,
    BoolVar,
    Num,
    NumVar,
    Optional,
    boolean,
    choice,
    enumeration,
    members,
    number,
    optional,
)
from safeloc.models.satellite_selection import SelectionConfig
from safeloc.units import COUNT, MM, NM, UM_S

REASON = members("reason", "LOCATED", "NO_REFERENCE", "TOLERANCE", "COASTED_OUT", "CONTRADICTION")
LOCATED, NO_REFERENCE, TOLERANCE, COASTED_OUT, CONTRADICTION = REASON
FIX = members("fix", "NONE", "ACCEPTED", "NOT_USABLE", "TOO_FEW", "DISJOINT", "TOO_COARSE", "UNLOCATED")
NO_FIX, ACCEPTED, NOT_USABLE, TOO_FEW, DISJOINT, TOO_COARSE, NOT_LOCATED = FIX
NM_PER_MM = 1_000_000


class SatelliteConfig(Config):
    """What position from satellites depends on."""

    selection: SelectionConfig = SelectionConfig()
    period_ms: int = quantity(200, "ms", 2, 2_000, "[D] 5 Hz; a multiple of 2")
    tolerance_mm: int = quantity(30_000, "mm", 2, 500_000, "[S] OCORA 7239: 30 m on main line")
    max_speed_mm_s: int = quantity(44_445, "mm/s", 1, 138_889, "[D] 160 km/h")
    max_acceleration_mm_s2: int = quantity(1_500, "mm/s2", 1, 10_000, "[D] 1.5 m/s2, passenger")
    minimum_satellites: int = quantity(3, "count", 2, 32, "[D] along a track: 2 solve, 3 detect, 4 exclude")
    coast_limit_cycles: int = quantity(10, "cycles", 0, 10_000, "[D] 2 s at 5 Hz")
    position_limit_mm: int = quantity(1_000_000_000, "mm", 1_000, 10_000_000_000, "[D] 1 000 km of line")
    protection_limit_mm: int = quantity(30_000, "mm", 1, 1_000_000, "[S] RHINOS: 12 m along track; 30 m tolerable")

    @model_validator(mode="after")
    def _can_locate(self) -> SatelliteConfig:
        if self.period_ms % 2:
            raise ValueError("period_ms must be even, so that half of an acceleration's way is whole nanometres.")
        if self.minimum_satellites > self.selection.channels:
            raise ValueError(f"minimum_satellites {self.minimum_satellites} exceeds the receiver's channels.")
        return self

    @property
    def speed_change_um_s(self) -> int:
        """The greatest change of speed in a cycle."""
        return self.max_acceleration_mm_s2 * self.period_ms

    @property
    def way_nm(self) -> int:
        """The greatest way that an acceleration adds in a cycle, A T^2 / 2."""
        return self.max_acceleration_mm_s2 * self.period_ms * self.period_ms // 2


@dataclass(frozen=True, eq=False)
class Parts:
    """The variables of the position machine.

    usable, used  inputs per channel: it is in the list (wired from the selection); the solution uses it
    fix           input: along-track place of the solution; protection: its bound by the bounds of the used satellites
    reference     input: a trusted place (a balise) with its accuracy
    speed, change the estimated speed and its change in the last cycle
    truth, true_speed  ghosts: nm and um/s
    """

    config: SatelliteConfig
    usable: tuple[BoolVar, ...]
    used: tuple[BoolVar, ...]
    fix: Optional
    protection: NumVar
    fix_speed: NumVar
    speed_protection: NumVar
    reference: Optional
    accuracy: NumVar
    position: NumVar
    margin: NumVar
    speed: NumVar
    speed_margin: NumVar
    change: NumVar
    coasted: NumVar
    judged: NumVar
    reason: NumVar
    truth: NumVar
    true_speed: NumVar
    next_truth: NumVar
    next_speed: NumVar


def parts(config: SatelliteConfig) -> Parts:
    """Fresh variables for one machine."""
    limit, fast = config.position_limit_mm, config.max_speed_mm_s * 1_000
    reach, channels = (limit + 2 * config.tolerance_mm) * NM_PER_MM, range(1, config.selection.channels + 1)
    widest = 2 * fast
    return Parts(
        config,
        tuple(boolean(f"usable_{n}") for n in channels),
        tuple(boolean(f"used_{n}") for n in channels),
        optional("fix_mm", MM, -limit, limit),
        number("fix_protection_mm", MM, 0, 10 * config.protection_limit_mm),
        number("fix_speed_um_s", UM_S, -fast, fast),
        number("fix_speed_protection_um_s", UM_S, 0, widest),
        optional("reference_mm", MM, -limit, limit),
        number("reference_accuracy_mm", MM, 0, config.tolerance_mm),
        number("position_nm", NM, -limit * NM_PER_MM, limit * NM_PER_MM),
        number("margin_nm", NM, 0, config.tolerance_mm * NM_PER_MM),
        number("speed_um_s", UM_S, -fast, fast),
        number("speed_margin_um_s", UM_S, 0, widest),
        number("change_um_s", UM_S, -config.speed_change_um_s, config.speed_change_um_s),
        number("coasted_cycles", COUNT, 0, config.coast_limit_cycles),
        choice("fix_judged", enumeration(FIX)),
        choice("reason", enumeration(REASON)),
        number("truth_nm", NM, -reach, reach),
        number("true_speed_um_s", UM_S, -fast, fast),
        number("next_truth_nm", NM, -reach, reach),
        number("next_speed_um_s", UM_S, -fast, fast),
    )


@dataclass(frozen=True, eq=False)
class State:
    """Place and speed with their margins: nm, um/s."""

    position: Num
    margin: Num
    speed: Num
    speed_margin: Num

    @property
    def bounds(self) -> tuple[Num, Num]:
        """Where the vehicle is."""
        return self.position - self.margin, self.position + self.margin

    @property
    def speeds(self) -> tuple[Num, Num]:
        """How fast it is."""
        return self.speed - self.speed_margin, self.speed + self.speed_margin

    def meets(self, other: State) -> Bool:
        """Whether both have a place and a speed in common."""
        return meet(self.bounds, other.bounds) & meet(self.speeds, other.speeds)


def meet(first: tuple[Num, Num], second: tuple[Num, Num]) -> Bool:
    return (first[0] <= second[1]) & (second[0] <= first[1])
