"""Ghosts of late readings: they keep the laws of reader, map and vehicle exactly where some choice does."""

from __future__ import annotations

from itertools import product

from hypothesis import given
from hypothesis import strategies as st

from safeloc.models.balise.simulation.late_group import LateGroup
from safeloc.models.balise.variables import BaliseConfig
from safeloc.models.odometry.late_marker import late_marker, off_nm
from safeloc.models.odometry.variables import OdometryConfig
from safeloc.simulation.sensors import Reading

MM = 1_000_000
CONFIG = OdometryConfig(vehicle_length_mm=100_000, vehicle_length_tolerance_mm=2)
RAN_NM, NOW_NM = 2_000 * MM, 50_000 * MM
GROUPS = BaliseConfig()


def kept(reading: Reading, spot_nm: int, length_nm: int) -> bool:
    """Whether the three laws are kept."""
    assert reading.place_mm is not None
    least, most = off_nm(CONFIG, reading.since_mm, RAN_NM)
    off = NOW_NM - spot_nm - length_nm - reading.since_mm * MM
    near = abs(spot_nm - reading.place_mm * MM) <= reading.accuracy_mm * MM
    return least <= off <= most and near and (not reading.end or abs(length_nm - 100_000 * MM) <= 2 * MM)


@given(st.integers(0, 1), st.integers(-3, 3), st.integers(0, 3), st.integers(-240, 40), st.integers(-4, 4))
def test_a_reading_keeps_its_laws_where_some_choice_does(
    end: int, beside: int, accuracy: int, late: int, mounting: int
) -> None:
    """As trying every whole mm finds it; the run in the latency may be 240 mm."""
    length_mm = 100_000 if end else 0
    spot_mm, since_mm = 49_000 - length_mm, 1_000 + late
    reading = Reading(3, end, 5, spot_mm + beside, accuracy, since_mm, spot_mm * MM)
    found = late_marker(CONFIG, reading, NOW_NM, RAN_NM, mounting)
    name = ("front_marker", "rear_marker")[end]
    length_nm = int(found.get("true_length_nm", 0))
    spots = range(spot_mm + beside - accuracy, spot_mm + beside + accuracy + 1)
    lengths = range(length_mm - 2, length_mm + 3) if end else range(1)
    possible = any(kept(reading, spot * MM, length * MM) for spot, length in product(spots, lengths))
    assert possible <= kept(reading, int(found[f"{name}_spot_nm"]), length_nm)
    assert found[f"{name}_stray"] is False
    if not possible and not kept(reading, int(found[f"{name}_spot_nm"]), length_nm):
        assert spot_mm * MM == found[f"{name}_spot_nm"]


def test_the_run_in_the_latency_is_allowed_and_no_more() -> None:
    """12 ms of 100 ms: 240 of 2 000 mm, and what a change of speed adds; forwards only, but for the rate of what was counted."""
    least, most = off_nm(CONFIG, 0, RAN_NM)
    unsteady = CONFIG.max_acceleration_mm_s2 * 100 * 12 // 2
    assert (-unsteady, 240 * MM + unsteady) == (least, most)
    rate = max(CONFIG.first_unit.rate_ppm, CONFIG.second_unit.rate_ppm)
    assert (least - 500 * rate, most + 500 * rate) == off_nm(CONFIG, 500, RAN_NM)


def test_a_marker_far_off_stays_where_it_is() -> None:
    """A misplaced reading is stray, whatever the latency."""
    reading = Reading(3, 0, 5, 900_000, 1_000, 1_000, 49_000 * MM)
    assert {"front_marker_spot_nm": 49_000 * MM, "front_marker_stray": True} == late_marker(
        CONFIG, reading, NOW_NM, RAN_NM, 0
    )


def group(late_mm: int, *, counted: bool, accuracy_mm: int = 0) -> tuple[dict[str, int], int]:
    """The ghosts of a group that was passed 1 m before the end of the cycle and stamped later, and how far off the antenna then was, nm."""
    since_mm = 1_000 - late_mm
    spot_nm = NOW_NM - (1_000 + GROUPS.antenna_mm) * MM
    read = LateGroup(GROUPS, NOW_NM, RAN_NM, 0, 40, since_mm if counted else None)
    found = {name: int(value) for name, value in read.ghosts(1_000 * MM, spot_nm, spot_nm, accuracy_mm * MM).items()}
    return found, NOW_NM - found["true_since_nm"] - GROUPS.antenna_mm * MM - found["read_place_nm"]


def test_a_group_in_time_keeps_its_true_ghosts() -> None:
    """Counted or not."""
    for counted in (True, False):
        found, off = group(0, counted=counted)
        assert (1_000 * MM, 0, 0) == (found["true_since_nm"], found["reading_wander_nm"], off)


def test_latency_is_explained_by_wander_then_detection_then_the_map() -> None:
    """The counter's wander bridges half the constant, the antenna its detection accuracy, the map its own; farther off, the antenna was not there."""
    half, detection = GROUPS.odometer.wander_nm, GROUPS.detection_mm * MM
    late = half // MM
    found, off = group(late, counted=True)
    assert (1_000 * MM, half, 0) == (found["true_since_nm"], abs(found["reading_wander_nm"]), off)
    _, off = group(late + GROUPS.detection_mm // 2, counted=True)
    assert 0 < abs(off) <= detection
    far = late + 2 * GROUPS.detection_mm + 100
    _, off = group(far, counted=True)
    assert abs(off) > detection
    found, off = group(far, counted=True, accuracy_mm=3 * GROUPS.detection_mm)
    assert abs(off) <= detection


def test_an_uncounted_run_is_within_its_age() -> None:
    """A reading of this cycle ran no farther than the cycle, and never against it."""
    ghosts = LateGroup(GROUPS, NOW_NM, RAN_NM, 0, 100, None).ghosts(9_000 * MM, 0, NOW_NM, 0)
    assert RAN_NM <= int(ghosts["true_since_nm"]) <= RAN_NM + GROUPS.measuring_step_mm * MM
