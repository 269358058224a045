"""Localizers whose reflectors, sections and fibre are not as map and laws have them; and whose range rates are reflected."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from safeloc.campaign.judged import Judge, Outcome, judge_of
from safeloc.models.localizer import LocalizerConfig
from safeloc.models.localizer.simulation.front_ends import satellite
from safeloc.models.localizer.simulation.journey import Stretch, Vehicles
from safeloc.models.localizer.simulation.journeys import NOMINAL
from safeloc.models.localizer.simulation.off_the_map import misplaced
from safeloc.models.localizer.simulation.reflected import covariance
from safeloc.models.localizer.simulation.simulate import first_but_speed, with_truth
from safeloc.models.localizer.simulation.sources import Fleet
from safeloc.models.localizer.target import target
from safeloc.models.reflector.simulate import Balise, Reflector, Route
from safeloc.simulation.many_runs import ManyRuns, packed
from safeloc.simulation.motion import Leg
from safeloc.simulation.vehicle_seed import VehicleSeed
from safeloc.target import Target

CONFIG = LocalizerConfig(sources=("reflector", "fibre"))
JOURNEY = replace(
    NOMINAL["metro"], legs=[Leg(0, 1), Leg(15_000, 27)], fibre=Stretch(40_000, 240_000), axles=8, length_mm=120_000,
    reflectors=Route((Balise(1, 30_000),), (Reflector(90_000, "A", 40_000), Reflector(190_000, "B", 60_000))),
)  # fmt: skip
PLAIN: Mapping[str, float] = {}
TOGETHER = {"map_offset_mm": 700, "reflector_map_common": 1}
APART = {"reflector_map_own_mm": 3_000}
SECTIONS = {"section_map_own_mm": 12_000}
LOOSE = {
    "fibre_level_db": 1,
    "fibre_loose_db": 12,
    "fibre_loose_share": 0.3,
    "fibre_coupling_db": 4,
    "fibre_coupling_mm": 20_000,
}
SURVEY = "reflector: a reflector stands where the map has it"
PLACE = "verification: a located interval holds the front"
FEATURES = {
    "verification: the fibre's count is the train's",
    "verification: the fibre's length is the train's within its tolerance",
}


@cache
def shown() -> Target:
    """The localizer of these sources."""
    return target(CONFIG)


@cache
def judge() -> Judge:
    """Its judge."""
    return judge_of(shown(), compiled=False)


def vehicles(*physics: Mapping[str, float]) -> Vehicles:
    """Vehicles with these figures."""
    seeds = [VehicleSeed(3 + number) for number in range(len(physics))]
    return Vehicles(CONFIG, [replace(JOURNEY, physics=one) for one in physics], seeds)


@cache
def found() -> tuple[ManyRuns, Outcome]:
    """What becomes of one vehicle with each."""
    runs = Fleet(vehicles(PLAIN, TOGETHER, APART, SECTIONS, LOOSE), shown().system, None).runs()
    return runs, judge().outcome(replace(runs, first={**first_but_speed(CONFIG, JOURNEY), **runs.first}))


def broken(vehicle: int) -> set[str]:
    """The clauses that a vehicle breaks."""
    return {name for name, held in zip(judge().clauses, found()[1].held, strict=True) if not held[:, vehicle].all()}


@pytest.mark.thorough
def test_each_error_breaks_its_own_law() -> None:
    """What errs with the balises only shifts all; reflectors apart, sections and a loose fibre break the laws of survey, place and features."""
    assert [set(), set(), {SURVEY}, {PLACE}] == [broken(vehicle) for vehicle in range(4)]
    assert FEATURES <= broken(4) <= FEATURES | {PLACE}
    one = found()[1]
    wrong, others = (
        one.told & (one.margin_nm < 0),
        [n for n, name in enumerate(judge().clauses) if name not in FEATURES],
    )
    assert not (wrong & ~one.broken).any()
    beyond = np.logical_or.accumulate(~one.held[others].all(axis=0), axis=0)
    assert not (wrong & ~beyond).any()  # the axles are facts here, and choices of the world in the proofs


@pytest.mark.thorough
def test_the_radars_error_explains_what_it_can() -> None:
    """It begins with the first reflector's error; where both reflectors contradict each other, an origin leaves the accuracy of the survey."""
    inputs = found()[0].inputs
    real = inputs["reflector.echo_1_true_model"] != 0
    off = inputs["reflector.echo_1_origin_nm"] - inputs["reflector.echo_1_map_place_mm"] * 1_000_000
    survey, drift = CONFIG.reflector.map_accuracy_mm * 1_000_000, CONFIG.reflector.radar_drift_mm_s * 100_000
    assert real[:, 2].any() and not off[:, 0][real[:, 0]].any()
    assert np.abs(off[:, 1][real[:, 1]]).max() <= survey < np.abs(off[:, 2][real[:, 2]]).max()
    bias = inputs["reflector.next_radar_bias_nm"]
    assert not bias[:, 0].any() and 100_000_000 < np.abs(bias[0, 2])
    assert np.abs(np.diff(bias, axis=0)).max() <= drift
    assert bias[0, 2] == np.asarray(found()[0].first["reflector.radar_bias_nm"])[2]


@pytest.mark.thorough
def test_a_loose_fibre_misses_axles_and_puts_the_front_too_far_back() -> None:
    """Never too many axles; the front lies behind by what is missed, the train is shorter; without any axle nothing is told."""
    inputs = found()[0].inputs
    axles, there = inputs["verification.fibre_axles"], inputs["verification.fibre_axles.present"]
    assert {8} == set(axles[:, 3][there[:, 3]].tolist())
    assert set(axles[:, 4][there[:, 4]].tolist()) <= set(range(1, 9)) and 8 > axles[:, 4][there[:, 4]].min()
    assert 0 < there[:, 4].sum() <= there[:, 3].sum()
    both = there[:, 3] & there[:, 4]
    for name in ("position", "length"):
        told = inputs[f"verification.fibre_{name}_mm"]
        assert 0 > np.mean(told[:, 4][both] - found()[0].inputs[f"verification.fibre_{name}_mm"][:, 0][both])


@pytest.mark.thorough
def test_a_vehicle_is_alone_what_it_is_among_others() -> None:
    """Bit by bit, also in what its map and fibre are."""
    physics = (PLAIN, TOGETHER, APART, SECTIONS, LOOSE)
    streams = [with_truth(CONFIG, replace(JOURNEY, physics=one), seed=3 + number) for number, one in enumerate(physics)]
    expected, inputs = packed(shown().system, streams, len(streams[0])), found()[0].inputs
    assert [name for name, values in inputs.items() if not np.array_equal(values, expected[name])] == []


def test_a_balise_of_the_radar_is_read_late_or_not_at_all() -> None:
    """Farther on by speed x latency, sooner by what the antenna is ahead; beyond every line if there is no time to read it."""
    late, ahead = {"reader_processing_ms": 20}, {"antenna_mounting_mm": 150}
    fast = {"reader_telegrams": 5, "reader_contact_mm": 10}
    of_it = (Balise(1, 90_000),)
    made = misplaced(vehicles(PLAIN, late, {**late, **ahead}, ahead, fast), of_it)
    assert made is not None and not made.errs.any()
    (beside,) = made.balises.values()
    plain, shifted, both, sooner, never = beside.tolist()
    assert 0 == plain and 0 < shifted < 15_000 * 0.02
    assert -150 == pytest.approx(sooner) and shifted - 150 == pytest.approx(both, abs=5)
    assert never > JOURNEY.length_mm * 1_000


def test_covariances_are_those_of_the_last_cycles_that_were_heard() -> None:
    """Rounded down, of at least two differences."""
    off, heard = np.array([[3], [9], [100], [5], [1]])[None], np.array([[1], [1], [0], [1], [1]], dtype=np.bool_)[None]
    expected = [0, 9, 9, 4, 4]
    assert expected == covariance(off, heard, np.array([3]))[0, :, 0].tolist()
    whole = covariance(off, heard, np.array([99]))[0, :, 0]
    assert (9 + 81 + 25 + 1) // 4 - (18 // 4) ** 2 == whole[-1]


SKY = LocalizerConfig(sources=("odometry", "satellite"))
CITY = {"multipath_mm": 20_000, "multipath_common": 0.5, "multipath_lasts": 100, "multipath_smooth": 30}


def columns(**more: float) -> Mapping[str, np.ndarray]:
    """Columns of the front ends of one vehicle that runs for 20 s between houses."""
    journey = replace(NOMINAL["main-line"], legs=[Leg(0, 2), Leg(25_000, 18)], satellites=8, physics={**CITY, **more})
    made = satellite(Vehicles(SKY, [journey], [VehicleSeed(8)]))
    return {name: np.broadcast_to(one.values, (200, 1))[:, 0] for name, one in made.items()}


def test_range_and_range_rate_are_disturbed_alike() -> None:
    """The error of a rate is the change of that of the range, but for the noise of both; by default the rates stay as they were."""
    plain, moving = columns(), columns(multipath_rate=1)
    noise = SKY.satellite.selection.range_noise_mm
    for number in range(1, 9):
        name = f"selection.channel_{number}"
        assert np.array_equal(plain[f"{name}_error_mm"], moving[f"{name}_error_mm"])
        rate = moving[f"{name}_speed_error_mm_s"] - plain[f"{name}_speed_error_mm_s"]
        gained = np.cumsum(rate[1:]) / 10
        ranges = moving[f"{name}_error_mm"]
        assert np.abs(ranges[1:] - ranges[0] - gained).max() < 3 * noise
        assert np.abs(rate).max() > 1_000
    assert not plain["selection.clock_mm_s"].any() and moving["selection.clock_mm_s"].any()
    offs = [moving[f"selection.channel_{n}_speed_off_mm_s"] + moving["selection.clock_mm_s"] for n in range(1, 9)]
    assert all(np.array_equal(off, moving[f"selection.channel_{n}_speed_error_mm_s"]) for n, off in enumerate(offs, 1))


def test_covariances_show_reflections_where_there_is_a_window() -> None:
    """And then signals are excluded by them, which the solution leaves out."""
    plain, shown_ = columns(multipath_rate=1), columns(multipath_rate=1, multipath_window=10)
    most = SKY.satellite.selection.speed_covariance_mm2_s2
    names = [f"selection.channel_{number}_speed_covariance_mm2_s2" for number in range(1, 9)]
    assert {most // 4} == {int(value) for name in names for value in plain[name]}
    beyond = np.stack([shown_[name] >= most for name in names])
    used = np.stack([shown_[f"position.used_{number}"] for number in range(1, 9)])
    assert beyond.any() and used.any() and not (used & beyond).any()
