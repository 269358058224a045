"""Train motion stays within speed, traction, brake, jerk and adhesion, and adds up exactly."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from safeloc.errors import InputError
from safeloc.simulation.motion import Leg, VehicleConfig, adhesion_mm_s2, move, plan
from safeloc.simulation.vehicles import load_vehicle

VEHICLES = sorted((Path(__file__).resolve().parents[2] / "models" / "vehicles").glob("*.toml"))


@pytest.mark.parametrize("path", VEHICLES, ids=lambda path: path.stem)
@pytest.mark.parametrize("seed", range(3))
def test_motion_is_within_what_the_vehicle_can_do(path: Path, seed: int) -> None:
    """Speed, acceleration and jerk of the shipped vehicles, in every cycle of a random service."""
    vehicle = load_vehicle(path)
    motion = move(vehicle, plan(vehicle, 300, np.random.default_rng(seed)), 100)
    acceleration = np.diff(motion.speed_mm_s, prepend=0.0) / 0.1
    assert np.abs(motion.speed_mm_s).max() <= vehicle.max_speed_mm_s
    assert np.abs(acceleration).max() <= max(vehicle.acceleration_mm_s2, vehicle.brake_mm_s2) + 1e-6
    moving = np.abs(motion.speed_mm_s[1:]) > 1
    assert (np.abs(np.diff(acceleration))[moving] / 0.1).max() <= vehicle.jerk_mm_s3 + 1e-6


def test_steps_add_up_to_the_position_exactly() -> None:
    """Positions are whole nanometres: no error is carried along."""
    motion = move(VehicleConfig(), [Leg(30_000, 50.0), Leg(0, 60.0), Leg(-5_000, 30.0)], 100, start_nm=7)
    assert 7 + int(motion.distance_nm.sum()) == int(motion.position_nm[-1])
    assert motion.distance_nm.dtype == np.int64


def test_a_service_stops_and_turns() -> None:
    """Among a few seeds there are standstill and both directions."""
    vehicle = VehicleConfig()
    speeds = [move(vehicle, plan(vehicle, 600, np.random.default_rng(seed)), 100).speed_mm_s for seed in range(3)]
    every = np.concatenate(speeds)
    assert (every == 0).any()
    assert (every > 1_000).any()
    assert (every < -1_000).any()


def test_the_same_seed_gives_the_same_motion() -> None:
    """Runs can be repeated from their seed alone."""
    vehicle = VehicleConfig()
    one, two = (move(vehicle, plan(vehicle, 100, np.random.default_rng(5)), 100).position_nm for _ in range(2))
    assert np.array_equal(one, two)


@pytest.mark.parametrize(("km_h", "friction"), [(0, 0.331), (160, 0.198), (300, 0.183)])
def test_adhesion_follows_curtius_kniffler(km_h: int, friction: float) -> None:
    """The published figures, within their three digits."""
    assert adhesion_mm_s2(VehicleConfig(), km_h / 0.0036) / 9_810 == pytest.approx(friction, abs=6e-4)


def test_slippery_rails_lengthen_the_stop() -> None:
    """With a tenth of the adhesion no cycle brakes harder than the rails allow."""
    slippery = VehicleConfig(adhesion_percent=10)
    legs = [Leg(20_000, 150.0), Leg(0, 150.0)]
    acceleration = np.diff(move(slippery, legs, 100).speed_mm_s) / 0.1
    assert np.abs(acceleration).max() <= adhesion_mm_s2(slippery, 0)
    assert np.abs(acceleration).max() < np.abs(np.diff(move(VehicleConfig(), legs, 100).speed_mm_s) / 0.1).max() / 2


def test_every_vehicle_field_has_unit_and_source() -> None:
    """A figure without a source is no figure."""
    for name, field in VehicleConfig.model_fields.items():
        extra = field.json_schema_extra
        assert isinstance(extra, dict), name
        assert extra["unit"], name
        assert str(extra["source"]).startswith(("[S]", "[D]", "[M]")), name


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("length_mm = 1", r"bad\.toml:1: length_mm: Input should be greater than or equal to 1000 \(got 1\)\.$"),
        ("lenght_mm = 9000", r"bad\.toml:1: lenght_mm: Extra inputs are not permitted"),
        ("# a railcar\nlength_mm = 41.7", r"bad\.toml:2: length_mm: Input should be a valid integer \(got 41\.7\)\.$"),
        ("length_mm = nan", r"bad\.toml:1: length_mm: "),
        ("=", r"bad\.toml: not TOML \("),
    ],
)
def test_a_bad_vehicle_file_is_refused(tmp_path: Path, text: str, message: str) -> None:
    """The message names file, line and field."""
    path = tmp_path / "bad.toml"
    path.write_text(text)
    with pytest.raises(InputError, match=message):
        load_vehicle(path)


def test_a_missing_vehicle_file_is_refused(tmp_path: Path) -> None:
    """As an InputError."""
    with pytest.raises(InputError, match=r"none\.toml: no such file\.$"):
        load_vehicle(tmp_path / "none.toml")
