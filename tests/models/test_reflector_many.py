"""Many vehicles with the reflector machine at once are what each of them is alone."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from numpy.typing import NDArray

from safeloc.models.reflector.simulate import FIGURE_2, Scene
from safeloc.models.reflector.simulation.draws import ByPurpose
from safeloc.models.reflector.simulation.many import simulate_many
from safeloc.models.reflector.simulation.radar import MODELS
from safeloc.models.reflector.simulation.scene import NOWHERE
from safeloc.models.reflector.variables import ReflectorConfig
from safeloc.simulation.faults import Fault
from safeloc.simulation.motion import Leg, Motions, VehicleConfig, move_many
from safeloc.simulation.sensors import measure_many
from safeloc.simulation.vehicle_seed import VehicleSeed
from tests.codegen.c_folder import needs_compiler

CONFIG = ReflectorConfig()
SCENE = Scene(FIGURE_2, clutter=0.5, pauses=0.1, dropout=0)
LEGS = [[Leg(20_000 - 700 * number, 22), Leg(-5_000, 12)] for number in range(14)]
FAULTS = (
    (), (Fault("pause", "", 60, 80),), (Fault("blind", "", 100, 180),), (Fault("weak", "", 50, 200),),
    (Fault("shift", "", 60, 120, {"by_mm": 20_000}), Fault("shift", "", 0, 200, {"by_mm": 500})),
    (Fault("drift", "", 50, 150, {"by_mm": 3}), Fault("scale", "", 0, None, {"by_ppm": 100})),
    (Fault("decoy", "", 50, 150, {"by_mm": 30_000, "model": "B"}),),
)  # fmt: skip


@pytest.mark.thorough(ordinary=1)
@pytest.mark.parametrize(
    "number", [3, pytest.param(len(FAULTS) * 2, marks=[pytest.mark.thorough, needs_compiler])], ids=["few", "in C"]
)
def test_many_vehicles_are_simulated_as_each_one_alone(number: int) -> None:
    """Every input in every cycle, with faults of the radar that each has for itself."""
    faults = [FAULTS[(seed + 4) % len(FAULTS)] for seed in range(number)]
    motions = move_many([VehicleConfig()] * number, LEGS[:number], CONFIG.period_ms)
    distances = measure_many(
        "wheel", motions.distance_nm, CONFIG.period_ms, CONFIG.odometer, [np.random.default_rng(seed) for seed in range(number)],
        dropout=[0.02] * number, severity=[0.9] * number, faults=[()] * number,
    )  # fmt: skip
    seeds = [VehicleSeed(1, (seed,)) for seed in range(number)]
    cycles = len(motions.position_nm)
    found = simulate_many(CONFIG, SCENE, motions, distances, faults, ByPurpose(seeds, cycles))
    for vehicle, seed in enumerate(seeds):
        alone, own = Motions.alone(motions.of(vehicle)), distances.of(vehicle).as_column
        expected = simulate_many(CONFIG, SCENE, alone, own, [faults[vehicle]], ByPurpose([seed], cycles))
        assert expected.keys() == found.keys()
        assert [
            name for name, values in found.items() if not np.array_equal(values[:, vehicle], expected[name][:, 0])
        ] == []
    assert found["echo_2_range_mm.present"].any(axis=0).all()
    assert len({tuple(column) for column in found["echo_1_range_mm"].T}) == number


class _InTurn(ByPurpose):
    """The same numbers, asked for one cycle after the other; of one vehicle, whose balises are not asked for."""

    at_once = False
    cycle = -1

    def shares(self, purpose: str, which: NDArray[np.int64]) -> NDArray[np.float64]:
        """Return the numbers of this cycle."""
        self.cycle += purpose == "pause"
        return super().shares(purpose, which + self.cycle)


def test_frames_of_all_cycles_are_those_of_each_cycle() -> None:
    """What is computed at once is what cycle after cycle gives, with every fault of a radar at some time."""
    config, seed = CONFIG, VehicleSeed(2)
    motions = move_many([VehicleConfig()], LEGS[:1], config.period_ms)
    faults = [[fault for some in FAULTS for fault in some]]
    distances = measure_many(
        "wheel",
        motions.distance_nm,
        config.period_ms,
        config.odometer,
        [seed.rng("wheel")],
        dropout=[0.0],
        severity=[0.9],
        faults=[()],
    )
    scene = Scene(replace(FIGURE_2, balises=()), clutter=0.5, pauses=0.1, dropout=0)
    cycles = len(motions.position_nm)
    found, expected = (
        simulate_many(config, scene, motions, distances, faults, draws)
        for draws in (ByPurpose([seed], cycles), _InTurn([seed], cycles))
    )
    assert [name for name, values in expected.items() if not np.array_equal(values, found[name])] == []
    assert (found["echo_1_true_model"] != MODELS.index(NOWHERE)).any() and not found["frame_present"].all()
