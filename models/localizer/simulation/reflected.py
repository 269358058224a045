"""Output of the satellite front ends of vehicles whose signals are reflected: the clock that they estimate, and what they solve.

The clock is the median of all differences, as the front end takes it: what reflections have in common moves the clock, and with it every
difference. The solution is that of least squares along the track from the signals that the criterion keeps, with the clock as
the second unknown; so it errs by the sum of their errors, each with its weight. Where range rates show reflections, the clock's rate is the median
of all rates, and the speed is solved from the same signals with the same weights. Covariances are those of the differences in the last cycles.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from safeloc.language.units import UM_PER_MM
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
    """Solutions along the track, arrays [cycle, vehicle]; `used`: the signals in them, [channel, cycle, vehicle].

    faster_um_s  how much too fast the speed is, from the errors of the range rates
    """

    used: Flags
    off_mm: Whole
    faster_um_s: Whole
    dilution_permille: Whole
    missing: Whole


def solved(errors_mm: Whole, rates_mm_s: Whole, kept: Flags, azimuth: Floats) -> Solved:
    """Solve for place and clock, and for speed and the clock's rate, from the signals that are kept.

    azimuth  of each satellite against the track, [channel, vehicle]; all of them have one elevation
    """
    slopes = np.array([[_COSINE * math.cos(one) for one in row] for row in azimuth.tolist()])
    number = kept.sum(axis=0)
    zero = np.zeros(number.shape)
    mean, spread, off, faster, weights = zero, zero, zero, zero, zero
    for one, slope in zip(kept, slopes, strict=True):
        mean = mean + np.where(one, slope, 0.0)
    mean = mean / np.maximum(number, 1)
    for one, slope in zip(kept, slopes, strict=True):
        spread = spread + np.where(one, (slope - mean) * (slope - mean), 0.0)
    alike = spread < 1e-3
    for one, slope, error, rate in zip(kept, slopes, errors_mm, rates_mm_s, strict=True):
        weight = np.where(one & ~alike, (slope - mean) / np.where(alike, 1.0, spread), 0.0)
        off, weights, faster = off + weight * error, weights + np.abs(weight), faster + weight * rate
    dilution = np.ceil(weights * 1_000).astype(np.int64) + 1
    missing = np.where(dilution > MAX_DILUTION_PERMILLE, _OUT_OF_RANGE, _NOTHING)
    missing = np.where(alike, _ALIKE, missing)
    missing = np.where(number < _UNKNOWNS, np.where(number == 0, _NONE_LEFT, _FEW_LEFT), missing)
    return Solved(
        kept & (missing == _NOTHING),
        np.rint(off).astype(np.int64),
        np.rint(faster * UM_PER_MM).astype(np.int64),
        np.minimum(dilution, MAX_DILUTION_PERMILLE),
        missing,
    )


def kept(config: SelectionConfig, off_mm: Whole, off_mm_s: Whole) -> Flags:
    """Return which signals the criterion keeps by their differences."""
    return np.asarray((np.abs(off_mm) < config.range_threshold_mm) & (np.abs(off_mm_s) < config.speed_threshold_mm_s))


def covariance(off: Whole, heard: Flags, window: Whole) -> Whole:
    """Return the variance of each signal's differences that were received in the last cycles, rounded down; 0 of fewer than two.

    off, heard  arrays [channel, cycle, vehicle]; window: cycles, [vehicle], at least 1
    """
    cycles = np.arange(1, off.shape[1] + 1)[:, None]
    before = np.maximum(cycles - window, 0)

    def within(values: Whole) -> Whole:
        """Return the sum over the window."""
        sums = np.concatenate([np.zeros_like(values[:, :1]), np.cumsum(values, axis=1)], axis=1)
        return np.asarray(sums[:, 1:] - np.take_along_axis(sums, before[None], axis=1))

    known = np.where(heard, off, 0)
    number, total, squares = within(heard.astype(np.int64)), within(known), within(known * known)
    several = np.maximum(number, 1)
    return np.where(number > 1, np.maximum(squares // several - (total // several) ** 2, 0), 0)


# ------------------------------------------------------------------ the inputs of vehicles


@dataclass(frozen=True, eq=False)
class Receivers:
    """Receivers of vehicles: the columns that they make without reflections, and what is reflected.

    which        vehicles whose signals are reflected
    ready        the warm-up has ended, array [cycle, vehicle]
    period_ms    length of a cycle
    fastest_um_s  the greatest speed that a solution can have
    """

    config: SelectionConfig
    columns: Columns
    which: Flags
    ready: Flags
    found: Reflections
    period_ms: int
    fastest_um_s: int

    def reflected(self, place_mm: Whole, speed_um_s: Whole) -> dict[str, Column]:
        """Return the columns that reflections change; place and speed: those that signals without error lead to, [cycle, vehicle]."""
        errors = np.stack([self._values(number, "range_off_mm") for number in self._numbers])
        errors += np.rint(self.found.excess_mm).astype(np.int64)
        heard = np.stack([self._heard(number) for number in self._numbers])
        clock = clock_mm(errors, heard)
        rates, clock_rate = self._rates(heard)
        covariances = self._covariances(errors - clock, rates - clock_rate, heard)
        good = kept(self.config, errors - clock, rates - clock_rate)
        for name, values in covariances.items():
            good &= values < getattr(self.config, name)
        solution = self._held(solved(errors, rates, good & heard & self.ready, self.found.azimuth), speed_um_s)
        columns = {"selection.clock_mm": self._where(clock, "selection.clock_mm")}
        columns["selection.clock_mm_s"] = self._where(clock_rate, "selection.clock_mm_s")
        for number, one, used in zip(self._numbers, heard, solution.used, strict=True):
            name, at = f"selection.channel_{number}", number - 1
            told = {
                "error_mm": errors[at], "range_off_mm": errors[at] - clock,
                "speed_error_mm_s": rates[at], "speed_off_mm_s": rates[at] - clock_rate,
            }  # fmt: skip
            columns |= {
                f"{name}_{what}": self._where(np.where(one, own, 0), f"{name}_{what}") for what, own in told.items()
            }
            columns |= {f"{name}_{what}": self._where(own[at], f"{name}_{what}") for what, own in covariances.items()}
            columns[f"position.used_{number}"] = self._where(used, f"position.used_{number}")
        return columns | self._solution(solution, place_mm, speed_um_s)

    @property
    def _numbers(self) -> range:
        """The channels that may have a satellite."""
        return range(1, len(self.found.azimuth) + 1)

    def _rates(self, heard: Flags) -> tuple[Whole, Whole]:
        """Return the error of each range rate, and the rate of the clock that the receiver estimates from them."""
        rates = np.stack([self._values(number, "speed_off_mm_s") for number in self._numbers])
        changing = self.found.changing
        if not changing.any():
            return rates, np.zeros(self.ready.shape, dtype=np.int64)
        rates = rates + np.rint(self.found.change_mm * (1_000 / self.period_ms)).astype(np.int64)
        return rates, np.where(changing, clock_mm(rates, heard), 0)

    def _covariances(self, off_mm: Whole, off_mm_s: Whole, heard: Flags) -> dict[str, Whole]:
        """Return the covariances of ranges and of range rates by the names of their limits; none if no receiver shows reflections in them."""
        window, found = self.found.window, dict[str, Whole]()
        if not (window > 0).any():
            return found
        for name, values in (("range_covariance_mm2", off_mm), ("speed_covariance_mm2_s2", off_mm_s)):
            own = np.stack([self._values(number, name) for number in self._numbers])
            found[name] = np.where(window > 0, covariance(values, heard, np.maximum(window, 1)), own)
        return found

    def _held(self, solution: Solved, speed_um_s: Whole) -> Solved:
        """Return the solutions without those whose speed, if it shows reflections, no input can hold."""
        beyond = self.found.changing & (np.abs(speed_um_s + solution.faster_um_s) > self.fastest_um_s)
        missing = np.where(beyond & (solution.missing == _NOTHING), _OUT_OF_RANGE, solution.missing)
        return replace(solution, used=solution.used & ~beyond, missing=missing)

    def _solution(self, solution: Solved, place_mm: Whole, speed_um_s: Whole) -> dict[str, Column]:
        changing, speed = self.found.changing & self.which, speed_um_s + solution.faster_um_s
        there = self.ready & (solution.missing == _NOTHING)
        fix = self._where(place_mm + solution.off_mm, "position.fix_mm")
        before = self.columns["position.fix_mm"].present
        assert before is not None
        why = np.where(self.ready, solution.missing, self.columns["position.fix_missing"].values)
        columns = {
            "position.fix_mm": Column(fix.values, np.where(self.which, there, before)),
            "position.fix_missing": self._where(why, "position.fix_missing"),
            "position.fix_dilution_permille": self._where(solution.dilution_permille, "position.fix_dilution_permille"),
        }
        told = {
            "position.fix_speed_um_s": np.where(there, speed, 0),
            "position.fix_speed_dilution_permille": solution.dilution_permille,
        }
        return columns | {
            name: Column(np.where(changing, values, self.columns[name].values)) for name, values in told.items()
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
