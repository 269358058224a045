"""Models by shape: which groups are taken for a model, and why others are not."""

from __future__ import annotations

import itertools
from collections.abc import Sequence

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from safeloc.sensing.range_law import REFERENCE_MM
from safeloc.sensing.signature import MARKS, Doubt, Group, Model, Spots, groups, seen_at
from tests.sensing.scenes import CONFIG

UNIT = CONFIG.reflectors.unit_mm
SECTION = CONFIG.reflectors.section_cdbsm(CONFIG.sensor.carrier_mhz)
Spot = tuple[float, float]


def spots(*every: Spot, left_mm: float = -3_000.0, section: int = SECTION) -> Spots:
    """Echoes (mm ahead, dB against a corner) beside the track, as the range law has them."""
    ordered = sorted(every)
    ahead = np.array([one for one, _ in ordered], dtype=np.float64)
    stronger = np.array([more for _, more in ordered], dtype=np.float64)
    range_mm = np.hypot(ahead, left_mm)
    power = 10 ** ((CONFIG.reference_cdb + section) / 1_000 + stronger / 10) * (REFERENCE_MM / range_mm) ** 4
    return Spots(range_mm, left_mm / range_mm, power)


def corners(model: Model, ahead_mm: float, stronger: Sequence[float] = (0, 0, 0)) -> list[Spot]:
    """The three corners of a reflector."""
    return [(ahead_mm + mark * UNIT, more) for mark, more in zip(MARKS[model], stronger, strict=True)]


def told(found: Spots) -> list[tuple[Model, Doubt | None]]:
    """Model and doubt of every group."""
    return [(group.model, group.doubt) for group in groups(found, CONFIG)]


def differences(marks: Sequence[int]) -> list[int]:
    """Distances between any two marks."""
    return [other - one for one, other in itertools.combinations(marks, 2)]


def test_no_distance_between_corners_occurs_twice() -> None:
    """The marks of all models together have each distance from 1 to 12 once."""
    assert list(range(1, 13)) == sorted(itertools.chain.from_iterable(map(differences, MARKS.values())))


@pytest.mark.parametrize(("one", "other"), list(itertools.combinations(MARKS, 2)), ids=str)
def test_laid_over_each_other_two_models_share_one_corner(one: Model, other: Model) -> None:
    """However they are moved: so two wrong corners are needed to make one of the other."""
    shared = [len({mark + by for mark in MARKS[one]} & set(MARKS[other])) for by in range(-12, 13)]
    assert max(shared) == 1


@pytest.mark.parametrize("model", MARKS)
@given(st.floats(8_000, 140_000), st.floats(-4_000, 4_000))
def test_each_model_is_recognised(model: Model, ahead_mm: float, left_mm: float) -> None:
    """Anywhere in view, on either side."""
    assert [(model, None)] == told(spots(*corners(model, ahead_mm), left_mm=left_mm))


@pytest.mark.parametrize("model", MARKS)
@pytest.mark.parametrize("lost", range(3))
def test_two_corners_are_no_model(model: Model, lost: int) -> None:
    """With any corner missing there is no group at all."""
    left = [spot for index, spot in enumerate(corners(model, 50_000)) if index != lost]
    assert [] == told(spots(*left))


@pytest.mark.parametrize("model", MARKS)
@given(st.integers(0, 2), st.floats(-10_000, 10_000), st.floats(-6, 6))
def test_one_wrong_corner_makes_no_other_model(model: Model, lost: int, place: float, stronger: float) -> None:
    """One corner missing and any one foreign echo of its strength: never another model."""
    kept = [spot for index, spot in enumerate(corners(model, 50_000)) if index != lost]
    found = told(spots(*kept, (50_000 + place, stronger)))
    assert {known for known, doubt in found if doubt is None} <= {model}


@given(st.lists(st.tuples(st.floats(49_000, 60_000), st.floats(-6, 6)), max_size=5))
def test_foreign_echoes_beside_a_reflector_make_no_second_model_of_its_corners(others: list[Spot]) -> None:
    """Whatever stands around: no echo belongs to two groups without doubt."""
    found = groups(spots(*corners(Model.B, 50_000), *others), CONFIG)
    used = [member for group in found if group.doubt is None for member in group.members]
    assert len(used) == len(set(used))


@pytest.mark.parametrize(
    ("doubt", "echoes"),
    [
        (Doubt.BALANCE, corners(Model.A, 50_000, (0, 5, -5))),
        (Doubt.RANGE_LAW, corners(Model.A, 50_000, (7, 7, 7))),
        (Doubt.RANGE_LAW, corners(Model.A, 50_000, (-13, -13, -13))),
        (Doubt.WEAK, corners(Model.A, 140_000, (-16, -16, -16))),
        (Doubt.CROWDED, [*corners(Model.A, 50_000), (50_000 + 5 * UNIT, -6.0)]),
        (None, [*corners(Model.A, 50_000), (50_000 + 5 * UNIT, -9.0)]),
        (None, [*corners(Model.A, 50_000), (50_000 + 14 * UNIT, 0.0)]),
    ],
    ids=["unequal", "too strong", "too weak", "below the minimum", "crowded", "a weak neighbour", "beyond the last"],
)
def test_doubts(doubt: Doubt | None, echoes: list[Spot]) -> None:
    """Each doubt in the smallest case that raises it, and what raises none."""
    assert [(Model.A, doubt)] == told(spots(*echoes))


def test_a_ghost_is_behind_its_original() -> None:
    """The same model once more, farther and weaker than the range law has it: the second is a ghost, the first stands."""
    ghost = corners(Model.C, 65_000, (-9, -9, -9))
    assert [(Model.C, None), (Model.C, Doubt.GHOST)] == told(spots(*corners(Model.C, 50_000), *ghost))


def test_two_reflectors_of_a_model_far_apart_are_two() -> None:
    """Beyond the distance at which equal ones may stand."""
    assert [(Model.C, None)] * 2 == told(spots(*corners(Model.C, 50_000), *corners(Model.C, 75_000)))


def test_a_shared_corner_makes_both_ambiguous() -> None:
    """Two whole groups over one echo: neither is believed."""
    both = {*corners(Model.A, 50_000), *corners(Model.B, 50_000 + 12 * UNIT)}
    assert {(Model.A, Doubt.AMBIGUOUS), (Model.B, Doubt.AMBIGUOUS)} == set(told(spots(*both)))


@pytest.mark.parametrize("model", MARKS)
@pytest.mark.parametrize("ahead_mm", [20_000, 60_000])
def test_the_sum_of_two_ranges_is_a_ghost(model: Model, ahead_mm: int) -> None:
    """To a corner, to the vehicle's front and to a corner again: that keeps the shape, and is never taken for a reflector."""
    marks = MARKS[model]
    sums = sorted({one + other for one in marks for other in marks})
    echoes = [*corners(model, ahead_mm), *((2 * ahead_mm + mark * UNIT, -6.0) for mark in sums)]
    found = told(spots(*echoes, left_mm=0.0))
    assert [(model, None)] == [one for one in found if one[1] is None]
    assert {Doubt.GHOST, Doubt.CROWDED} >= {doubt for _, doubt in found if doubt is not None}
    assert len(found) > 1


@pytest.mark.parametrize("model", MARKS)
@pytest.mark.parametrize("by_corner", range(3))
def test_a_ghost_by_way_of_one_corner_is_told_too(model: Model, by_corner: int) -> None:
    """Where only one corner sends the vehicle's own echo back, the shape stands alone: at twice the range."""
    twice = 2 * 60_000 + MARKS[model][by_corner] * UNIT
    found = told(spots(*corners(model, 60_000), *corners(model, twice, (-6, -6, -6)), left_mm=0.0))
    assert [(model, None), (model, Doubt.GHOST)] == found
    elsewhere = told(spots(*corners(model, 60_000), *corners(model, 100_000, (-6, -6, -6)), left_mm=0.0))
    assert [(model, None), (model, None)] == elsewhere


def test_no_echo_no_group() -> None:
    """An empty frame is a frame."""
    nothing = np.zeros(0)
    assert [] == groups(Spots(nothing, nothing, nothing), CONFIG)


@given(st.floats(5_000, 100_000), st.floats(-0.5, 0.5), st.floats(0, 10_000))
def test_marks_are_seen_where_they_stand(range_mm: float, sine: float, along_mm: float) -> None:
    """Range and sine of a point farther along, by Pythagoras."""
    far, aside = seen_at(np.array([range_mm]), np.array([sine]), along_mm)
    assert float(far[0] * aside[0]) == pytest.approx(range_mm * sine, abs=1e-6)
    ahead = float(far[0]) * (1 - float(aside[0]) ** 2) ** 0.5
    assert ahead - range_mm * (1 - sine**2) ** 0.5 == pytest.approx(along_mm, abs=1e-4)


def test_members_come_nearest_first() -> None:
    """With the marks at which they stand."""
    (group,) = groups(spots(*corners(Model.D, 100_000), left_mm=0.0), CONFIG)
    assert isinstance(group, Group)
    assert (0, 1, 2) == group.members
    assert (0, 2, 8) == group.marks
