"""A wrong edit of a term of the area machine is noticed by a proof: claims speak of trains, vehicles and reports."""

from __future__ import annotations

from collections.abc import Callable

import pytest

from safeloc.language.expr import FALSE, TRUE, Bool, Num, as_num, ite, maximum, minimum
from safeloc.language.units import MM
from safeloc.models import area
from safeloc.models.area import AreaConfig, Parts
from safeloc.models.area.slot import ACCEPTED, ENTERS_LOW, Reach, Slot
from safeloc.models.sections import SectionsConfig, compose_machines
from safeloc.properties.sections import properties
from tests.models.edited_terms import edited
from tests.models.inductive import inductive_in

CONFIG = SectionsConfig(area=AreaConfig(trains=2))
HELD, LOOSE = "train 1 containment", "loose vehicles are accounted for"
NARROWS, AGED = "train 1 narrows only by an accepted report", "train 1 report is widened by its age"
LEADS = "train 1 that may be split is believed at its leading end only"


def keeps(claim: str, config: SectionsConfig = CONFIG) -> bool:
    """Whether the composition as it is built now keeps the claim from each step to the next."""
    model = compose_machines(config)
    [prop] = [one for one in properties(model) if one.name == claim]
    return inductive_in(model.composition.system, prop)


def at_rest(slot: Slot) -> tuple[Num, Num]:
    """A train that is not heard of stands."""
    return slot.low, slot.high


def narrows(slot: Slot, *_ends: Num) -> tuple[Num, Num]:
    """Any report that is trusted narrows, also one that is old."""
    low, high = slot.run_on
    told = slot.trusted & slot.rear.present & slot.front.present
    return ite(told, maximum(low, slot.lowest), low), ite(told, minimum(high, slot.highest), high)


def enters_anywhere(slot: Slot, right: tuple[Num, Num], low: Num, high: Num) -> tuple[Num, Num]:
    """A train that enters is taken to be between the ends."""
    return ite(slot.enters, low, right[0]), ite(slot.enters, high, right[1])


def swept(own: Parts, right: tuple[Num, Num]) -> tuple[Num, Num]:
    """A train pushes uncounted vehicles before its front end, as if it reached to there."""
    low, high = right
    for one in own.slots:
        low = ite(one.present & one.below_loose, maximum(low, one.high), low)
    return low, high


def resting(own: Parts) -> tuple[Num, Num]:
    """Uncounted vehicles stand."""
    return own.loose_low, own.loose_high


def believed(slot: Slot, right: Num) -> Num:
    """A report that contradicts the interval is accepted."""
    whole = slot.present & slot.trusted & slot.rear.present & slot.front.present
    return ite(whole, ACCEPTED, right)


def only_low(own: Parts) -> Bool:
    """A train that comes in at the high end is not seen to."""
    seen = [one.event.eq(ENTERS_LOW) | one.accepted for one in own.slots]
    return own.clear & own.healthy & ~(seen[0] | seen[1])


Wrong = Callable[..., object]
OF_A_TRAIN: dict[str, tuple[type, str, Wrong, str]] = {
    "a train not heard of stands": (Slot, "run_on", lambda one, _: at_rest(one), HELD),
    "age is not added": (Reach, "added_error_mm", lambda _r, _, _age: as_num(0, MM), AGED),
    "half of the age is added": (Reach, "added_error_mm", lambda _r, right, _age: right - 22_000, AGED),
    "a part that is lost is forgotten": (Slot, "holds_low", lambda _s, _r: TRUE, LEADS),
    "the other end leads": (Slot, "holds_high", lambda one, _: one.integer | one.downwards, LEADS),
    "an old report narrows": (Slot, "bounds", lambda one, _, *ends: narrows(one, *ends), NARROWS),
    "it enters anywhere": (Slot, "bounds", lambda one, right, *ends: enters_anywhere(one, right, *ends), HELD),
    "every report is believed": (Slot, "verdict", lambda one, right: believed(one, right), HELD),
}
OF_THE_AREA: dict[str, tuple[str, Wrong, str]] = {
    "leaving is believed of a disturbed counter": (
        "_leaves", lambda _own, one: one.present & one.leaves, HELD),
    "a disturbance lets nothing in": ("_uncounted", lambda _own: FALSE, LOOSE),
    "uncounted vehicles stand": ("_swept", resting, LOOSE),
    "a train pushes by its far end": ("_swept", lambda own: swept(own, RIGHT_SWEPT(own)), LOOSE),
    "empty whatever comes in at the high end": ("_empty", only_low, HELD),
    "empty by disturbed counters": ("_empty", lambda own: own.clear, HELD),
}  # fmt: skip
RIGHT_SWEPT = vars(area)["_swept"]


@pytest.mark.thorough(ordinary=3)
@pytest.mark.parametrize("edit", OF_A_TRAIN)
def test_a_wrong_edit_of_a_train_is_noticed(monkeypatch: pytest.MonkeyPatch, edit: str) -> None:
    """The claim that is named is kept by the machines as they are, and not by those that were edited wrongly."""
    owner, name, wrong, claim = OF_A_TRAIN[edit]
    assert keeps(claim)
    edited(monkeypatch, owner, name, wrong)
    assert not keeps(claim)


WORD = "only trusted reports confirm the integrity of train 1"
OF_A_WORD: dict[str, tuple[str, Wrong, str]] = {
    "a word of integrity is believed at the low end": ("holds_low", lambda one, right: right | one.integer, LEADS),
    "and at the high end": ("holds_high", lambda one, right: right | one.integer, LEADS),
    "it confirms the train": ("confirmed", lambda one, _: one.accepted & one.integer, WORD),
}


@pytest.mark.parametrize("edit", OF_A_WORD)
def test_a_word_that_is_not_trusted_is_noticed(monkeypatch: pytest.MonkeyPatch, edit: str) -> None:
    """Where integrity is not trusted, a machine that believes it loses the claim that is named."""
    name, wrong, claim = OF_A_WORD[edit]
    area_config = CONFIG.area.model_copy(update={"integrity_is_trusted": False})
    swept = CONFIG.model_copy(update={"area": area_config})
    assert keeps(claim, swept)
    edited(monkeypatch, Slot, name, wrong)
    assert not keeps(claim, swept)


@pytest.mark.thorough(ordinary=3)
@pytest.mark.parametrize("edit", OF_THE_AREA)
def test_a_wrong_edit_of_the_area_is_noticed(monkeypatch: pytest.MonkeyPatch, edit: str) -> None:
    """The same of what the area judges as a whole."""
    name, wrong, claim = OF_THE_AREA[edit]
    assert keeps(claim)
    monkeypatch.setattr(area, name, wrong)
    assert not keeps(claim)
