"""Many vehicles with the balise machine at once are what each of them is alone."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
import pytest

from safeloc.language.system import lower
from safeloc.models.balise import machine
from safeloc.models.balise.simulate import RouteSet, line, simulate
from safeloc.models.balise.simulation.many import Line, simulate_many
from safeloc.models.balise.simulation.passages import Antenna
from safeloc.models.balise.variables import BaliseConfig
from safeloc.simulation.faults import Fault
from safeloc.simulation.many_runs import Array, packed
from safeloc.simulation.motion import Leg, Motion, VehicleConfig, move
from safeloc.simulation.sensors import measure_many
from tests.codegen.c_folder import needs_compiler

CONFIG = BaliseConfig()
GROUPS = line(40_000, 60_000, 12)
ROUTES = (RouteSet(60, []), RouteSet(75, GROUPS))


@dataclass(frozen=True)
class Vehicle:
    """What differs between the vehicles."""

    seed: int
    motion: Motion
    faults: Sequence[Fault] = ()
    sensor_faults: Sequence[Fault] = ()


def vehicles(number: int) -> list[Vehicle]:
    """Vehicles of several speeds, of which some have faulty groups and some an odometer that slides."""
    found = []
    for seed in range(number):
        motion = move(VehicleConfig(), [Leg(20_000 + 2_000 * (seed % 4), 55)], CONFIG.period_ms)
        faults = [Fault(("duplicate", "late", "stale")[seed % 3], 5)] if seed % 2 else []
        slides = [Fault("slide", "odometer", 50 + seed, 80)] if seed % 3 == 1 else []
        found.append(Vehicle(seed, motion, faults, slides))
    return found


def together(those: Sequence[Vehicle], routes: Sequence[RouteSet] = ()) -> Mapping[str, Array]:
    """The inputs of all of them, simulated at once."""
    rngs = [np.random.default_rng(one.seed) for one in those]
    distances = measure_many(
        "odometer", np.stack([one.motion.distance_nm for one in those], axis=1), CONFIG.period_ms, CONFIG.odometer, rngs,
        dropout=[0.01] * len(those), severity=[0.9] * len(those), faults=[one.sensor_faults for one in those],
    )  # fmt: skip
    antennas = [Antenna(rng, 0.05, 0.02, 0.5, one.faults) for rng, one in zip(rngs, those, strict=True)]
    announced = {0: GROUPS} | {one.cycle: one.groups for one in routes}
    return simulate_many(
        CONFIG, Line(GROUPS, [announced] * len(those), 5_000), [one.motion for one in those], distances, antennas
    ).inputs


def one_by_one(those: Sequence[Vehicle], routes: Sequence[RouteSet] = ()) -> Mapping[str, Array]:
    """The inputs of all of them, simulated by themselves."""
    streams = [
        simulate(
            CONFIG, seed=one.seed, groups=GROUPS, routes=routes, missed=0.05, foreign=0.02, motion=one.motion,
            faults=one.faults, sensor_faults=one.sensor_faults,
        )
        for one in those
    ]  # fmt: skip
    return packed(lower(machine(CONFIG)), streams, len(streams[0]))


@pytest.mark.thorough(ordinary=1)
@pytest.mark.parametrize(
    ("number", "routes"),
    [(3, ()), (3, ROUTES), pytest.param(13, ROUTES, marks=[pytest.mark.thorough, needs_compiler])],
    ids=["few", "routes", "in C"],
)
def test_many_vehicles_are_simulated_as_each_one_alone(number: int, routes: Sequence[RouteSet]) -> None:
    """Every input in every cycle, faults and replaced linking included; no two vehicles are alike."""
    those = vehicles(number)
    expected, found = one_by_one(those, routes), together(those, routes)
    assert expected.keys() == found.keys()
    assert [name for name, values in found.items() if not np.array_equal(values, expected[name])] == []
    assert len({tuple(column) for column in found["odometer_mm"].T}) == number
    assert (found["linking_order.present"].sum(axis=0) >= 3).all()
    assert (found["telegram_group.present"].sum(axis=0) >= 3).all()
