"""Localizers whose sensors are simulated from their physics: alone and among others, within their laws and beyond."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from functools import cache
from statistics import median

import numpy as np
import pytest

from safeloc.campaign.judged import Judge, Outcome, judge_of
from safeloc.models.localizer import LocalizerConfig
from safeloc.models.localizer.simulation.journey import PHYSICS, Journey, Vehicles, speeds_um_s
from safeloc.models.localizer.simulation.journeys import NOMINAL
from safeloc.models.localizer.simulation.reflected import clock_mm, solved
from safeloc.models.localizer.simulation.simulate import FIRST_SPEED, first_but_speed, with_truth
from safeloc.models.localizer.simulation.sources import Fleet
from safeloc.models.localizer.target import target
from safeloc.models.motion.world import CHECK_LAWFUL, LAWFUL, ODOMETER_LAWFUL
from safeloc.simulation.many_runs import packed
from safeloc.simulation.motion import Leg
from safeloc.simulation.vehicle_seed import VehicleSeed
from safeloc.target import Target

CONFIG = LocalizerConfig(sources=("odometry", "satellite"))
JOURNEY = replace(NOMINAL["main-line"], legs=[Leg(0, 2), Leg(25_000, 38), Leg(0, 40)], markers=NOMINAL["metro"].markers)
SHORT = replace(JOURNEY, legs=[Leg(0, 2), Leg(25_000, 24)])
PLAIN: Mapping[str, float] = {}
WITHIN = {
    "adhesion": 0.3, "wheel_scale_ppm": 3_000, "wheel_eccentricity_mm": 2, "map_offset_mm": 300, "map_walk_mm": 100,
    "map_own_share": 0.2, "multipath_mm": 800,
}  # fmt: skip
"""A dry rail, wheels that are little worn, a good map, and reflections that the criterion of selection allows for."""
LEAVES = {**WITHIN, "adhesion": 0.03}
CITY = {**WITHIN, "multipath_mm": 20_000, "multipath_common": 0.9, "multipath_lasts": 300}
CITY_RATES = {**CITY, "multipath_rate": 0.8, "multipath_smooth": 20, "multipath_window": 10}
LATE = {
    "reader_processing_ms": 60, "reader_jitter_ms": 20, "reader_telegrams": 2, "reader_failed": 0.3, "reader_contact_mm": 1_000,
    "front_mounting_mm": 200, "rear_mounting_mm": -200,
}  # fmt: skip
RADARS = {**WITHIN, "speed_radar_noise_mm_s": 50, "speed_radar_mounting_ppm": 5_000}
TILTED = {**RADARS, "speed_radar_mounting_ppm": 100_000}
"""Radars that are mounted a little off their angle, and far off it."""
POOR_MAP = {**WITHIN, "map_offset_mm": -2_500}


@cache
def shown() -> Target:
    """The localizer of these sources."""
    return target(CONFIG)


@cache
def judge() -> Judge:
    """Its judge."""
    return judge_of(shown(), compiled=False)


def vehicles(*physics: Mapping[str, float], journey: Journey = JOURNEY) -> Vehicles:
    """Vehicles with these figures."""
    seeds = [VehicleSeed(3 + number) for number in range(len(physics))]
    return Vehicles(CONFIG, [replace(journey, physics=one) for one in physics], seeds)


def outcome(*physics: Mapping[str, float]) -> Outcome:
    """What becomes of them."""
    those = vehicles(*physics)
    runs = Fleet(those, shown().system, None).runs()
    first = {**first_but_speed(CONFIG, JOURNEY), FIRST_SPEED: speeds_um_s(those.motions)[0], **runs.first}
    return judge().outcome(replace(runs, first=first))


def broken(found: Outcome, vehicle: int) -> list[str]:
    """The clauses that a vehicle breaks."""
    return [name for name, held in zip(judge().clauses, found.held, strict=True) if not held[:, vehicle].all()]


def test_a_vehicle_is_alone_what_it_is_among_others() -> None:
    """Bit by bit, whatever rail, map and sky the others have; also one that errs by the laws alone."""
    physics = (PLAIN, WITHIN, LEAVES, CITY, POOR_MAP, CITY_RATES, LATE, RADARS)
    found = Fleet(vehicles(*physics, journey=SHORT), shown().system, None).inputs()
    streams = [with_truth(CONFIG, replace(SHORT, physics=one), seed=3 + number) for number, one in enumerate(physics)]
    expected = packed(shown().system, streams, len(streams[0]))
    assert expected.keys() == found.keys()
    assert [name for name, values in found.items() if not np.array_equal(values, expected[name])] == []
    assert 8 == len({tuple(column) for column in found["motion.odometer_mm"].T})


@pytest.mark.thorough
def test_each_law_is_broken_by_what_leaves_it() -> None:
    """Within the laws no clause is broken. Leaves break that of the wheel, a city that of the clock, a poor map those of markers.

    Of the two units of motion one is lawful: on leaves it is the check unit, so that no law of `motion` is broken.
    """
    found = outcome(PLAIN, WITHIN, LEAVES, CITY, POOR_MAP)
    wheels = ["odometry: rear_wheel obeys its error law"]
    lawful = (
        Fleet(vehicles(PLAIN, WITHIN, LEAVES, CITY, POOR_MAP), shown().system, None).runs().first["motion.lawful_unit"]
    )
    assert [LAWFUL[one] for one in lawful] == [ODOMETER_LAWFUL] * 2 + [CHECK_LAWFUL] + [ODOMETER_LAWFUL] * 2
    markers = [f"odometry: the map has the {end} reader's marker" for end in ("front", "rear")]
    clock = "position: signals are compared with a prediction and a clock as good as configured"
    assert [[], [], wheels, [clock], markers] == [broken(found, vehicle) for vehicle in range(5)]
    assert found.told.any(axis=0).all()
    assert not (found.told & (found.margin_nm < 0) & ~found.broken).any()


@pytest.mark.thorough
def test_radars_that_are_tilted_alike_break_two_laws() -> None:
    """One unit of odometry may break its law: that is the first radar that does. The other one, mounted alike, breaks a clause; wheels contradict both."""
    found = outcome(RADARS, TILTED)
    of_radars = {f"odometry: {end}_radar obeys its error law" for end in ("front", "rear")}
    within, beyond = (broken(found, vehicle) for vehicle in range(2))
    assert (within, len(beyond), set(beyond) < of_radars) == ([], 1, True)
    assert not (found.told & (found.margin_nm < 0)).any()


def test_figures_are_declared_with_units() -> None:
    """Every figure of rail, wheels, map and sky has its range, unit and meaning, and a default within."""
    assert {"share", "mm", "mm/s", "ppm", "cycles", "ms", "telegrams", "dB", "dB/km"} == {
        one.unit for one in PHYSICS.values()
    }
    assert all(one.low <= one.default <= one.high and one.what for one in PHYSICS.values())


@pytest.mark.parametrize("heard", [[True] * 5, [True, True, False, True, True], [False] * 5, [False] * 4 + [True]])
def test_the_clock_is_the_median_of_what_is_heard(heard: list[bool]) -> None:
    """Rounded down; nothing without a signal."""
    errors = [900, -300, 20_000, 500, 101]
    known = [error for error, one in zip(errors, heard, strict=True) if one]
    expected = int(median(known) // 1) if known else 0
    assert expected == clock_mm(np.array(errors)[:, None, None], np.array(heard)[:, None, None])[0, 0]


def test_a_solution_is_that_of_least_squares() -> None:
    """Place and clock from the signals that are kept, and the sum of the weights as the dilution; none from too few or alike ones."""
    rng = np.random.default_rng(8)
    errors, azimuth = rng.integers(-9_000, 9_000, (6, 4, 1)), rng.random((6, 1)) * 6.28
    kept = np.ones((6, 4, 1), dtype=np.bool_)
    kept[[0, 2], 1], kept[1:, 2], kept[:, 3] = False, False, False
    rates = rng.integers(-900, 900, (6, 4, 1))
    found = solved(errors, rates, kept, azimuth)
    slopes = np.cos(0.5) * np.cos(azimuth[:, 0])
    for cycle in (0, 1):
        used = kept[:, cycle, 0]
        inverse = np.linalg.pinv(np.stack([slopes[used], np.ones(used.sum())], axis=1))[0]
        assert round(float(inverse @ errors[used, cycle, 0])) == found.off_mm[cycle, 0]
        assert round(1_000 * float(inverse @ rates[used, cycle, 0])) == found.faster_um_s[cycle, 0]
        assert 0 <= found.dilution_permille[cycle, 0] - 1_000 * np.abs(inverse).sum() <= 2
    assert [False, False] == found.used[:, 2:, 0].any(axis=0).tolist()
    assert 0 == found.missing[0, 0] != found.missing[2, 0] != found.missing[3, 0]
    same = solved(errors[:3, :1], rates[:3, :1], kept[:3, :1], np.full((3, 1), 0.7))
    assert not same.used.any()
