"""Where borders report occupancy alone, a wrong edit of a term of the area is refused by a proof: of vehicles, or of their bounds."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import pytest

from safeloc.language.expr import FALSE, TRUE, Bool, Expr, Num, Var, as_num, ite
from safeloc.language.rows import Updates
from safeloc.language.units import MM
from safeloc.models import area, sections
from safeloc.models.area import Area, AreaConfig, Parts
from safeloc.models.area.followers import Followers, Side
from safeloc.models.area.slot import ENTERS_HIGH, ENTERS_LOW, LEAVES_HIGH, LEAVES_LOW, Slot
from safeloc.models.sections import Section, SectionsConfig
from tests.models.edited_terms import edited
from tests.models.test_area_edits import HELD, LOOSE, keeps

CONFIG = SectionsConfig(area=AreaConfig(trains=2, borders="occupancy", entry_report_delay_ms=2_000))
CLEAR = "section_1 is never clear with a vehicle that was not counted"
RUNS, BEGINS = "followers from the low end run on", "followers come in at the low end only from outside"
FASTER = "followers from the high end run no faster than they can"
Wrong = Callable[..., object]
RIGHT_FOLLOWERS, RIGHT_GONE = vars(area)["_followers"], vars(area)["_gone"]


def sides_swapped(own: Parts) -> Updates:
    """Each end reads whether it is clear outside the other one."""
    assert own.followers is not None
    low, high = own.followers.sides
    updates = dict(RIGHT_FOLLOWERS(own))
    for side, other in ((low, high), (high, low)):
        trains = own.followers.trains(side, own.slots, (own.low_end, own.high_end))
        bound = replace(side, clear=other.clear).after(own.slots, trains)
        updates[side.bound] = ite(own.healthy & ~own.clear, bound, side.none)
    return updates


def ahead_only(own: Parts) -> Updates:
    """Nobody comes in behind, at the high end."""
    assert own.followers is not None
    high = own.followers.high
    return {**RIGHT_FOLLOWERS(own), high.bound: high.none}


def nearest(followers: Followers, side: Side, slots: tuple[Slot, ...], ends: tuple[Num, Num]) -> list[tuple[Bool, Num]]:
    """A follower stays behind the near end of the train's interval."""
    near = [one.bounds(*ends)[0 if side.is_low else 1] for one in slots]
    return [(one.present & known, end) for one, known, end in zip(slots, followers.ordered, near, strict=True)]


def of_any_train(
    followers: Followers, right: list[tuple[Bool, Num]], slots: tuple[Slot, ...]
) -> list[tuple[Bool, Num]]:
    """A train whose order is not known holds followers as well."""
    assert len(slots) == len(followers.ordered)
    return [(one.present, end) for one, (_, end) in zip(slots, right, strict=True)]


def told_is_gone(own: Parts, one: Slot) -> Bool:
    """A train that says that it left is believed."""
    told = own.healthy & one.present & one.event.one_of(LEAVES_LOW, LEAVES_HIGH)
    return told | RIGHT_GONE(own, one)


def clear_though_disturbed(own: Parts, one: Slot) -> Bool:
    """Train detection is believed while it is disturbed."""
    return RIGHT_GONE(own, one) | (one.present & own.clear & ~one.enters)


def _less(side: Side, right: Num) -> Num:
    return right - 1 if side.is_low else right + 1


OF_THE_BOUND: dict[str, tuple[type, str, Wrong, str]] = {
    "the bound stands": (Side, "run_on", lambda _s, _r, start, _trains: start, CLEAR),
    "the bound moves one mm less in a cycle": (Side, "run_on", lambda one, right, *_: _less(one, right), CLEAR),
    "the bound moves one mm more in a cycle": (
        Side, "run_on", lambda one, right, *_: right + 1 if one.is_low else right - 1, FASTER),
    "an end is never open": (Side, "after", lambda one, right, *_: ite(one.some, right, one.none), CLEAR),
    "an end is always open": (Side, "after", lambda one, _r, *_: one.run_on(one.place, ()), BEGINS),
    "a report of a train ends the bound": (
        Side, "after", lambda one, right, slots, _t: ite(slots[0].accepted, one.none, right), CLEAR),
    "a train that comes in ends the bound": (
        Side, "after", lambda one, right, slots, _t: ite(one.any_enters(slots), one.none, right), CLEAR),
    "a train that comes in keeps the bound": (
        Side, "after", lambda one, right, slots, trains: ite(one.some & one.any_enters(slots), one.run_on(one.bound, trains), right),
        BEGINS),
    "a side that is clear again ends the bound": (Side, "after", lambda one, right, *_: ite(one.clear, one.none, right), CLEAR),
    "a follower is behind the near end of a train": (Followers, "trains", lambda one, _r, *args: nearest(one, *args), CLEAR),
    "a train whose order is not known holds followers": (
        Followers, "trains", lambda one, right, _s, slots, _e: of_any_train(one, right, slots), LOOSE),
    "followers before a train that comes in are forgotten": (Followers, "turns_loose", lambda *_: FALSE, LOOSE),
    "a train keeps its side when followers turn loose behind it": (
        Followers, "beside", lambda _f, _r, one, *_: (one.below_loose, one.above_loose), LOOSE),
    "a train that is reported is ahead of no follower": (
        Followers, "beside", lambda _f, right, one, *_: (
            ite(one.enters, one.event.eq(ENTERS_LOW), right[0]), ite(one.enters, one.event.eq(ENTERS_HIGH), right[1])), LOOSE),
    "a train is reported in time": (
        Slot, "bounds", lambda one, right, low, _h: (
            right[0], ite(one.event.eq(ENTERS_LOW), low + one.reach.cycle_mm, right[1])), HELD),
    "the order is known of a train that reported that it left": (
        Followers, "stays_ordered", lambda one, _r, slot: slot.enters | one.ordered[slot.number - 1], LOOSE),
    "every train's order is known": (Followers, "stays_ordered", lambda *_: TRUE, LOOSE),
}  # fmt: skip
OF_THE_AREA: dict[str, tuple[str, Wrong, str]] = {
    "the side of the other end": ("_followers", sides_swapped, CLEAR),
    "nobody comes in at the high end": ("_followers", ahead_only, CLEAR),
    "a train that says that it left is believed": ("_gone", told_is_gone, HELD),
    "detection is believed while it is disturbed": ("_gone", clear_though_disturbed, HELD),
    "a disturbance lets nothing in": ("_uncounted", lambda _own: FALSE, LOOSE),
}


@pytest.mark.thorough(ordinary=1)
@pytest.mark.parametrize("edit", OF_THE_BOUND)
def test_a_wrong_edit_of_the_bound_is_noticed(monkeypatch: pytest.MonkeyPatch, edit: str) -> None:
    """The claim that is named is kept by the machines as they are, and not by those that were edited wrongly."""
    owner, name, wrong, claim = OF_THE_BOUND[edit]
    assert keeps(claim, CONFIG)
    edited(monkeypatch, owner, name, wrong)
    assert not keeps(claim, CONFIG)


@pytest.mark.thorough(ordinary=2)
@pytest.mark.parametrize("edit", OF_THE_AREA)
def test_a_wrong_edit_of_the_area_is_noticed(monkeypatch: pytest.MonkeyPatch, edit: str) -> None:
    """The same of what the area judges as a whole."""
    name, wrong, claim = OF_THE_AREA[edit]
    assert keeps(claim, CONFIG)
    monkeypatch.setattr(area, name, wrong)
    assert not keeps(claim, CONFIG)


RIGHT_WIRES = sections.section_wires


def unread(area_: Area, one: Section) -> dict[Var, Expr]:
    """A section is reported of no follower from the low end."""
    low, _ = one.followers
    return {**RIGHT_WIRES(area_, one), low: as_num(-area_.own.config.limit_mm, MM)}


def test_a_section_that_reads_no_followers_is_noticed(monkeypatch: pytest.MonkeyPatch) -> None:
    """It would be FREE with a vehicle in it that was not counted."""
    assert keeps(CLEAR, CONFIG)
    monkeypatch.setattr(sections, "section_wires", unread)
    assert not keeps(CLEAR, CONFIG)
