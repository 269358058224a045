"""Output of the satellite front ends of vehicles whose signals are reflected: the clock that they estimate, and what they solve.

The clock is the median of all differences, as the front end takes it: what reflections have in common moves the clock, and with it every
difference. The solution is that of least squares along the track from the signals that the criterion keeps, with the clock as
the second unknown; so it errs by the sum of their errors, each with its weight.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from safeloc.models.localizer.simulation.columns import Column, Columns
from safeloc.models.satellite.variables import MAX_DILUTION_PERMILLE, MISSING
from safeloc.models.satellite_selection import SelectionConfig
from safeloc.simulation.physics.gauss_markov import Floats
from safeloc.simulation.physics.multipath import Reflections

_LABELS = tuple(one.label for one in MISSING)
_NOTHING, _NONE_LEFT, _FEW_LEFT, _ALIKE, _OUT_OF_RANGE = (
    _LABELS.index(one) for one in ("NOTHING", "NONE_LEFT", "FEW_LEFT", "ALIKE", "OUT_OF_RANGE")
)
_UNKNOWNS = 2
_COSINE = math.cos(0.5)
"""Of the elevation of every satellite."""

Whole = NDArray[np.int64]
Flags = NDArray[np.bool_]


def clock_mm(errors_mm: Whole, heard: Flags) -> Whole:
    """Return the median of the errors of the signals that are heard, rounded down; 0 without any: arrays [channel, cycle, vehicle]."""
    number = heard.sum(axis=0)
    ordered = np.sort(np.where(heard, errors_mm, np.iinfo(np.int64).max), axis=0)
    low, high = (
        np.take_along_axis(ordered, np.maximum(at, 0)[None], axis=0)[0] for at in ((number - 1) // 2, number // 2 - (number == 0))
    )  # fmt: skip
    return np.where(number > 0, (np.where(number > 0, low, 0) + np.where(number > 0, high, 0)) // 2, 0)


@dataclass(frozen=True, eq=False)
class Solved:
    """Solutions along the track, arrays [cycle, vehicle]; `used`: the signals in them, [channel, cycle, vehicle]."""

    used: Flags
    off_mm: Whole
    dilution_permille: Whole
    missing: Whole


def solved(errors_mm: Whole, kept: Flags, azimuth: Floats) -> Solved:
    """Solve for place and clock from the signals that are kept.

    azimuth  of each satellite against the track, [channel, vehicle]; all of them have one elevation
    """
    slopes = np.array([[_COSINE * math.cos(one) for one in row] for row in azimuth.tolist()])
    number = kept.sum(axis=0)
    zero = np.zeros(number.shape)
    mean, spread, off, weights = zero, zero, zero, zero
    for one, slope in zip(kept, slopes, strict=True):
        mean = mean + np.where(one, slope, 0.0)
    mean = mean / np.maximum(number, 1)
    for one, slope in zip(kept, slopes, strict=True):
        spread = spread + np.where(one, (slope - mean) * (slope - mean), 0.0)
    alike = spread < 1e-3
    for one, slope, error in zip(kept, slopes, errors_mm, strict=True):
        weight = np.where(one & ~alike, (slope - mean) / np.where(alike, 1.0, spread), 0.0)
        off, weights = off + weight * error, weights + np.abs(weight)
    dilution = np.ceil(weights * 1_000).astype(np.int64) + 1
    missing = np.where(dilution > MAX_DILUTION_PERMILLE, _OUT_OF_RANGE, _NOTHING)
    missing = np.where(alike, _ALIKE, missing)
    missing = np.where(number < _UNKNOWNS, np.where(number == 0, _NONE_LEFT, _FEW_LEFT), missing)
    return Solved(
        kept & (missing == _NOTHING),
        np.rint(off).astype(np.int64),
        np.minimum(dilution, MAX_DILUTION_PERMILLE),
        missing,
    )


def kept(config: SelectionConfig, off_mm: Whole, off_mm_s: Whole) -> Flags:
    """Return which signals the criterion keeps by their differences."""
    return np.asarray((np.abs(off_mm) < config.range_threshold_mm) & (np.abs(off_mm_s) < config.speed_threshold_mm_s))


# ------------------------------------------------------------------ the inputs of vehicles


@dataclass(frozen=True, eq=False)
class Receivers:
    """Receivers of vehicles: the columns that they make without reflections, and what is reflected.

    which  vehicles whose signals are reflected
    ready  the warm-up has ended, array [cycle, vehicle]
    """

    config: SelectionConfig
    columns: Columns
    which: Flags
    ready: Flags
    found: Reflections

    def reflected(self, place_mm: Whole) -> dict[str, Column]:
        """Return the columns that reflections change; `place_mm`: the place that signals without error lead to, [cycle, vehicle]."""
        errors = np.stack([self._values(number, "range_off_mm") for number in self._numbers])
        errors += np.rint(self.found.excess_mm).astype(np.int64)
        heard = np.stack([self._heard(number) for number in self._numbers])
        clock = clock_mm(errors, heard)
        rates = np.stack([self._values(number, "speed_off_mm_s") for number in self._numbers])
        solution = solved(errors, kept(self.config, errors - clock, rates) & heard & self.ready, self.found.azimuth)
        columns = {"selection.clock_mm": self._where(clock, "selection.clock_mm")}
        for number, error, one, used in zip(self._numbers, errors, heard, solution.used, strict=True):
            name = f"selection.channel_{number}"
            columns |= {
                f"{name}_error_mm": self._where(np.where(one, error, 0), f"{name}_error_mm"),
                f"{name}_range_off_mm": self._where(np.where(one, error - clock, 0), f"{name}_range_off_mm"),
                f"position.used_{number}": self._where(used, f"position.used_{number}"),
            }
        return columns | self._solution(solution, place_mm)

    @property
    def _numbers(self) -> range:
        """The channels that may have a satellite."""
        return range(1, len(self.found.azimuth) + 1)

    def _solution(self, solution: Solved, place_mm: Whole) -> dict[str, Column]:
        there = self.ready & (solution.missing == _NOTHING)
        fix = self._where(place_mm + solution.off_mm, "position.fix_mm")
        before = self.columns["position.fix_mm"].present
        assert before is not None
        missing = np.where(self.ready, solution.missing, self.columns["position.fix_missing"].values)
        return {
            "position.fix_mm": Column(fix.values, np.where(self.which, there, before)),
            "position.fix_missing": self._where(missing, "position.fix_missing"),
            "position.fix_dilution_permille": self._where(solution.dilution_permille, "position.fix_dilution_permille"),
        }

    def _where(self, values: Whole | Flags, name: str) -> Column:
        """Return the values for the vehicles whose signals are reflected, and those that there were for the others."""
        before = self.columns[name]
        return Column(np.where(self.which, values, before.values), before.present)

    def _values(self, number: int, what: str) -> Whole:
        return np.broadcast_to(self.columns[f"selection.channel_{number}_{what}"].values, self.ready.shape)

    def _heard(self, number: int) -> Flags:
        present = self.columns[f"selection.channel_{number}_range_off_mm"].present
        assert present is not None
        return np.broadcast_to(present, self.ready.shape)
