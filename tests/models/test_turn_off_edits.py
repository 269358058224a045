"""A wrong edit of the turn-off machine is noticed by a proof."""

from __future__ import annotations

from collections.abc import Callable

import pytest

from safeloc.language.expr import FALSE, TRUE
from safeloc.language.machine import Machine
from safeloc.language.spec import Property
from safeloc.models.turn_off import TurnOff, TurnOffConfig, build, parts
from safeloc.models.turn_off.variables import Parts
from safeloc.properties.turn_off import properties
from tests.models.edited_terms import edited, keeps
from tests.models.inductive import changed

CONFIG = TurnOffConfig()


def made() -> tuple[Machine, list[Property]]:
    """The machine as it is built now, and its claims."""
    model = build(parts(CONFIG))
    return model.machine, properties(model)


Wrong = Callable[..., object]
EDITS: dict[str, tuple[str, Wrong, str]] = {
    "motion of the wrong sign": ("motion", lambda o, _: o.noted_lateral - o.lateral, "course is true"),
    "motion since zero": ("motion", lambda o, _: o.lateral, "course is true"),
    "a switch announced by the near end": (
        "announced",
        lambda o, _: (
            o.switch_position.present
            & o.switch_position.value.ne(o.here)
            & (o.low < o.switch_position.value)
            & ~o.measured
        ),
        "a switch in view is watched",
    ),
    "a switch announced without its reflector": (
        "announced",
        lambda o, _: (
            o.switch_position.present & o.switch_position.value.ne(o.here) & (o.high < o.switch_position.value)
        ),
        "the noted place is from before the switch",
    ),
    "no switch announced": ("announced", lambda _o, _r: FALSE, "a switch in view is watched"),
    "before by the near end": ("before", lambda o, _: o.low < o.here, "watched from the switch on"),
    "through by the far end": (
        "through",
        lambda o, _: o.high >= o.here + CONFIG.decide_mm,
        "straight only beyond the turnout",
    ),
    "through at once": ("through", lambda o, _: o.low >= o.here, "course is true"),
    "never through": ("through", lambda _o, _r: FALSE, "beyond the turnout a measured image decides"),
    "never given up": ("given_up", lambda _o, _r: FALSE, "given up in the end"),
    "always given up": ("given_up", lambda _o, _r: TRUE, "given up only without an image"),
    "given up 100 m late": (
        "given_up",
        lambda o, _: o.low > o.here + CONFIG.give_up_mm + 100_000,
        "given up in the end",
    ),
}


@pytest.mark.parametrize("edit", EDITS)
def test_a_wrong_edit_is_noticed(monkeypatch: pytest.MonkeyPatch, edit: str) -> None:
    """The claim that is named is kept by the machine as it is, and not by the one that was edited wrongly."""
    name, wrong, claim = EDITS[edit]
    assert keeps(made(), claim)
    edited(monkeypatch, Parts, name, wrong)
    assert not keeps(made(), claim)


@pytest.mark.parametrize(
    ("transition", "target", "fields", "claim"),
    [
        ("turns left", 2, {}, "beyond the turnout a measured image decides"),
        ("watch", 2, {"set": {}}, "cycles without a measurement are counted"),
        ("course stays decided", 3, {"set": {}}, "contradiction"),
        ("back before the switch", 0, {"when": FALSE}, "before the switch nothing is stated of it"),
        ("switch in view", 0, {}, "a switch in view is watched"),
    ],
)
def test_a_wrong_row_is_noticed(transition: str, target: int, fields: dict[str, object], claim: str) -> None:
    """A row with another target, without its updates, or that is never taken, breaks the claim."""
    model = build(parts(CONFIG))
    wrong = changed(model.machine, transition, target=model.machine.modes[target], **fields)
    assert keeps((model.machine, properties(model)), claim)
    assert not keeps((wrong, properties(TurnOff(wrong, model.own))), claim)


def test_a_switch_that_stays_watched_is_noticed() -> None:
    """Where another switch is not watched while the first one is, its reflector's place is taken for a motion."""
    model = build(parts(CONFIG))
    idle, _, _, decided, unseen = model.machine.modes
    wrong = changed(model.machine, "switch in view", source=(idle, decided, unseen))
    assert not keeps((wrong, properties(TurnOff(wrong, model.own))), "course is true")
