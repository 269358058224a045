"""Many vehicles with the reflector machine at once are what each of them is alone."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from safeloc.language.system import lower
from safeloc.models.reflector import machine
from safeloc.models.reflector.simulate import FIGURE_2, Scene, simulate
from safeloc.models.reflector.simulation.draws import OfMany
from safeloc.models.reflector.simulation.many import simulate_many
from safeloc.models.reflector.variables import ReflectorConfig
from safeloc.simulation.faults import Fault
from safeloc.simulation.many_runs import packed
from safeloc.simulation.motion import Leg, VehicleConfig, move
from safeloc.simulation.sensors import measure_many
from tests.codegen.c_folder import needs_compiler

CONFIG = ReflectorConfig()
SCENE = Scene(FIGURE_2, clutter=0.5, pauses=0.1, dropout=0)
MOTION = move(VehicleConfig(), [Leg(20_000, 22), Leg(-5_000, 12)], CONFIG.period_ms)
FAULTS = (
    (), (Fault("pause", "", 60, 80),), (Fault("blind", "", 100, 180),), (Fault("weak", "", 50, 200),),
    (Fault("shift", "", 60, 120, {"by_mm": 20_000}), Fault("shift", "", 0, 200, {"by_mm": 500})),
    (Fault("drift", "", 50, 150, {"by_mm": 3}), Fault("scale", "", 0, None, {"by_ppm": 100})),
    (Fault("decoy", "", 50, 150, {"by_mm": 30_000, "model": "B"}),),
)  # fmt: skip


@pytest.mark.parametrize(
    "number", [3, pytest.param(len(FAULTS) * 2, marks=[pytest.mark.thorough, needs_compiler])], ids=["few", "in C"]
)
def test_many_vehicles_are_simulated_as_each_one_alone(number: int) -> None:
    """Every input in every cycle, with faults of the radar that each has for itself."""
    faults = [FAULTS[(seed + 4) % len(FAULTS)] for seed in range(number)]
    rngs = [np.random.default_rng(seed) for seed in range(number)]
    distances = measure_many(
        "wheel", MOTION.distance_nm[:, None], CONFIG.period_ms, CONFIG.odometer, rngs,
        dropout=[0.02] * number, severity=[0.9] * number, faults=[()] * number,
    )  # fmt: skip
    draws = OfMany([np.random.default_rng(100 + seed) for seed in range(number)])
    found = simulate_many(CONFIG, SCENE, MOTION, distances, faults, draws)
    streams = [
        simulate(
            CONFIG, seed=100 + seed, scene=replace(SCENE, disturbances=own), motion=MOTION, measured=distances.of(seed)
        )
        for seed, own in enumerate(faults)
    ]
    expected = packed(lower(machine(CONFIG)), streams, len(streams[0]))
    assert expected.keys() == found.keys()
    assert [name for name, values in found.items() if not np.array_equal(values, expected[name])] == []
    assert found["echo_2_range_mm.present"].any(axis=0).all()
    assert len({tuple(column) for column in found["echo_1_range_mm"].T}) == number
