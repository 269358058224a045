"""Error laws of distance-measuring units (MRK-4): the greatest error of a measured distance.

A unit measures a distance in every cycle. Its error since a reference is at most

    constant + sum over cycles of ( floor x period + rate x distance above the knee + drift x age x period )

`constant` counts once (quantisation, a wheel that slips and grips again): the error wanders within it and does not
add up. All terms are exact whole nanometres: mm x ppm, mm/s x ms x 1000 and mm/s2 x ms x ms are all nm.
"""

from __future__ import annotations

from typing import Literal

from pydantic import Field

from safeloc.config import Config, quantity
from safeloc.language.expr import Lit, Num, as_num, exact_to, floor_to, maximum, with_unit
from safeloc.language.units import MM, MM_S, MS, NM, NM_PER_MM, PPM, PPM_PER_ONE

MOST_RATE_PPM = 900_000
"""The greatest rate that a machine with a single odometer accepts: beyond it, a measurement hardly tells any distance."""
UnitKind = Literal["wheel", "radar", "accelerometer", "eddy_current", "optical"]


class ErrorLaw(Config):
    """The error law of one unit."""

    kind: UnitKind = Field(
        description="what measures; wheel pulses, Doppler radar, acceleration, eddy current, optical rail"
    )
    constant_mm: int = quantity(5_000, "mm", 0, 100_000, "[S] SUBSET-041: 5 m")
    rate_ppm: int = quantity(50_000, "ppm of distance", 0, 1_000_000, "[S] SUBSET-041: 5 %")
    floor_mm_s: int = quantity(0, "mm/s", 0, 10_000, "[D] none for a unit that counts distance")
    knee_mm_s: int = quantity(0, "mm/s", 0, 150_000, "[D] 0: the rate counts from standstill")
    drift_mm_s2: int = quantity(0, "mm/s2", 0, 1_000, "[D] none unless the unit integrates acceleration")

    @property
    def wander_nm(self) -> int:
        """Half of the one-off constant: the error wanders between minus and plus this. Unit nm."""
        return self.constant_mm * NM_PER_MM // 2

    def portion(self, share_ppm: int) -> ErrorLaw:
        """Return the law of this share of a cycle, rounded up; without drift, whose share differs from cycle to cycle."""
        rate, floor = (-(-figure * share_ppm // PPM_PER_ONE) for figure in (self.rate_ppm, self.floor_mm_s))
        return self.model_copy(update={"rate_ppm": rate, "floor_mm_s": floor, "drift_mm_s2": 0})

    def growth_nm(self, distance: Num, age: Num, period_ms: int) -> Num:
        """Return the error that one cycle adds, nm. distance: magnitude in mm; age: ms since the reference."""
        knee = floor_to(Lit(self.knee_mm_s, MM_S) * Lit(period_ms, MS), MM)
        above = maximum(distance - knee, 0) if self.knee_mm_s else distance
        floor = exact_to(Lit(self.floor_mm_s, MM_S) * Lit(period_ms, MS), NM)
        drift = with_unit(age * (self.drift_mm_s2 * period_ms), NM) if self.drift_mm_s2 else as_num(0, NM)
        return above * Lit(self.rate_ppm, PPM) + floor + drift


def check_measures(odometer: ErrorLaw) -> None:
    """Raise ValueError for a rate so great that a measurement hardly tells any distance."""
    if odometer.rate_ppm > MOST_RATE_PPM:
        raise ValueError(f"odometer.rate_ppm must not exceed {MOST_RATE_PPM}: such an odometer measures no distance.")


def check_counts_distance(odometer: ErrorLaw) -> None:
    """Raise ValueError for a unit whose error drifts with time."""
    if odometer.drift_mm_s2:
        raise ValueError("odometer.drift_mm_s2 must be 0: this machine takes a unit that counts distance.")


WHEEL = ErrorLaw(kind="wheel")
"""[S] SUBSET-041: 5 m + 5 % of every measured distance."""

RADAR = ErrorLaw(kind="radar", constant_mm=6_000, rate_ppm=21_277, floor_mm_s=556, knee_mm_s=8_333)
"""[S] SUBSET-041 speed accuracy: 2 km/h up to 30 km/h, then rising to 12 km/h at 500 km/h; constant [M]."""

ACCELEROMETER = ErrorLaw(kind="accelerometer", constant_mm=1_000, rate_ppm=1_000, floor_mm_s=20, drift_mm_s2=5)
"""[M] a bias of 0.5 mg integrated twice; unusable long after a reference."""

EDDY_CURRENT = ErrorLaw(kind="eddy_current", constant_mm=2_000, rate_ppm=5_000)
"""[M] correlation of rail inhomogeneities: free of slip."""

OPTICAL = ErrorLaw(kind="optical", constant_mm=2_000, rate_ppm=10_000, floor_mm_s=50)
"""[M] optical flow over the rail head; blind in snow, which shows as drop-outs."""
