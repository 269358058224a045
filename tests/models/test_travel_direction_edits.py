"""A wrong edit of the direction machine is noticed by a proof."""

from __future__ import annotations

from collections.abc import Callable

import pytest

from safeloc.language.expr import FALSE, TRUE
from safeloc.language.machine import Machine
from safeloc.language.spec import Property
from safeloc.models.travel_direction import TravelDirection, build, parts
from safeloc.models.travel_direction.variables import Parts
from safeloc.models.vocabulary.reflectors import NO_MODEL
from safeloc.properties.travel_direction import properties
from tests.models.edited_terms import edited, keeps
from tests.models.inductive import changed


def made() -> tuple[Machine, list[Property]]:
    """The machine as it is built now, and its claims."""
    model = build(parts())
    return model.machine, properties(model)


Wrong = Callable[..., object]
EDITS: dict[str, tuple[str, Wrong, str]] = {
    "the model of an older reflector": (
        "latest",
        lambda o, _: o.last_passed_model,
        "the model passed last stays stored",
    ),
    "any balise tells": ("telling", lambda o, _: o.balise_read, "equal models start no decision"),
    "no balise tells": ("telling", lambda _o, _r: FALSE, "a model passed before a balise begins a decision"),
    "equal neighbours tell": (
        "telling",
        lambda o, _: o.balise_read & o.before.ne(NO_MODEL) & o.after.ne(NO_MODEL),
        "equal models start no decision",
    ),
    "any model ahead confirms": (
        "confirmed",
        lambda o, _: ~o.balise_read & o.ahead_model.ne(NO_MODEL),
        "another model ends the decision",
    ),
    "nothing confirms": ("confirmed", lambda _o, _r: FALSE, "the awaited model states the direction"),
    "nothing refutes": ("refuted", lambda _o, _r: FALSE, "another model ends the decision"),
    "no reflector ahead refutes": (
        "refuted",
        lambda o, _: ~o.balise_read & o.ahead_model.ne(o.awaited_model),
        "a decision waits for a reflector",
    ),
    "always confirmed": ("confirmed", lambda _o, _r: TRUE, "direction is true"),
}


@pytest.mark.parametrize("edit", EDITS)
def test_a_wrong_edit_is_noticed(monkeypatch: pytest.MonkeyPatch, edit: str) -> None:
    """The claim that is named is kept by the machine as it is, and not by the one that was edited wrongly."""
    name, wrong, claim = EDITS[edit]
    assert keeps(made(), claim)
    edited(monkeypatch, Parts, name, wrong)
    assert not keeps(made(), claim)


@pytest.mark.parametrize(
    ("transition", "update", "claim"),
    [
        ("fits along", {"awaited_model": "before"}, "a decision begins with the model passed"),
        ("fits against", {"awaited_model": "after"}, "a decision begins with the model passed"),
        ("stay along", {"asked_direction": "asked_direction"}, "another direction than expected contradicts"),
        ("stay half", {"last_passed_model": "passed_model"}, "the model passed last stays stored"),
        ("turned", {"last_passed_model": "passed_model"}, "turning forgets"),
    ],
)
def test_a_wrong_update_is_noticed(transition: str, update: dict[str, str], claim: str) -> None:
    """A row that keeps another variable than it should breaks the claim."""
    model = build(parts())
    own, [row] = model.own, [t for t in model.machine.transitions if t.name == transition]
    given = {**row.set, **{getattr(own, var): getattr(own, value) for var, value in update.items()}}
    wrong = changed(model.machine, transition, set=given)
    assert not keeps((wrong, properties(TravelDirection(wrong, own))), claim)
