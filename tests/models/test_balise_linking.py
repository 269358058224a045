"""Linking: reactions, groups missed and found out of order, announcements."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping
from dataclasses import replace

import pytest

from safeloc.models.balise.groups import Group, announcement, telegram
from safeloc.runtime.streams.steps import Cell
from tests.models.balise_runs import LATER, NEXT, drive, label, located, out, read_at, step, until


@pytest.mark.parametrize("reaction", ["NONE", "SERVICE_BRAKE", "TRAIN_TRIP"])
def test_a_missed_group_has_its_reaction(reaction: str) -> None:
    """3.16.2.3.1 b: in the step in which the window closes, and only then."""
    trace = drive(until(58, located(replace(NEXT, reaction=reaction))))  # type: ignore[arg-type]
    assert [label(trace, "reaction", index) for index in (-3, -2, -1)] == ["NONE", reaction, "NONE"]
    assert out(trace)["missed_in_row"] == 1


def test_two_missed_in_a_row_brake() -> None:
    """3.16.2.7.1.1: the service brake at the second one, even with reaction none; the train trip stays a trip."""
    trace = drive(until(100, located(NEXT, LATER)))
    reactions = [label(trace, "reaction", index) for index in range(len(trace.steps))]
    assert Counter(reactions) == {"NONE": 99, "SERVICE_BRAKE": 1}
    assert reactions.index("SERVICE_BRAKE") == 98
    tripping = drive(until(100, located(NEXT, replace(LATER, reaction="TRAIN_TRIP"))))
    assert label(tripping, "reaction", 98) == "TRAIN_TRIP"


def test_an_accepted_group_between_starts_the_count_again() -> None:
    """Missed, accepted, missed: no two in a row."""
    third = Group(4, 130_000, accuracy_mm=1_000, reaction="NONE")
    stream = [*until(90, located(NEXT, LATER)), step(1_000, telegram(LATER, since_mm=0))]
    trace = drive([*stream, step(1_000, announcement(third)), *(step() for _ in range(60))])
    assert {label(trace, "reaction", index) for index in range(len(trace.steps))} == {"NONE"}
    assert out(trace)["missed_in_row"] == 1


def test_a_later_group_found_first() -> None:
    """3.16.2.3.1 c: the expected group is given up with its reaction; the later one counts inside its own window."""
    tripping = replace(NEXT, reaction="TRAIN_TRIP")
    close = Group(3, 54_000, accuracy_mm=2_000, reaction="NONE")
    trace = read_at(52, close, tripping, close)
    assert trace.steps[-1].fired["fired"] == "later group resets the position"
    assert (label(trace, "reaction"), out(trace)["missed_in_row"]) == ("TRAIN_TRIP", 0)
    early = read_at(40, LATER, tripping, LATER)
    assert (label(early, "telegram"), label(early, "reaction")) == ("TOO_EARLY", "TRAIN_TRIP")
    assert (out(early)["expected"], out(early)["missed_in_row"]) == (0, 2)


def test_found_in_rear_of_the_window() -> None:
    """3.16.2.3.1 a: rejected with the linking reaction; the group is expected no longer."""
    trace = read_at(30, replace(NEXT, reaction="SERVICE_BRAKE"), replace(NEXT, reaction="SERVICE_BRAKE"))
    assert (label(trace, "telegram"), label(trace, "reaction")) == ("TOO_EARLY", "SERVICE_BRAKE")
    assert out(trace)["expected"] == 0


def test_wrong_direction_trips() -> None:
    """3.16.2.3.2: reject and trip, whatever the linking reaction."""
    trace = read_at(50, NEXT, NEXT, telegram_first=2, telegram_last=1)
    assert label(trace, "reaction") == "TRAIN_TRIP"


@pytest.mark.parametrize("identity", [900_001, 1])
def test_groups_outside_linking_cause_nothing(identity: int) -> None:
    """3.16.2.4.3: a group of another track, or one that was read before, is rejected without reaction."""
    trace = read_at(50, NEXT, NEXT, telegram_group=identity)
    assert (label(trace, "reaction"), out(trace)["expected"]) == ("NONE", 2)


@pytest.mark.parametrize(
    ("order", "verdict", "expected"),
    [
        (announcement(LATER), "TAKEN", 2),
        (announcement(NEXT), "KNOWN", 2),
        (announcement(replace(LATER, place_mm=40_000)), "OUT_OF_ORDER", 2),
        (announcement(replace(LATER, place_mm=-90_000)), "BEHIND", 2),
        (announcement(LATER, order="REPLACE"), "TAKEN", 3),
        ({"linking_order": "WITHDRAW"}, "WITHDRAWN", 0),
        ({"linking_order": "WITHDRAW", "linking_group": 2}, "MALFORMED", 2),
        ({"linking_order": "ADD", "linking_group": 3}, "MALFORMED", 2),
        ({"linking_group": 3}, "MALFORMED", 2),
    ],
)
def test_announcements(order: Mapping[str, Cell], verdict: str, expected: int) -> None:
    """What becomes of an announcement while one group is expected."""
    trace = drive([*located(NEXT), step(1_000, order)])
    assert (label(trace, "linking"), out(trace)["expected"]) == (verdict, expected)


def test_announcements_beyond_what_can_be_held() -> None:
    """Two groups are held; a third one is refused until there is room, and that is said."""
    trace = drive([*located(NEXT, LATER), step(1_000, announcement(Group(4, 200_000)))])
    assert (label(trace, "linking"), out(trace)["wants_linking"]) == ("FULL", False)
