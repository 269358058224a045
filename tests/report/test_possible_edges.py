"""The edges of a map over time: which were possible, which one was told, and whether it was the true one."""

from __future__ import annotations

from collections.abc import Mapping
from functools import cache

import pytest

from safeloc.language.expr import TRUE, NumVar, number
from safeloc.language.interpret import run
from safeloc.language.machine import Machine, Transition, modes
from safeloc.language.system import TransitionSystem, lower
from safeloc.language.units import COUNT
from safeloc.railway.pictures import PossibleEdges, unreadable
from safeloc.report.possible_edges import possible_edges_picture
from safeloc.report.recorded_run import Broken, RecordedRun
from safeloc.reported import PossibleTrack, Tracks
from tests.report.drawing_reader import across, begin, drawing, end, kinds, words

TRACKS = Tracks("told", "count", tuple(PossibleTrack(f"edge_{n}", "count", "count") for n in (1, 2)))


def names(recording: str) -> Mapping[int, str]:
    """The map of one recording."""
    return {7: "main", 8: "loop"} if recording == "drive" else {}


PICTURE = PossibleEdges("Edges", TRACKS, "true_edge", 1_000, "mode", names)
Row = tuple[int, int, int, int]
"""Told, first and second possible, and true edge; 0 is none."""


@cache
def system() -> TransitionSystem:
    """A machine that tells what it is told."""
    state = [number(name, COUNT, 0, 99) for name in ("edge_1", "edge_2", "true_edge", "edge")]
    given = [number(f"given_{var.name}", COUNT, 0, 99) for var in state]
    (only,) = modes("ONLY")
    sets: dict[NumVar, NumVar] = dict(zip(state, given, strict=True))
    outputs = {"told": state[3], "count": state[3]}
    return lower(
        Machine(
            "map", (only,), given, dict.fromkeys(state, 0), outputs, [Transition("t", only, only, TRUE, sets, rank=0)]
        )
    )


def drive(*rows: Row, truth: int | None = 0, name: str = "drive", broken: tuple[Broken, ...] = ()) -> RecordedRun:
    """A run of a second a row."""
    steps = [
        {"given_edge": told, "given_edge_1": one, "given_edge_2": two, "given_true_edge": true}
        for told, one, two, true in rows
    ]
    return RecordedRun(name, run(system(), steps), (truth,) * len(rows), broken)


OVER_A_SWITCH: tuple[Row, ...] = ((0, 7, 0, 7), (0, 7, 8, 7), (0, 7, 8, 8), (8, 8, 0, 8), (8, 8, 0, 8), (0, 0, 0, 8))


def test_a_possible_and_a_told_edge_have_their_times() -> None:
    """The first edge is possible from 1 s to 3 s, the second from 2 s, and told from 4 s on."""
    of = drawing(possible_edges_picture(PICTURE, drive(*OVER_A_SWITCH)))
    place = across(of)
    possible, (told,) = kinds(of, "possible"), kinds(of, "told")
    assert [(round(place(begin(one))), round(place(end(one)))) for one in possible] == [(1, 3), (2, 4)]
    assert (4, 5) == (round(place(begin(told))), round(place(end(told))))
    assert {"main", "loop"} < set(words(of))


def test_the_true_edge_is_underlined() -> None:
    """Also after everything was given up; never without a recorded truth."""
    of = drawing(possible_edges_picture(PICTURE, drive(*OVER_A_SWITCH)))
    assert len(kinds(of, "true-edge")) == 2
    assert not kinds(drawing(possible_edges_picture(PICTURE, drive(*OVER_A_SWITCH, truth=None))), "true-edge")


def test_a_wrong_edge_stands_out() -> None:
    """An edge is told that is not the true one."""
    text = possible_edges_picture(PICTURE, drive((8, 8, 0, 7), (8, 8, 0, 8)))
    assert "told: NOT the true one" in text
    assert "told: NOT the true one" not in possible_edges_picture(PICTURE, drive((8, 8, 0, 8)))


def test_an_edge_without_a_name_has_its_number() -> None:
    """Of a recording that does not ship."""
    assert "edge 7" in words(drawing(possible_edges_picture(PICTURE, drive((0, 7, 0, 7), name="measured"))))


def test_of_very_many_edges_it_says_how_many_are_left_out() -> None:
    """Nothing is dropped in silence."""
    rows = tuple((0, edge, 0, edge) for edge in range(1, 46))
    assert "5 more edges are not drawn" in words(drawing(possible_edges_picture(PICTURE, drive(*rows))))


def test_a_run_without_any_edge_has_no_picture() -> None:
    """Nor has an empty one."""
    assert not possible_edges_picture(PICTURE, drive((0, 0, 0, 0), truth=None))
    assert not possible_edges_picture(PICTURE, drive())


def test_a_violated_claim_is_marked() -> None:
    """At its step, with its name."""
    text = possible_edges_picture(PICTURE, drive(*OVER_A_SWITCH, broken=(Broken("wrong branch", 3),)))
    assert "violated at step 3: wrong branch" in text


@pytest.mark.parametrize(("field", "wrong"), [("true_edge", "true_edgge"), ("mode", "mood")])
def test_a_name_that_is_not_there_is_refused(field: str, wrong: str) -> None:
    """As for every picture."""
    assert unreadable(PICTURE, system()) == []
    bad = PossibleEdges(**{**PICTURE.__dict__, field: wrong})
    assert unreadable(bad, system()) == [f"no output or state {wrong!r}"]
