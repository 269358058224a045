"""A simulated counting head at one end of an area, with the truth that the counter's world has of it."""

from __future__ import annotations

from collections.abc import Sequence

from safeloc.language.units import MS_PER_S, NM_PER_MM, UM_PER_MM
from safeloc.models.axle_counter import AxleCounterConfig
from safeloc.runtime.streams.steps import Cell

_TROLLEY_MM_S = 10_000
_SPREAD_MM_S = 200
"How far the reported bounds of an axle's speed are from it."


class Head:
    """The head at a place of the line, and the vehicle whose axles passed it last."""

    def __init__(self, config: AxleCounterConfig, place_mm: int) -> None:
        self._config, self._place_mm = config, place_mm
        self._speed_mm_s = 0
        self._run_nm, self._length_nm, self._away = 0, 0, True
        self._is_followed = False

    def trolley(self, axles: int) -> dict[str, Cell]:
        """Return a cycle of the sweep: so many axles of a trolley at 10 m/s pass upwards, evenly through the cycle, or none."""
        run_mm = _TROLLEY_MM_S * self._config.period_ms // MS_PER_S
        apart_mm = run_mm // (axles + 1)
        before = [self._place_mm - apart_mm // 2 - apart_mm * number for number in range(axles)]
        told = self.cycle(before, [place + run_mm for place in before], _TROLLEY_MM_S if axles else self._speed_mm_s)
        self._is_followed = False
        return told

    def cycle(self, before_mm: Sequence[int], after_mm: Sequence[int], speed_mm_s: int) -> dict[str, Cell]:
        """Return the head's cells and their truth, from the places of all axles at both ends of a cycle, and their speed."""
        pairs = zip(before_mm, after_mm, strict=True)
        passed = [(then, now) for then, now in pairs if (then <= self._place_mm) != (now <= self._place_mm)]
        self._is_followed |= bool(passed)
        speed = self._speed_mm_s = speed_mm_s if self._is_followed else self._speed_mm_s
        upwards = bool(passed) and passed[0][1] > passed[0][0]
        passed.sort(reverse=upwards)
        first = self._away and bool(passed)
        run, to_axle = self._way_mm(passed, first, speed)
        self._moved(run * NM_PER_MM, to_axle * NM_PER_MM, first, bool(passed))
        return {**self._told(len(passed), upwards, speed), **_truth(len(passed), speed, run, to_axle)}

    def _way_mm(self, passed: Sequence[tuple[int, int]], first: bool, speed: int) -> tuple[int, int]:
        """Return the run of the cycle, and the one up to the last axle in it; both since the first axle, if a passage begins."""
        run = speed * self._config.period_ms // MS_PER_S
        if not passed:
            return run, 0
        (_, first_now), (last_then, last_now) = passed[0], passed[-1]
        return (first_now - self._place_mm, first_now - last_now) if first else (run, self._place_mm - last_then)

    def _moved(self, run_nm: int, to_axle_nm: int, first: bool, passed: bool) -> None:
        """Keep the run since the first axle and up to the last one, and whether the next axle begins another passage."""
        before = 0 if first else self._run_nm
        self._length_nm = before + to_axle_nm if passed else self._length_nm
        self._run_nm = before + run_nm
        apart = abs(self._run_nm - self._length_nm) > self._config.axle_gap_mm * NM_PER_MM
        self._away = (self._away and not passed) or apart

    def _told(self, axles: int, upwards: bool, speed: int) -> dict[str, Cell]:
        told: dict[str, Cell] = {
            "axle": "NONE", "axles_in_cycle": 1, "head_fault": False, "head_damped": False, "passage_over": False,
        }  # fmt: skip
        if axles:
            bounds = {
                "axle_speed_low_mm_s": max(abs(speed) - _SPREAD_MM_S, 0),
                "axle_speed_high_mm_s": min(abs(speed) + _SPREAD_MM_S, self._config.max_speed_mm_s),
            }
            told |= {"axle": "UP" if upwards else "DOWN", "axles_in_cycle": axles, **bounds}
        return told


def _truth(axles: int, speed: int, run_mm: int, to_axle_mm: int) -> dict[str, Cell]:
    return {
        "next_true_speed_um_s": speed * UM_PER_MM, "axle_true_speed_um_s": speed * UM_PER_MM,
        "true_cycle_distance_nm": run_mm * NM_PER_MM, "true_distance_to_axle_nm": to_axle_mm * NM_PER_MM,
        "true_axles_in_cycle": axles,
    }  # fmt: skip
