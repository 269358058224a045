"""Many localizers at once are what each of them is alone, whatever befalls the others."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from safeloc.language.system import TransitionSystem
from safeloc.models.localizer import LocalizerConfig, compose_machines
from safeloc.models.localizer.simulation.journey import Journey, Vehicles
from safeloc.models.localizer.simulation.journeys import CASES, NOMINAL
from safeloc.models.localizer.simulation.many import ACCELERATION, STANDS, TOP, LocalizerJourneys
from safeloc.models.localizer.simulation.simulate import with_truth
from safeloc.models.localizer.simulation.sources import Fleet
from safeloc.simulation.faults import Fault
from safeloc.simulation.many_runs import Drawn, packed
from safeloc.simulation.motion import Leg
from safeloc.simulation.vehicle_seed import VehicleSeed
from tests.codegen.c_folder import needs_compiler

STANDARD = {TOP: np.ones(4), ACCELERATION: np.ones(4), STANDS: np.zeros(4)}
"""Figures of vehicles that drive as their journey says."""
SHORT = [Leg(0, 2), Leg(20_000, 38)]
WITHOUT_MACHINES = LocalizerConfig(sources=("odometry", "satellite", "fibre"))
"""Sources of which none has a machine that is stepped along."""


@cache
def system(config: LocalizerConfig) -> TransitionSystem:
    """The localizer with its world."""
    return compose_machines(config).composition.system


def differing(config: LocalizerConfig, journeys: Sequence[Journey]) -> list[str]:
    """Inputs of vehicles, simulated at once, in which one of them is not what it is alone; the seeds are those of their places."""
    seeds = list(range(3, 3 + len(journeys)))
    found = Fleet(Vehicles(config, journeys, [VehicleSeed(seed) for seed in seeds]), system(config), None).inputs()
    streams = [with_truth(config, one, seed=seed) for one, seed in zip(journeys, seeds, strict=True)]
    expected = packed(system(config), streams, len(streams[0]))
    assert expected.keys() == found.keys()
    assert len({tuple(column) for column in found["true_cycle_distance_nm"].T}) == len(
        {one.legs[-1] for one in journeys}
    )
    return [name for name, values in found.items() if not np.array_equal(values, expected[name])]


def test_satellites_fibre_and_odometry_of_many() -> None:
    """Signals lost, shifted and few; a fibre in error; a reader that tells the neighbour's marker: each at the vehicle that has it."""
    nominal = replace(NOMINAL["freight"], legs=SHORT, markers=NOMINAL["metro"].markers, satellites=6)
    troubles = (
        [],
        [Fault("satellites lost", "", 120, 160), Fault("fibre error", "", 350, 360), Fault("uplink silent", "", 50, 90)],
        [Fault("multipath", "", 100, 200), Fault("spoofing", "", 150, 170), Fault("fibre miscount")],
        [Fault("odometer slides", "", 200, 260), Fault("downlink silent", "", 10, 20), Fault("marker misplaced", "", 200, 390)],
    )  # fmt: skip
    journeys = [replace(nominal, troubles=own) for own in troubles]
    journeys[2] = replace(journeys[2], satellites=3)
    journeys = [replace(one, legs=[*SHORT[:1], Leg(12_000 - 900 * number, 38)]) for number, one in enumerate(journeys)]
    assert differing(WITHOUT_MACHINES, journeys) == []


@pytest.mark.thorough
@needs_compiler
@pytest.mark.parametrize("name", NOMINAL)
def test_all_sources_of_many(name: str) -> None:
    """As many vehicles as take the machines in C, each with another one of the faults whose outcome is told."""
    config, nominal = LocalizerConfig(), NOMINAL[name]
    of_route = ("other branch taken", "linking not replaced")
    cases = [one.trouble for one in CASES if one.journey == name and one.trouble.kind not in of_route]
    assert len(cases) >= 8
    stop = nominal.legs[-1].seconds
    legs = [[*nominal.legs[:-1], Leg(500 * number, stop)] for number in range(len(cases))]
    assert (
        differing(config, [replace(nominal, troubles=[one], legs=own) for one, own in zip(cases, legs, strict=True)])
        == []
    )


@pytest.mark.thorough
def test_vehicles_on_other_branches_keep_their_places() -> None:
    """Vehicles that go astray, or whose linking is not replaced, are simulated by themselves and put back where they were."""
    config = LocalizerConfig()
    kinds = ("other branch taken", "", "linking not replaced", "")
    faults = [[Fault(kind)] if kind else [] for kind in kinds]
    seeds = [VehicleSeed(9, (number,)) for number in range(4)]
    shares = np.array([1.0, 0.9, 0.8, 0.7])
    drawn = Drawn(4, {**STANDARD, "satellites": np.full(4, 16.0), TOP: shares}, faults, seeds)
    runs = LocalizerJourneys(config, system(config), "freight").runs(drawn, 1_000)
    journey = NOMINAL["freight"]
    journeys = [
        replace(journey, legs=[Leg(0, 2), Leg(round(22_000 * share), 98)], troubles=own)
        for share, own in zip(shares.tolist(), faults, strict=True)
    ]
    alone = [
        Fleet(Vehicles(config, [one], [seed]), system(config), None).inputs()
        for one, seed in zip(journeys, seeds, strict=True)
    ]
    expected = {name: np.concatenate([one[name] for one in alone], axis=1) for name in runs.inputs}
    assert [name for name, values in runs.inputs.items() if not np.array_equal(values, expected[name])] == []
    read = runs.inputs["balise.telegram_group"].max(axis=0)
    assert read[0] > 100
    assert (read[1:] <= 100).all()


def test_a_reading_that_a_fault_does_not_meet_stays_as_it_is() -> None:
    """A marker's fault that is drawn for a time without a reading changes nothing, and the vehicle counts."""
    journey = replace(NOMINAL["main-line"], legs=SHORT, markers=NOMINAL["metro"].markers)
    struck = replace(journey, troubles=[Fault("marker misplaced", "", 0, 3)])
    found = [
        Fleet(Vehicles(WITHOUT_MACHINES, [one], [VehicleSeed(3)]), system(WITHOUT_MACHINES), None).inputs()
        for one in (journey, struck)
    ]
    assert all(np.array_equal(values, found[1][name]) for name, values in found[0].items())
    assert found[0]["odometry.front_marker.present"].any()


def test_a_vehicle_whose_journey_ends_stands_there() -> None:
    """A campaign has one number of cycles, also for the shortest of its journeys."""
    journeys = LocalizerJourneys(WITHOUT_MACHINES, system(WITHOUT_MACHINES), "metro")
    drawn = Drawn(1, {**STANDARD, "satellites": np.zeros(1)}, [[]], [VehicleSeed(1)])
    step = journeys.runs(drawn, 1_000).inputs["true_cycle_distance_nm"]
    assert step.shape == (1_000, 1)
    assert step[300] > 1_000_000
    assert not step[900:].any()


def test_figures_of_the_motion_make_every_vehicle_another_run() -> None:
    """Speed, acceleration and the time for which it stands are drawn for each; the journey's own ones are the defaults."""
    journeys = LocalizerJourneys(WITHOUT_MACHINES, system(WITHOUT_MACHINES), "metro")
    figures = {
        TOP: np.array([1.0, 0.5, 1.0, 1.0]),
        ACCELERATION: np.array([1.0, 1.0, 0.5, 1.0]),
        STANDS: np.array([0, 0, 0, 50.0]),
    }
    drawn = Drawn(
        4, {**figures, "satellites": np.zeros(4)}, [[]] * 4, [VehicleSeed(1, (number,)) for number in range(4)]
    )
    step = journeys.runs(drawn, 400).inputs["true_cycle_distance_nm"]
    assert [1_500, 750, 1_324, 1_500] == [round(most / 1e6) for most in step.max(axis=0).tolist()]
    assert [20, 20, 20, 70] == (step > 0).argmax(axis=0).tolist()
    assert step[60, 2] < step[60, 0]
    assert all(journeys.figures[name].default == (name != STANDS) for name in figures)
