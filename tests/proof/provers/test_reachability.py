"""The search for modes and transitions of a machine by itself goes on from the runs that are known."""

from __future__ import annotations

from collections.abc import Container, Sequence
from dataclasses import replace

import pytest

from benchmarks.counted_line import line_target
from safeloc.language.spec import Goal
from safeloc.language.verdict import Proved
from safeloc.proof.provers import reachability
from safeloc.proof.provers.limits import Limits
from safeloc.proof.provers.obligation import Obligation
from safeloc.proof.provers.searches import Runs, first_runs

LOST = "transition counted_line: a section is lost"
LINE = 16
"""State variables: so few that the whole search from the first state finds everything."""


def searched(depth: int, monkeypatch: pytest.MonkeyPatch) -> dict[str, Obligation]:
    """Modes and transitions of a line, where no longer runs than these are searched from the first state, and none is drawn."""

    def short(goals: Sequence[Goal], limits: Limits, known: Container[Goal] = ()) -> Runs:
        return first_runs(goals, replace(limits, depth=min(depth, limits.depth)), known)

    monkeypatch.setattr(reachability, "first_runs", short)
    monkeypatch.setattr(reachability, "drawn", lambda *_: {})
    return {one.name: one for one in reachability.reached(line_target(LINE).system, Limits(depth=25))}


def test_what_is_too_far_for_the_first_search_is_reached_lawfully(monkeypatch: pytest.MonkeyPatch) -> None:
    """Two steps reach the mode in which a section can be lost; it takes some more, from there, until it is."""
    found = searched(2, monkeypatch)
    assert {"witness under the assumption"} == {one.method for one in found.values()}
    lost = found[LOST].verdict
    assert isinstance(lost, Proved)
    assert lost.witness is not None
    assert len(lost.witness.steps) > 2


def test_without_going_on_it_is_not(monkeypatch: pytest.MonkeyPatch) -> None:
    """The search from the first state alone stops before."""
    monkeypatch.setattr(reachability, "_leapt", lambda looked, _: looked)
    assert "while the assumption is kept" in searched(2, monkeypatch)[LOST].method
