"""Models that the direction hears of the radar's frame: wrong terms are refused by a claim, and the recordings tell each reflector once as it is passed (RFL-D5)."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import cache

import pytest

from safeloc.language.expr import FALSE, TRUE, Bool, all_of
from safeloc.language.trace import Trace
from safeloc.models.reflector.echo import Slot
from safeloc.models.reflector_device import ReflectorDevice, compose_machines
from safeloc.models.reflector_device.met_models import Frame
from safeloc.models.vocabulary.reflectors import MODEL, NO_MODEL
from safeloc.properties.reflector_device.met import properties
from tests.models.composed_devices import Runs, holds
from tests.models.edited_terms import edited

AHEAD = "the direction hears the nearest reflector ahead"
NOTHING_ELSE = "the direction hears nothing else ahead"
PASSED = "a reflector that was near and is seen no more is passed"
NO_OTHER = "no other reflector is passed"
NEAR = "near is what the last frame showed near"
STAYS = "without a frame what was near stays, and turning forgets it"
CLAIMS = (AHEAD, NOTHING_ELSE, PASSED, NO_OTHER, NEAR, STAYS)


def kept(claim: str) -> bool:
    """Whether the device as its terms are now keeps the claim."""
    whole = compose_machines()
    return holds(whole.composition, properties(whole), claim)


def _strong(frame: Frame, one: Slot) -> Bool:
    return one.intensity >= frame.config.reflector.minimum_intensity_cdb


EDITS: Mapping[str, tuple[str, Callable[..., Bool], str]] = {
    "weak echoes are heard": (
        "_shows_reflector", lambda frame, _, one: all_of([frame.present, one.range.present, one.model.ne(NO_MODEL)]), NOTHING_ELSE),
    "echoes without a frame are heard": (
        "_shows_reflector", lambda frame, _, one: all_of([one.range.present, _strong(frame, one), one.model.ne(NO_MODEL)]), NOTHING_ELSE),
    "the first echo is the nearest": ("_is_nearest", lambda frame, _, one: frame._shows_reflector(one), AHEAD),
    "every reflector in view is near": ("_is_near", lambda frame, _, one: frame._shows_reflector(one), NEAR),
    "the passing range is 1 mm less": (
        "_is_near", lambda frame, right, one: right & (one.range.value < frame.config.passing_range_mm), NEAR),
    "a reflector behind a nearer one is passed": (
        "shows_near", lambda frame, _, model: frame.near & frame.model.eq(model), NO_OTHER),
    "a reflector that is still seen is passed": ("shows_near", lambda _frame, _right, _model: FALSE, NO_OTHER),
    "no reflector is ever passed": ("shows_near", lambda _frame, _right, _model: TRUE, PASSED),
}  # fmt: skip
"""Term, wrong term, and the claim that refuses it."""


@pytest.mark.thorough(ordinary=1)
@pytest.mark.parametrize("name", EDITS)
def test_a_wrong_term_is_refused(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """By the claim that is named."""
    term, wrong, claim = EDITS[name]
    edited(monkeypatch, Frame, term, wrong)
    assert not kept(claim)


@pytest.mark.parametrize("claim", CLAIMS)
def test_the_right_terms_keep_it(claim: str) -> None:
    """So that a refusal is due to the edit."""
    assert kept(claim)


RUNS = Runs("reflector_device")


@cache
def passed(name: str) -> list[tuple[int, str]]:
    """The cycles of a recording in which a reflector is passed, with its model."""
    trace: Trace = RUNS.recorded(name)
    label = {one.value: one.label for one in MODEL}
    told = [(n, label[step.outputs["met.passed_model"]]) for n, step in enumerate(trace.steps)]
    return [(n, model) for n, model in told if model != "NONE"]


@pytest.mark.parametrize("name", ["line", "wrong-way"])
def test_each_reflector_is_passed_once(name: str) -> None:
    """A, B, C and D in their order, each within half a second of the cycle in which the front end reaches it."""
    places_mm = {"A": 380_000, "B": 700_000, "C": 1_400_000, "D": 1_480_000}
    found = passed(name)
    assert [model for _, model in found] == list(places_mm)
    for cycle, model in found:
        reached = next(
            n for n, one in enumerate(RUNS.recorded(name).steps) if one.state["truth_nm"] >= places_mm[model] * 10**6
        )
        assert abs(cycle - reached) <= 5


def test_hearing_a_reflector_needs_its_machine() -> None:
    """The machine assumes nothing, and its inputs are those of the reflector machine."""
    whole: ReflectorDevice = compose_machines()
    assert not whole.met.machine.world.laws
    system = whole.composition.system
    assert not {var.name for var in system.inputs if var.name.startswith("met.")}
    assert set(whole.met.machine.inputs) - {whole.met.turned} <= set(whole.source.machine.inputs)
