"""Detection inside an area: a wrong edit of what a clear section shows is refused by a proof, whatever the borders report."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from types import ModuleType

import pytest

from safeloc.language.expr import Bool, Expr, Num, Var, ite
from safeloc.models import area, sections
from safeloc.models.area import Area, AreaConfig, slot
from safeloc.models.area.followers import Side
from safeloc.models.area.inner import Inner, covered, lowered, raised
from safeloc.models.sections import Section, SectionsConfig
from tests.models.edited_terms import edited
from tests.models.test_area_edits import HELD, LOOSE, keeps

TRAIN, VEHICLE = (
    "section_1 is never clear with a train in it",
    "section_1 is never clear with a vehicle that was not counted",
)
CONFIGS = {
    borders: SectionsConfig(area=AreaConfig(trains=1, borders=borders, inner_detection=2))  # type: ignore[arg-type]
    for borders in ("counted", "occupancy")
}
Wrong = Callable[..., object]
RIGHT_WIRES = sections.section_wires


def other_clear(area_: Area, one: Section) -> dict[Var, Expr]:
    """A section reads of each detection section whether the other one is clear."""
    first, second = one.inner
    wires = dict(RIGHT_WIRES(area_, one))
    wires[first.clear], wires[second.clear] = wires[second.clear], wires[first.clear]
    return wires


def too_far(place: Num, inner_: Sequence[Inner]) -> Num:
    """A bound that moves up does so one mm beyond the end."""
    right = raised(place, inner_)
    return ite(right.eq(place), place, right + 1)


def too_low(place: Num, inner_: Sequence[Inner]) -> Num:
    """A bound that moves down does so one mm before the start."""
    right = lowered(place, inner_)
    return ite(right.eq(place), place, right - 1)


def touched(start: Num, _end: Num, inner_: Sequence[Inner]) -> Bool:
    """A section that only begins in a clear one is taken to be clear."""
    return covered(start, start, inner_)


OF_A_SECTION: dict[str, tuple[type, str, Wrong, str]] = {
    "a bound moves in a section that is not clear": (
        Inner, "holds", lambda one, _r, place: (one.start <= place) & (place <= one.end), HELD),
    "a bound below the section moves up": (Inner, "holds", lambda one, _r, place: one.clear & (place <= one.end), HELD),
    "a bound above the section moves down": (Inner, "holds", lambda one, _r, place: one.clear & (one.start <= place), HELD),
    "a section covers what is around it": (
        Inner, "covers", lambda one, _r, start, end: one.clear & (start <= one.start) & (one.end <= end), TRAIN),
    "a section covers while it is not clear": (
        Inner, "covers", lambda one, _r, start, end: (one.start <= start) & (end <= one.end), VEHICLE),
}  # fmt: skip
OF_A_TERM: dict[str, tuple[ModuleType, str, Wrong, str]] = {
    "the rear end is a mm beyond the section": (slot, "raised", too_far, HELD),
    "the front end is a mm before the section": (slot, "lowered", too_low, HELD),
    "loose vehicles are a mm beyond the section": (area, "raised", too_far, LOOSE),
    "a section that begins in a clear one is clear": (sections, "covered", touched, TRAIN),
    "the other section is clear": (sections, "section_wires", other_clear, TRAIN),
}


@pytest.mark.thorough(ordinary=1)
@pytest.mark.parametrize("borders", CONFIGS)
@pytest.mark.parametrize("edit", OF_A_SECTION)
def test_a_wrong_edit_of_a_detection_section_is_noticed(
    monkeypatch: pytest.MonkeyPatch, edit: str, borders: str
) -> None:
    """The claim that is named is kept by the machines as they are, and not by those that were edited wrongly."""
    owner, name, wrong, claim = OF_A_SECTION[edit]
    assert keeps(claim, CONFIGS[borders])
    edited(monkeypatch, owner, name, wrong)
    assert not keeps(claim, CONFIGS[borders])


@pytest.mark.thorough(ordinary=2)
@pytest.mark.parametrize("borders", CONFIGS)
@pytest.mark.parametrize("edit", OF_A_TERM)
def test_a_wrong_edit_of_a_bound_is_noticed(monkeypatch: pytest.MonkeyPatch, edit: str, borders: str) -> None:
    """The same of the terms that read the section."""
    owner, name, wrong, claim = OF_A_TERM[edit]
    assert keeps(claim, CONFIGS[borders])
    monkeypatch.setattr(owner, name, wrong)
    assert not keeps(claim, CONFIGS[borders])


def test_followers_that_pass_a_clear_section_are_noticed(monkeypatch: pytest.MonkeyPatch) -> None:
    """A bound that stops before a section that is not clear leaves out a vehicle in it."""

    def stops(side: Side, _right: Num, bound: Num) -> Num:
        for one in side.inner:
            bound = ite((one.start <= bound) & (bound <= one.end), one.start if side.is_low else one.end, bound)
        return bound

    assert keeps(VEHICLE, CONFIGS["occupancy"])
    edited(monkeypatch, Side, "_cut", stops)
    assert not keeps(VEHICLE, CONFIGS["occupancy"])
