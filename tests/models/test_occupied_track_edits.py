"""A wrong edit of the occupied track is noticed by a proof: a track is lost, invented, kept too long, or told too soon."""

from __future__ import annotations

from collections.abc import Callable

import pytest

from safeloc.language.expr import FALSE, TRUE, any_of
from safeloc.language.machine import Machine
from safeloc.language.spec import Property
from safeloc.models import occupied_track
from safeloc.models.occupied_track import OccupiedTrack, OccupiedTrackConfig, build, cycle, parts
from safeloc.models.occupied_track.cycle import Cycle
from safeloc.models.turn_off import UNDECIDED
from safeloc.properties.occupied_track import properties
from tests.models.edited_terms import edited, keeps
from tests.models.inductive import changed

CONFIG = OccupiedTrackConfig(tracks=2)
TRUE_TRACK = "the true track is carried"
TOLD = "one track is told only if no other is possible"
AHEAD = "track 1 goes on along what lies ahead"
BEHIND = "track 1 goes on along what lies behind"
FOLLOWS = "offer 1 is taken only if it follows"
ALL_OFFERED = "more than carried is no position"


def made() -> tuple[Machine, list[Property]]:
    """The machine as it is built now, and its claims."""
    model = build(parts(CONFIG))
    return model.machine, properties(model)


Wrong = Callable[..., object]
EDITS: dict[str, tuple[str, Wrong, str]] = {
    "the end of the edge by the near end of the interval": (
        "leaves_ahead",
        lambda c, _r, slot: slot.edge.ne(0) & (c.own.low > slot.origin + slot.length) & ~c.own.surely_not_ahead,
        TRUE_TRACK,
    ),
    "the edge counts from zero": (
        "leaves_ahead", lambda c, _r, slot: slot.edge.ne(0) & (c.own.high > slot.length) & ~c.own.surely_not_ahead, ALL_OFFERED),
    "nothing leaves behind": ("leaves_behind", lambda _c, _r, _slot: FALSE, TRUE_TRACK),
    "leaves behind although it did not run back": (
        "leaves_behind", lambda c, _r, slot: slot.edge.ne(0) & (c.own.low < slot.origin), FOLLOWS),
    "an end that is touched counts as left": (
        "leaves_ahead",
        lambda c, _r, slot: slot.edge.ne(0) & (c.own.high >= slot.origin + slot.length) & ~c.own.surely_not_ahead,
        FOLLOWS,
    ),
    "may be anywhere": ("may_be_on", lambda _c, _r, *_: TRUE, "a track that the position excludes is given up"),
    "may be on by the near end only": (
        "may_be_on", lambda c, _r, origin, length: (c.own.low <= origin + length) & (c.own.low >= origin), TRUE_TRACK),
    "what is not offered is forgotten": ("all_offered", lambda _c, _r: TRUE, TRUE_TRACK),
    "every offer is believed": ("follows", lambda _c, _r, _index: TRUE, FOLLOWS),
    "no offer is believed": ("follows", lambda _c, _r, _index: FALSE, "a contradiction is that no track fits"),
    "a group ends nothing": (
        "agrees", lambda c, _r, offer: c.may_be_on(offer.origin, offer.length), "a track that a group excludes is given up"),
    "an absent group is compared": (
        "agrees", lambda c, right, offer: right & c.own.group_edge.value.eq(offer.edge), TRUE_TRACK),
    "an unknown course excludes": (
        "agrees", lambda c, right, offer: right & (c.own.course_taken.eq(UNDECIDED) | c.own.course_taken.eq(offer.course)), TRUE_TRACK),
    "the group's error is not added": (
        "group_fits",
        lambda c, _r, offer: (c.own.low <= offer.origin + c.own.group_place) & (c.own.high >= offer.origin + c.own.group_place),
        TRUE_TRACK,
    ),
    "the group's error is added twice": (
        "group_fits",
        lambda c, _r, offer: (
            (c.own.low <= offer.origin + c.own.group_place + 2 * c.own.group_error)
            & (c.own.high >= offer.origin + c.own.group_place - 2 * c.own.group_error)
        ),
        "a track that a group excludes is given up",
    ),
    "the group's place counts on the line": (
        "group_fits",
        lambda c, _r, _offer: (
            (c.own.low <= c.own.group_place + c.own.group_error) & (c.own.high >= c.own.group_place - c.own.group_error)
        ),
        "a track that a group excludes is given up",
    ),
    "located by the localizer's word alone": ("located", lambda c, _r: c.own.located, "without a position nothing is told"),
    "a start begins anywhere": ("begins", lambda c, _r: c.located & c.own.start_given, "the told interval is that of its tracks"),
    "a start begins without a position": ("begins", lambda c, _r: c.own.start_given, "no resurrection"),
}  # fmt: skip


@pytest.mark.thorough(ordinary=4)
@pytest.mark.parametrize("edit", EDITS)
def test_a_wrong_edit_is_noticed(monkeypatch: pytest.MonkeyPatch, edit: str) -> None:
    """The claim that is named is kept by the machine as it is, and not by the one that was edited wrongly."""
    name, wrong, claim = EDITS[edit]
    assert keeps(made(), claim)
    edited(monkeypatch, Cycle, name, wrong)
    assert not keeps(made(), claim)


LED = {
    "the second edge of a joint is forgotten": (lambda right: right[:1], TRUE_TRACK),
    "points are not looked at": (lambda right: [(edge, edge.ne(0)) for edge, _ in right], FOLLOWS),
    "points lead the other way": (
        lambda right: list(zip([edge for edge, _ in right], [led for _, led in reversed(right)], strict=True)), TRUE_TRACK),
}  # fmt: skip


@pytest.mark.thorough(ordinary=1)
@pytest.mark.parametrize("edit", LED)
def test_a_wrong_joint_is_noticed(monkeypatch: pytest.MonkeyPatch, edit: str) -> None:
    """What a joint leads to is claimed in both directions."""
    wrong, claim = LED[edit]
    right = cycle._led
    monkeypatch.setattr(cycle, "_led", lambda joint: iter(wrong(list(right(joint)))))
    assert not keeps(made(), claim)


def test_a_track_that_is_told_too_soon_is_noticed(monkeypatch: pytest.MonkeyPatch) -> None:
    """One edge is told while another is carried."""
    monkeypatch.setattr(occupied_track, "on_one_edge", lambda _edges, there: any_of(there))
    assert not keeps(made(), TOLD)


@pytest.mark.thorough(ordinary=1)
@pytest.mark.parametrize(
    ("transition", "fields", "claim"),
    [
        ("more than carried", {"when": FALSE}, ALL_OFFERED),
        ("position lost", {"when": FALSE}, "without a position nothing is told"),
        ("no track fits", {"when": FALSE}, "nothing is carried without a start"),
        ("start", {"set": {}}, "a start begins on its track"),
        ("stay lost", {"target": 1}, "no resurrection"),
        ("tracks part", {"target": 1}, TOLD),
        ("run on along several", {"set": {}}, TRUE_TRACK),
        ("no track fits", {"set": {}}, "nothing is carried without a start"),
    ],
)
def test_a_wrong_row_is_noticed(transition: str, fields: dict[str, object], claim: str) -> None:
    """A row with another target, without its updates, or that is never taken, breaks the claim."""
    model = build(parts(CONFIG))
    named = {**fields, "target": model.machine.modes[1]} if "target" in fields else fields
    wrong = changed(model.machine, transition, **named)
    assert keeps((model.machine, properties(model)), claim)
    assert not keeps((wrong, properties(OccupiedTrack(wrong, model.own))), claim)
