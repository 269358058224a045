"""Announced groups refused in a row: when they end the position, and what begins the count anew."""

from __future__ import annotations

import pytest

from safeloc.models.balise.groups import Group, announcement, telegram
from safeloc.runtime.streams.steps import Cell
from tests.models.balise_runs import LATER, NEXT, PLAIN, Record, drive, label, located, out, step, until

THIRD = Group(4, 130_000, accuracy_mm=1_000, reaction="NONE")
ROW = "announced groups disagree in a row"


def read(stream: list[Record], cycle: int, group: Group, **changed: Cell) -> list[Record]:
    """The stream up to a cycle in which a group is read."""
    return [*until(cycle, stream), step(1_000, {**telegram(group, since_mm=0), **changed})]


def too_early_twice() -> list[Record]:
    """Two groups in a row are read long before their windows, and a third one is announced."""
    stream = read(located(NEXT, LATER), 20, NEXT)
    return [*read(stream, 30, LATER), step(1_000, announcement(THIRD))]


def test_three_refused_in_a_row_end_the_position() -> None:
    """In the step of the third one, with the reason CONTRADICTION; the brake is ordered in that step all the same."""
    trace = drive(read(too_early_twice(), 40, THIRD))
    assert [out(trace, index)["refused_in_row"] for index in (-2, -1)] == [2, 0]
    assert [out(trace, index)["valid"] for index in (-2, -1)] == [True, False]
    assert ("CONTRADICTION", "SERVICE_BRAKE", "TOO_EARLY") == tuple(
        label(trace, name) for name in ("reason", "reaction", "telegram")
    )
    assert ROW == trace.steps[-1].fired["fired"]
    assert "UNKNOWN" == label(trace, "direction")


def test_an_accepted_group_begins_the_count_anew() -> None:
    """Refused, refused, accepted, refused: no three in a row."""
    fourth = Group(5, 180_000, accuracy_mm=1_000, reaction="NONE")
    stream = read(too_early_twice(), 130, THIRD)
    trace = drive(read([*stream, step(1_000, announcement(fourth))], 140, fourth))
    assert "TOO_EARLY" == label(trace, "telegram")
    assert [True, 1] == [out(trace)[name] for name in ("valid", "refused_in_row")]


@pytest.mark.parametrize(
    ("changed", "verdict"),
    [
        ({"telegram_total": 3}, "INCOMPLETE"),
        ({"telegram_check": "FAILED"}, "CORRUPTED"),
        ({"telegram_age_ms": 5_000}, "STALE"),
        ({"telegram_group": 900_001}, "NOT_ANNOUNCED"),
    ],
)
def test_what_says_nothing_of_the_place_does_not_count(changed: dict[str, Cell], verdict: str) -> None:
    """A damaged, old or incomplete telegram, and a group of another track, leave the count as it was."""
    stream = too_early_twice()
    trace = drive(read(stream, 40, THIRD, **changed))
    assert verdict == label(trace, "telegram")
    assert [True, 2] == [out(trace)[name] for name in ("valid", "refused_in_row")]


def test_another_place_and_the_other_direction_count() -> None:
    """A telegram with another place than announced, and a group passed in the wrong direction."""
    stream = read(located(NEXT, LATER), 50, NEXT, telegram_position_mm=60_000)
    trace = drive(read(stream, 90, LATER, telegram_first=2, telegram_last=1))
    assert ["MISMATCH", "WRONG_DIRECTION"] == [label(trace, "telegram", index) for index in (50, -1)]
    assert 2 == out(trace)["refused_in_row"]


@pytest.mark.parametrize("limit", [1, 2, 4])
def test_the_limit_is_a_figure_of_the_configuration(limit: int) -> None:
    """The position ends with the group that fills the row, again after it was located anew; with a limit of four, three leave it."""
    trace = drive(read(too_early_twice(), 40, THIRD), PLAIN.model_copy(update={"refusal_limit_groups": limit}))
    ends = [index for index in range(len(trace.steps)) if trace.steps[index].fired["fired"] == ROW]
    assert ends == {1: [20, 40], 2: [30], 4: []}[limit]


def test_after_the_loss_the_map_locates_anew() -> None:
    """A first group that comes with its place begins a position; the groups before it are forgotten."""
    trace = drive(read(read(too_early_twice(), 40, THIRD), 60, Group(9, 60_000, accuracy_mm=None)))
    assert [True, 0, 0] == [out(trace)[name] for name in ("valid", "refused_in_row", "missed_in_row")]
