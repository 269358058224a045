"""A wrong edit of a term of the balise machine is noticed by a proof: claims speak of truth and inputs, not of its terms."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import pytest

from safeloc.language.expr import FALSE, Num, as_num, exact_to, ite, maximum
from safeloc.language.machine import Machine
from safeloc.language.spec import Property
from safeloc.language.units import MM, NM, NM_PER_MM
from safeloc.models.balise import build
from safeloc.models.balise.configurations import ERRING
from safeloc.models.balise.judgement import Judgement
from safeloc.models.balise.linking import Announcement
from safeloc.models.balise.telegram import Reader, Telegram
from safeloc.models.balise.variables import BaliseConfig, parts
from safeloc.models.vocabulary.interval import Interval
from safeloc.models.vocabulary.odometer import Odometer
from safeloc.properties.balise import properties
from tests.models.edited_terms import edited, keeps
from tests.models.spoilt import rebuilt

CONFIG = BaliseConfig()


def made(config: BaliseConfig = CONFIG) -> tuple[Machine, list[Property]]:
    """The machine as it is built now, and its claims."""
    model = build(parts(config))
    return model.machine, properties(model)


def shifted(fix: Interval, by: Num | int) -> Interval:
    """The interval elsewhere."""
    return Interval(fix.position + by, fix.above, fix.below)


def narrower(fix: Interval, by: Num | int) -> Interval:
    """The interval with less added on either side."""
    return Interval(fix.position, fix.above - by, fix.below - by)


def ran(read: Telegram) -> Num:
    """What the counter tells, nm."""
    return exact_to(read.since.value_or(as_num(0, MM)), NM)


Wrong = Callable[..., object]
EDITS: dict[str, tuple[type, str, Wrong, str]] = {
    "antenna before the front end": (
        Reader, "fix", lambda r, right, *_: shifted(right, -2 * r.antenna_mm * NM_PER_MM),
        "containment"),
    "detection accuracy not added": (
        Reader, "fix", lambda r, right, *_: narrower(right, r.detection_mm * NM_PER_MM), "containment"),
    "location accuracy not added": (
        Reader, "fix", lambda _r, right, _read, _place, accuracy, *_: narrower(right, exact_to(accuracy, NM)), "containment"),
    "odometer's constant not added": (Reader, "fix", lambda r, right, *_: narrower(right, r.constant_nm), "containment"),
    "run since the reading not added": (
        Reader, "fix",
        lambda _r, right, read, *_: shifted(right, -ran(read)), "containment"),
    "run since the reading taken off": (
        Reader, "fix",
        lambda _r, right, read, *_: shifted(right, ran(read) * -2),
        "containment"),
    "telegram age ignored": (Reader, "run_since", lambda _r, right, *_: (right[0] * 0, right[1] * 0), "containment"),
    "run since the reading added on the other side": (
        Reader, "run_since", lambda _r, right, *_: (right[1], right[0]), "containment"),
    "window on the wrong side of the group": (
        Reader, "window", lambda r, right, *_: tuple(end - 2 * r.antenna_mm * NM_PER_MM for end in right),
        "only announced groups reset"),
    "window without the location accuracy": (
        Reader, "window", lambda _r, right, _place, accuracy: (
            right[0] + exact_to(accuracy, NM), right[1] - exact_to(accuracy, NM)),
        "the expected group counts"),
    "direction of the group turned": (
        Telegram, "against", lambda t, right, o: t.passed.ne(0) & o.ne(0) & ~right, "only announced groups reset"),
    "direction of the group ignored": (
        Telegram, "against", lambda _t, _r, _o: FALSE, "of the expected group but passed the wrong way changes nothing"),
    "stale telegrams believed": (Telegram, "stale", lambda _t, _r: FALSE, "stale changes nothing"),
    "interval and telegram always agree": (Judgement, "agrees", lambda c, _: c.run_on.low <= c.run_on.high, "containment"),
    "interval and telegram agree without the constant": (
        Judgement, "agrees", lambda c, _: c.run_on.overlap(c.fix) >= -100 * CONFIG.tolerance_mm * NM_PER_MM, "containment"),
    "accuracy that linking gives is forgotten": (
        Announcement, "record", lambda _a, right: replace(right, accurate=FALSE), "announced group 1 stays stored as announced"),
    "announced place taken 10 m farther": (
        Announcement, "record", lambda _a, right: replace(right, place=right.place + 10_000),
        "announced group 1 stays stored as announced"),
    "odometer error not added": (Odometer, "growth", lambda _o, right: right * 0, "containment"),
    "any distance admitted": (Odometer, "admitted", lambda o, _: o.measured.present, "containment"),
}  # fmt: skip
"""Where, what, the wrong term, and the claim that notices."""


@pytest.mark.thorough(ordinary=1)
@pytest.mark.parametrize("edit", EDITS)
def test_a_wrong_edit_is_noticed(monkeypatch: pytest.MonkeyPatch, edit: str) -> None:
    """The claim that is named is kept by the machine as it is, and not by the one that was edited wrongly."""
    owner, name, wrong, claim = EDITS[edit]
    assert keeps(made(), claim)
    edited(monkeypatch, owner, name, wrong)
    assert not keeps(made(), claim)


UNSEEN = {
    "an odometer that errs at standstill": BaliseConfig(odometer=ERRING),
    "a distance that a second unit has checked": BaliseConfig(checked_distance=True),
}
"""Configurations in which the vehicle can run against the measured direction by more than the one-off error."""


@pytest.mark.thorough(ordinary=1)
@pytest.mark.parametrize("config", UNSEEN.values(), ids=UNSEEN)
def test_a_run_against_the_measured_direction_is_added(monkeypatch: pytest.MonkeyPatch, config: BaliseConfig) -> None:
    """A machine that takes the measured direction for the true one, whatever the odometer's error, loses containment."""
    assert keeps(made(config), "containment")
    edited(monkeypatch, Reader, "_unmeasured", lambda _r, right, *_: right * 0)
    assert not keeps(made(config), "containment")


KEPT = "a group is kept where linking or its telegram has it"


def test_a_group_kept_elsewhere_is_noticed() -> None:
    """Where the telegram gives no reflector, nothing but this claim speaks of the place at which the group is kept."""
    own = parts(CONFIG)
    model = build(own)
    place, least = own.memory.last_group_position, own.memory.last_group_position.low

    def elsewhere(right: Num) -> Num:
        return ite(own.read.reflector.present, right, maximum(right - 10_000, least))

    rows = [
        replace(row, set={**row.set, place: elsewhere(as_num(row.set[place], MM))}) if place in row.set else row
        for row in model.machine.transitions
    ]
    assert keeps((model.machine, properties(model)), KEPT)
    assert not keeps((rebuilt(model.machine, rows), properties(model)), KEPT)


ON_THE_LINE = "the vehicle stays on the line"
"""Only the range of the truth needs it."""


@pytest.mark.thorough(ordinary=2)
@pytest.mark.parametrize("law", [name for name in made()[0].world.clauses if name != ON_THE_LINE])
def test_every_law_is_needed(law: str) -> None:
    """Without any one law of the world containment does not follow."""
    machine, claims = made()
    left = {name: one for name, one in machine.world.clauses.items() if name != law}
    assert not keeps((replace(machine, world=replace(machine.world, clauses=left)), claims), "containment")
