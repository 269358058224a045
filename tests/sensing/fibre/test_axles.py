"""Clusters of axles counted in a train's profile."""

from __future__ import annotations

import numpy as np
import pytest

from safeloc.sensing.fibre.axles import Count, Counter, clusters
from safeloc.sensing.fibre.figures import Counting, FibreConfig, Interrogator

CONFIG = FibreConfig(interrogator=Interrogator(fibre_mm=6_000_000))


def profile(
    places_m: list[float], width_m: float = 6, length: int = 300
) -> np.ndarray[tuple[int], np.dtype[np.float64]]:
    """Bumps at these places, every metre."""
    bins = np.arange(length)
    return np.asarray(sum(np.exp(-(((bins - place) / width_m) ** 2)) for place in places_m), dtype=np.float64)


@pytest.mark.parametrize("count", [2, 5, 9])
def test_bumps_are_counted(count: int) -> None:
    """26 m apart, as the joints of coaches."""
    assert count == clusters(profile([30 + 26 * number for number in range(count)]), CONFIG)


def test_what_melts_together_is_one_cluster() -> None:
    """Bogies 7 m apart; a ripple is none."""
    assert 2 == clusters(profile([50, 57, 120, 127]) + 0.02 * np.sin(np.arange(300)), CONFIG)


def counts(
    config: FibreConfig, speed_m_s: float, joints: int, run_m: float, wavering_m: float = 0
) -> list[Count | None]:
    """The different counts, in order, while a train with joints 26 m apart runs so far; its measured length wavers with the run."""
    counter = Counter(config)
    centre = (np.arange(config.interrogator.channels) * 10_000 + config.interrogator.span_mm / 2) / 1_000
    length = 26.0 * (joints - 1)
    begin = middle = 500.0 if speed_m_s > 0 else 5_000.0
    found: list[Count | None] = [None]
    for window in range(round(run_m / abs(speed_m_s) / 0.05)):
        middle += speed_m_s * 0.05
        offsets = [middle - length / 2 + 26 * joint for joint in range(joints)]
        energy = 1 + 100 * sum(np.exp(-(((centre - place) / 6) ** 2)) for place in offsets)
        measured = length + wavering_m * np.sin((middle - begin) / 40)
        counter.follow(
            window * 50.0, middle * 1_000, measured * 1_000, speed_m_s * 1_000, np.asarray(energy, dtype=np.float32)
        )
        found += [counter.count] if counter.count != found[-1] else []
    return found


def counted(config: FibreConfig, speed_m_s: float, joints: int, run_m: float) -> Count | None:
    """After a train with joints 26 m apart ran so far."""
    return counts(config, speed_m_s, joints, run_m)[-1]


@pytest.mark.parametrize("speed", [-40.0, 12.0, 40.0])
def test_a_moving_train_is_counted(speed: float) -> None:
    """Confidently after three profiles, in both directions."""
    assert Count(6, None, True) == counted(CONFIG, speed, 6, 1_500)


@pytest.mark.thorough(ordinary=4)
@pytest.mark.parametrize("speed", [-40.0, 12.0, 40.0])
@pytest.mark.parametrize("wavering_m", [10, 20, 30])
@pytest.mark.parametrize("joints", [4, 6])
def test_a_measured_length_that_wavers_shifts_no_channel(speed: float, wavering_m: float, joints: int) -> None:
    """The energy of all channels is added about the train's middle, so no profile has another count."""
    found = counts(CONFIG, speed, joints, 1_500, wavering_m)
    assert [None, Count(joints, None, False), Count(joints, None, True)] == found


def test_one_profile_is_no_agreement() -> None:
    """The count is there, not to be relied on."""
    assert Count(6, None, False) == counted(CONFIG, 40.0, 6, 700)


def test_no_run_no_count() -> None:
    """Neither too short, nor too slow."""
    assert counted(CONFIG, 40.0, 6, 300) is None
    assert counted(CONFIG, 2.0, 6, 100) is None


def test_axles_follow_from_the_kind_of_vehicle() -> None:
    """Five coaches of four axles have six clusters."""
    coaches = CONFIG.model_copy(update={"counting": Counting(axles_per_vehicle=4)})
    assert Count(6, 20, True) == counted(coaches, 40.0, 6, 1_500)


def test_turning_back_starts_the_profile_again() -> None:
    """A course that comes back is no course past a channel."""
    counter = Counter(CONFIG)
    still = np.ones(CONFIG.interrogator.channels, dtype=np.float32)
    for window, middle in enumerate([*range(1_000, 1_400, 2), *range(1_400, 1_000, -2)]):
        speed = 40_000 if window < 200 else -40_000
        counter.follow(window * 50.0, middle * 1_000.0, 100_000, speed, still)
    assert counter.count is None


def told_after_a_loss(legs: list[tuple[float, float]], lost_m: float) -> list[float]:
    """Run since the last coach came off (after so much run, in m), wherever a count of all six clusters is told.

    legs  speed in m/s, and for how many seconds
    """
    counter, middle, ran, time_s, found = Counter(CONFIG), 600.0, 0.0, 0.0, list[float]()
    centre = (np.arange(CONFIG.interrogator.channels) * 10_000 + CONFIG.interrogator.span_mm / 2) / 1_000
    for speed, seconds in legs:
        for _ in range(round(seconds / 0.05)):
            time_s, middle, ran = time_s + 0.05, middle + speed * 0.05, ran + abs(speed) * 0.05
            behind, length = (0 if ran < lost_m else 1), 130.0 - (0 if ran < lost_m else 26)
            places = [middle + (13 if behind else 0) - length / 2 + 26 * joint for joint in range(6 - behind)]
            energy = 1 + 100 * sum(np.exp(-(((centre - place) / 6) ** 2)) for place in places)
            seen = (places[0] + places[-1]) / 2
            counter.follow(time_s * 1_000, seen * 1_000, length * 1_000, speed * 1_000, np.asarray(energy, np.float32))
            if ran > lost_m and counter.count is not None and counter.count.clusters == 6:
                found.append(ran - lost_m)
    return found


RUN_ON, IN_STARTS, TO_AND_FRO = (
    [(40.0, 75.0)],
    [(40.0, 35.0), *[(0.0, 60.0), (20.0, 10.0)] * 8],
    [(40.0, 35.0), *[(-20.0, 10.0), (20.0, 10.0)] * 5],
)


@pytest.mark.thorough(ordinary=2)
@pytest.mark.parametrize("legs", [RUN_ON, IN_STARTS, TO_AND_FRO], ids=["runs on", "stops and starts", "to and fro"])
@pytest.mark.parametrize("lost_m", [1_001.0, 1_100.0, 1_250.0])
def test_a_count_is_not_told_for_longer_than_its_run(legs: list[tuple[float, float]], lost_m: float) -> None:
    """A coach that was lost is counted for some run, never for more than the figure, whenever it is lost and however it runs."""
    told = told_after_a_loss(legs, lost_m)
    assert told
    assert CONFIG.counting.count_valid_run_mm / 1_000 >= max(told)
