"""A safety cage around a host's own estimator: a Kalman filter's value is passed on only inside the proven interval.

    pip install filterpy
    python docs/examples/guarded_filter.py

The filter is good on average and promises nothing: here it is given a satellite position that drifts off by hundreds of
metres while claiming a standard deviation of 3 m, and it follows. The controller's interval holds the true place
for every stream that obeys the machine's assumption, so what the filter says is passed on inside it and nowhere else.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from filterpy.kalman import KalmanFilter  # type: ignore[import-untyped,unused-ignore]

from safeloc.models.odometry.variables import OdometryConfig
from safeloc.runtime.embedding import Controller, Interval, Program
from safeloc.runtime.streams.records import DistanceRecord, MarkerRecord, Record
from safeloc.shipped_machines import ENTRIES

PERIOD_MS, SPEED_MM_S = 100, 20_000
STEP_MM = SPEED_MM_S * PERIOD_MS // 1_000
MARKER_EVERY = 250
DRIFT_FROM, DRIFT_MM = 300, 2_000


@dataclass(frozen=True)
class Passed:
    """One cycle: the true place, what the filter said, the proven interval, and what was passed on (None: nothing)."""

    truth_mm: int
    filter_mm: float
    interval: Interval | None
    passed_mm: float | None


def kalman() -> KalmanFilter:
    """Place and speed along the track, in mm and mm/s, with the figures its maker believed in."""
    made = KalmanFilter(dim_x=2, dim_z=1)
    made.F = np.array([[1.0, PERIOD_MS / 1_000], [0.0, 1.0]])
    made.H = np.array([[1.0, 0.0]])
    made.x = np.array([0.0, SPEED_MM_S])
    made.P *= 1_000_000.0
    made.R *= 3_000.0**2
    made.Q = np.diag([100.0, 10_000.0])
    return made


def caged(estimate_mm: float, interval: Interval | None) -> float | None:
    """The estimate, if the place it names is within what is proven; nothing else is put in its stead."""
    return estimate_mm if interval is not None and interval.holds(round(estimate_mm)) else None


def sensors(cycle: int, rng: np.random.Generator) -> tuple[list[Record], float]:
    """Records of odometers and balises, and the satellite receiver's position, which drifts off."""
    end_ms, truth_mm = cycle * PERIOD_MS, cycle * STEP_MM
    records: list[Record] = [
        DistanceRecord(time_ms=end_ms, end=end, unit=unit, distance_mm=STEP_MM)
        for end in ("front", "rear")
        for unit in ("wheel", "radar")
    ]
    if cycle % MARKER_EVERY == 1:
        records.append(
            MarkerRecord(
                time_ms=end_ms, end="front", marker=1 + cycle // MARKER_EVERY, position_mm=truth_mm, accuracy_mm=500,
                since_mm=0,
            )
        )  # fmt: skip
    return records, truth_mm + rng.normal(0, 3_000) + max(0, cycle - DRIFT_FROM) * DRIFT_MM / 10


def journey(cycles: int = 1_000, seed: int = 1) -> Iterator[Passed]:
    """The train runs at 72 km/h; both estimators see the same run."""
    rng, estimator = np.random.default_rng(seed), kalman()
    controller = Controller(Program(ENTRIES["odometry"].make(OdometryConfig(trust_first_marker=True))))
    for cycle in range(1, cycles + 1):
        records, satellite_mm = sensors(cycle, rng)
        estimator.predict()
        estimator.update(satellite_mm)
        interval = controller.step(records).interval
        estimate_mm = float(estimator.x[0])
        yield Passed(cycle * STEP_MM, estimate_mm, interval, caged(estimate_mm, interval))


def main() -> None:
    """What came through, in figures."""
    run = list(journey())
    passed = [one for one in run if one.passed_mm is not None]
    worst = max(abs(one.filter_mm - one.truth_mm) for one in run)
    worst_passed = max(abs(one.passed_mm - one.truth_mm) for one in passed if one.passed_mm is not None)
    print(f"{len(run)} cycles, {len(passed)} values passed on")
    print(
        f"farthest off the truth: the filter {worst / 1_000:.1f} m, of what was passed on {worst_passed / 1_000:.1f} m"
    )


if __name__ == "__main__":
    main()
