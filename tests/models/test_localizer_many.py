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
from safeloc.models.localizer.simulation.many import LocalizerJourneys
from safeloc.models.localizer.simulation.simulate import with_truth
from safeloc.models.localizer.simulation.sources import Fleet
from safeloc.simulation.faults import Fault
from safeloc.simulation.many_runs import Drawn, packed
from safeloc.simulation.motion import Leg
from tests.codegen.c_folder import needs_compiler

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
    found = Fleet(Vehicles(config, journeys, seeds), system(config), None).inputs()
    streams = [with_truth(config, one, seed=seed) for one, seed in zip(journeys, seeds, strict=True)]
    expected = packed(system(config), streams, len(streams[0]))
    assert expected.keys() == found.keys()
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
    assert differing(config, [replace(nominal, troubles=[one]) for one in cases]) == []


@pytest.mark.thorough
def test_vehicles_on_other_branches_keep_their_places() -> None:
    """Vehicles that go astray, or whose linking is not replaced, are simulated by themselves and put back where they were."""
    config = LocalizerConfig()
    kinds = ("other branch taken", "", "linking not replaced", "")
    faults = [[Fault(kind)] if kind else [] for kind in kinds]
    drawn = Drawn(4, {"satellites": np.full(4, 16.0)}, faults)
    runs = LocalizerJourneys(config, system(config), "freight").runs(drawn, 1_000, np.random.default_rng(1))
    seeds = np.random.default_rng(1).integers(0, 2**31, 4).tolist()
    journey = replace(NOMINAL["freight"], legs=[Leg(0, 2), Leg(22_000, 98)])
    streams = [
        with_truth(config, replace(journey, troubles=own), seed=seed) for own, seed in zip(faults, seeds, strict=True)
    ]
    expected = packed(system(config), streams, 1_000)
    assert [name for name, values in runs.inputs.items() if not np.array_equal(values, expected[name])] == []
    read = runs.inputs["balise.telegram_group"].max(axis=0)
    assert read[0] > 100
    assert (read[1:] <= 100).all()


def test_a_reading_that_a_fault_does_not_meet_stays_as_it_is() -> None:
    """A marker's fault that is drawn for a time without a reading changes nothing, and the vehicle counts."""
    journey = replace(NOMINAL["main-line"], legs=SHORT, markers=NOMINAL["metro"].markers)
    struck = replace(journey, troubles=[Fault("marker misplaced", "", 0, 3)])
    found = [
        Fleet(Vehicles(WITHOUT_MACHINES, [one], [3]), system(WITHOUT_MACHINES), None).inputs()
        for one in (journey, struck)
    ]
    assert all(np.array_equal(values, found[1][name]) for name, values in found[0].items())
    assert found[0]["odometry.front_marker.present"].any()


def test_a_vehicle_whose_journey_ends_stands_there() -> None:
    """A campaign has one number of cycles, also for the shortest of its journeys."""
    journeys = LocalizerJourneys(WITHOUT_MACHINES, system(WITHOUT_MACHINES), "metro")
    drawn = Drawn(1, {"satellites": np.zeros(1)}, [[]])
    step = journeys.runs(drawn, 1_000, np.random.default_rng(1)).inputs["true_cycle_distance_nm"]
    assert step.shape == (1_000, 1)
    assert step[300] > 1_000_000
    assert not step[900:].any()
