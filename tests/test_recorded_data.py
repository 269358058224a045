"""What the recordings themselves say: how real trains move, and that gates and vehicles fit them."""

from __future__ import annotations

import math
from itertools import pairwise
from pathlib import Path

import pytest

from safeloc.models.odometry.variables import OdometryConfig
from safeloc.simulation.motion import VehicleConfig
from safeloc.simulation.vehicles import load_vehicle
from tests.data_sources import log_steps_mm, rows

LOG_PERIOD_MS = 400
GATES = OdometryConfig(period_ms=LOG_PERIOD_MS, reader_latency_ms=0).limits
VEHICLES = Path(__file__).resolve().parents[1] / "models" / "vehicles"


def largest(name: str) -> tuple[int, int]:
    """The largest distance of a 0.4 s row and the largest change between two, in mm; none across a gap in time."""
    steps = log_steps_mm(name, LOG_PERIOD_MS)
    changes = [abs(after - before) for before, after in pairwise(steps) if before is not None and after is not None]
    return max(step for step in steps if step is not None), max(changes)


@pytest.mark.parametrize(("log", "distance_mm", "change_mm"), [("28876", 9_160, 99), ("31176", 12_616, 373)])
def test_clean_logs_are_within_the_default_gates(log: str, distance_mm: int, change_mm: int) -> None:
    """160 km/h and 2.5 m/s2; the largest change holds some of the receiver's own noise (2.3 m/s2 in one row)."""
    assert largest(f"trains/log_{log}.csv") == (distance_mm, change_mm)
    assert distance_mm <= GATES.max_cycle_distance_mm
    assert change_mm <= GATES.max_cycle_distance_change_mm


@pytest.mark.parametrize(("log", "distance_mm", "change_mm"), [("31259", 11_127, 2_166), ("29083", 212_327, 210_605)])
def test_disturbed_logs_are_not(log: str, distance_mm: int, change_mm: int) -> None:
    """31259 has a few changes that no train makes; 29083 jumps at 530 m/s."""
    assert largest(f"trains/log_{log}.csv") == (distance_mm, change_mm)
    assert change_mm > GATES.max_cycle_distance_change_mm


def test_a_gap_in_time_is_no_distance() -> None:
    """29083 lacks two seconds in one place: there is no 0.4 s distance there, neither a long nor a short one."""
    assert log_steps_mm("trains/log_29083.csv", LOG_PERIOD_MS).count(None) == 1


@pytest.mark.parametrize(
    ("run", "vehicle"),
    [
        ("local_const", "desiro-br642"),
        ("local_slope", "desiro-br642"),
        ("local_speed", "desiro-br642"),
        ("freight_const", "freight-v90"),
        ("freight_speed", "freight-v90"),
    ],
)
def test_every_row_of_a_running_time_calculation_is_within_its_vehicle(run: str, vehicle: str) -> None:
    """Speed, acceleration and braking of each row; rows stay in order of time and place."""
    able = load_vehicle(VEHICLES / f"{vehicle}.toml")
    found = rows(f"trainruns/{run}.csv")
    assert found
    for row in found:
        assert 0 <= float(row["v"]) * 1000 <= able.max_speed_mm_s
        assert -able.brake_mm_s2 <= float(row["a"]) * 1000 <= able.acceleration_mm_s2
    assert all(float(one["t"]) < float(two["t"]) and float(one["s"]) < float(two["s"]) for one, two in pairwise(found))


def test_the_freight_train_is_too_slow_for_the_railcar() -> None:
    """The gates tell vehicles apart: the railcar's runs do not fit the freight train."""
    freight = load_vehicle(VEHICLES / "freight-v90.toml")
    fastest = max(float(row["v"]) for row in rows("trainruns/local_const.csv"))
    assert fastest * 1000 > freight.max_speed_mm_s


def test_the_default_vehicle_is_the_railcar() -> None:
    """Its length, traction, brake and jerk, and its top speed within a millimetre per second."""
    railcar, default = load_vehicle(VEHICLES / "desiro-br642.toml"), VehicleConfig()
    assert math.isclose(railcar.max_speed_mm_s, default.max_speed_mm_s, abs_tol=1)
    assert railcar.model_copy(update={"max_speed_mm_s": default.max_speed_mm_s}) == default
