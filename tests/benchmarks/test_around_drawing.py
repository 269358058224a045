"""The picture of proofs around a stream is that of the table of its page."""

from __future__ import annotations

from benchmarks.around_drawing import PAGE, PICTURE, Measured, drawn, measured


def test_the_committed_picture_is_the_one_of_the_table() -> None:
    """Drawn anew it is the same, letter for letter; length, width and sources have three sizes each or more."""
    rows = [*measured(PAGE.read_text(encoding="utf-8"))]
    assert Measured(1050, 2, 4, 14) in rows
    for kept in (
        lambda one: (one.sources, one.width_mm) == (2, 2),
        lambda one: (one.sources, one.cycles) == (2, 1050),
        lambda one: (one.width_mm, one.cycles) == (2, 600),
    ):
        assert len([one for one in rows if kept(one)]) >= 3
    assert drawn(rows) == PICTURE.read_text(encoding="utf-8")
