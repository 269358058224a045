"""A report on a map with switches names the edge, or says that it is not known and where the vehicle may be."""

from __future__ import annotations

from safeloc.catalogue import load_target
from safeloc.runtime.embedding.program import Program
from safeloc.runtime.embedding.report import Interval, Track
from tests.models.track_board import Board

PLACE = Interval(1_000, 2_500)


def test_an_edge_is_named_with_its_interval() -> None:
    """In words and as data."""
    track = Track(7, ((7, PLACE),))
    assert track.words(PLACE) == "on edge 7, 1.000 m to 2.500 m"
    assert track.as_data() == {"edge": 7, "possible": [{"edge": 7, "interval_mm": [1_000, 2_500]}]}


def test_an_edge_that_is_not_known_is_never_left_out() -> None:
    """Several are listed; with none it says that nothing is reported."""
    track = Track(None, ((7, PLACE), (9, Interval(0, 500))))
    assert track.words(None) == "edge not known: on edge 7, 1.000 m to 2.500 m or on edge 9, 0.000 m to 0.500 m"
    assert track.as_data()["edge"] is None
    assert Track(None, ()).words(None) == "edge not known: nothing reported"


def test_the_outputs_give_the_track() -> None:
    """Before a switch the edge with the reported interval, over it the three that are possible, each with its own interval."""
    board, program = Board(), Program(load_target("occupied_track"))
    board.start()
    board.at(280_000)
    stem = board.number("301")
    assert program.interval(board.outputs) == Interval(270_000, 290_000)
    assert program.track(board.outputs) == Track(stem, ((stem, Interval(270_000, 290_000)),))
    board.at(295_000)
    told = program.track(board.outputs)
    assert program.interval(board.outputs) is None
    assert told is not None
    assert told.edge is None
    assert dict(told.possible) == {
        stem: Interval(285_000, 300_000),
        **{board.number(edge): Interval(0, 5_000) for edge in ("302-303", "302-304")},
    }
    assert Program(load_target("axle_head")).track({}) is None
