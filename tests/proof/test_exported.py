"""Exported C and FMI units come with the invariants that a restored state must satisfy, if they are proved."""

from __future__ import annotations

import pytest

from safeloc.catalogue import load_target
from safeloc.proof import exported
from safeloc.proof.exported import c_folder
from tests.cli.calling import DOOR


def test_the_invariants_are_proved_first() -> None:
    """And who asked is told so."""
    said: list[str] = []
    files = c_folder(load_target(DOOR), said.append, pytest.fail)
    assert len(said) == exported.PHASES
    assert said[0] == "door: proving the invariants that every state is checked by"
    assert "no step ever leaves the ranges" in files["README.md"]


def test_ranges_that_are_not_proved(monkeypatch: pytest.MonkeyPatch) -> None:
    """The C is made all the same, with a warning."""
    monkeypatch.setattr(exported, "lasting", lambda _system: None)
    said: list[str] = []
    assert "no step ever leaves the ranges" not in c_folder(load_target(DOOR), _unheard, said.append)["README.md"]
    assert ["not every range is proved: check_state checks ranges only, and a step may leave them"] == said


def _unheard(_text: str) -> None: ...
