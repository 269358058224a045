"""A wrong edit of the machine of the unlinked group is noticed by a proof; and a host gives it the records of the balise machine."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import pytest

from safeloc.catalogue import load_target
from safeloc.language.expr import FALSE
from safeloc.language.machine import Machine
from safeloc.language.spec import Property
from safeloc.models.balise.groups import telegram
from safeloc.models.unlinked_group import Cycle, build
from safeloc.models.unlinked_group.variables import UnlinkedGroupConfig, parts
from safeloc.properties.unlinked_group import properties
from safeloc.runtime.embedding import Controller
from safeloc.runtime.streams.records import DistanceRecord, ValueRecord
from tests.models.edited_terms import edited, keeps
from tests.models.inductive import changed
from tests.models.unlinked_runs import UNLINKED

TAKING, RUNNING = "a whole unlinked group is taken", "the distance runs on with the odometer"
Wrong = Callable[..., object]


def made() -> tuple[Machine, list[Property]]:
    """The machine as it is built now, and its claims."""
    model = build(parts(UnlinkedGroupConfig()))
    return model.machine, properties(model)


EDITS: dict[str, tuple[str, Wrong, str]] = {
    "the reverse of turned": ("backwards", lambda _, right: ~right, TAKING),
    "nothing is ever taken": ("taken", lambda _o, _r: FALSE, TAKING),
    "linked groups are taken": (
        "taken",
        lambda o, right: right | o.own.read.well_formed & o.own.read.complete & ~o.own.read.corrupted & ~o.backwards,
        "only a whole unlinked group is taken",
    ),
    "incomplete groups are taken": (
        "taken",
        lambda o, right: (
            right | o.own.read.well_formed & ~o.own.read.corrupted & ~o.own.read.stale & ~o.own.read.complete
        ),
        "only a whole unlinked group is taken",
    ),
    "the antenna is taken for the front end": (
        "first",
        lambda o, right: replace(right, position=right.position - o.own.config.antenna_mm),
        "containment",
    ),
    "under-reading and over-reading exchanged": (
        "first",
        lambda _, right: replace(right, above=right.below, below=right.above),
        "containment",
    ),
    "the one-off constant forgotten": (
        "first",
        lambda o, right: right.widened(-o.own.config.reader.constant_nm),
        "containment",
    ),
    "margins that grow too little": ("run_on", lambda _, right: right.widened(-1), "containment"),
    "margins that grow too fast": ("run_on", lambda _, right: right.widened(1), RUNNING),
    "a linked group moves the distance": (
        "run_on",
        lambda o, right: replace(right, position=right.position + o.own.read.since.value_or(right.position * 0)),
        RUNNING,
    ),
}


@pytest.mark.thorough(ordinary=4)
@pytest.mark.parametrize("edit", EDITS)
def test_a_wrong_edit_is_noticed(monkeypatch: pytest.MonkeyPatch, edit: str) -> None:
    """The claim that is named is kept by the machine as it is, and not by the one that was edited wrongly."""
    name, wrong, claim = EDITS[edit]
    assert keeps(made(), claim)
    edited(monkeypatch, Cycle, name, wrong)
    assert not keeps(made(), claim)


@pytest.mark.parametrize(
    ("transition", "fields", "claim"),
    [
        ("sensors failed", {"when": FALSE}, "withdrawn where the distance is lost, and only there"),
        ("turned", {"when": FALSE}, "withdrawn where the distance is lost, and only there"),
        ("tolerance or reach exceeded", {"when": FALSE}, "withdrawn where the distance is lost, and only there"),
        ("unlinked group read", {"set": {}}, "the distance begins at the antenna"),
        ("run on", {"set": {}}, "the age counts from the reading"),
        ("wait for an unlinked group", {"set": {}}, "the verdict names the flaw"),
    ],
)
def test_a_wrong_row_is_noticed(transition: str, fields: dict[str, object], claim: str) -> None:
    """A row that is never taken, or without its updates, breaks the claim."""
    machine, claims = made()
    assert keeps((machine, claims), claim)
    assert not keeps((changed(machine, transition, **fields), claims), claim)


def test_it_reads_the_records_of_the_balise_machine() -> None:
    """The record of a place, which it has no input for, is refused by itself; the reading counts all the same."""
    controller = Controller(load_target("unlinked_group"))
    read = telegram(replace(UNLINKED, place_mm=5_000), since_mm=0)
    values = [ValueRecord(time_ms=200, name=name, value=value) for name, value in read.items()]
    controller.step([DistanceRecord(time_ms=100, end="front", unit="wheel", distance_mm=1_000)])
    report = controller.step([DistanceRecord(time_ms=200, end="front", unit="wheel", distance_mm=1_000), *values])
    assert {"telegram_position_mm", "telegram_orientation"} == {one.channel for one in report.rejections}
    assert (True, 7, 3_000) == tuple(report.outputs[name] for name in ("valid", "group", "distance_mm"))
