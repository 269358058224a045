"""Whose a pattern is: by order on the track, and nobody's where the numbers do not agree."""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import pytest

from safeloc.language.expr import FALSE, TRUE
from safeloc.language.interpret import run
from safeloc.language.system import lower, without_ghosts
from safeloc.language.trace import Trace
from safeloc.models.train_order import TrainOrder, TrainOrderConfig, build, parts
from safeloc.models.train_order.cycle import Cycle
from safeloc.properties.train_order import properties
from safeloc.runtime.streams.steps import Cell
from tests.models.everything_proved import unproved_of
from tests.models.inductive import changed, inductive


@cache
def made() -> TrainOrder:
    """The machine with its variables."""
    return build(parts(TrainOrderConfig()))


def cycle(*patterns: tuple[int, int], **cells: Cell) -> dict[str, Cell]:
    """One cycle with patterns (low, high), in order."""
    step: dict[str, Cell] = {
        "enters_low": 0, "enters_high": 0, "leaves_low": False, "leaves_high": False, "counters_clear": False,
        "counter_fault": False, "patterns": len(patterns),
    }  # fmt: skip
    for number in range(1, 4):
        low, high = patterns[number - 1] if number <= len(patterns) else (0, 0)
        step |= {f"pattern_{number}_low_mm": low, f"pattern_{number}_high_mm": high}
    return step | cells


def whose(*steps: dict[str, Cell]) -> list[tuple[int, ...]]:
    """Whose the patterns are, after every step on from an empty area."""
    trace: Trace = run(without_ghosts(lower(made().machine)), [cycle(counters_clear=True), *steps])
    return [tuple(one.outputs[f"train_of_pattern_{n}"] for n in (1, 2, 3)) for one in trace.steps[1:]]


ONE, TWO = (0, 100), (200, 300)


def test_order_not_distance() -> None:
    """The second train's pattern jumps to where the first one was: it stays the second one's."""
    steps = [cycle((0, 100), enters_low=1), cycle((900, 999), (0, 100))]
    assert whose(*steps)[-1] == (0, 0, 0)
    follow = [cycle(ONE, enters_low=1), cycle(ONE, TWO, enters_low=2), cycle((190, 210), (400, 500))]
    assert whose(*follow) == [(1, 0, 0), (2, 1, 0), (2, 1, 0)]


def test_both_ends() -> None:
    """Trains enter and leave at either end; the others keep their places."""
    steps = [cycle(ONE, enters_low=1), cycle(ONE, TWO, enters_high=3), cycle(ONE, leaves_low=True)]
    assert whose(*steps) == [(1, 0, 0), (1, 3, 0), (3, 0, 0)]
    assert whose(*steps[:2], cycle(ONE, leaves_high=True))[-1] == (1, 0, 0)


@pytest.mark.parametrize(
    "last",
    [cycle(), cycle(ONE), cycle(ONE, TWO, (400, 500)), cycle((0, 250), TWO), cycle(ONE, TWO, counter_fault=True),
     cycle(ONE, TWO, enters_low=1), cycle(ONE, TWO, leaves_low=True, leaves_high=True)],
    ids=["none", "lost", "ghost", "overlap", "fault", "there already", "two events"],
)  # fmt: skip
def test_nobodys(last: dict[str, Cell]) -> None:
    """More, fewer or overlapping patterns, and events that cannot be, leave no pattern to anyone."""
    assert whose(cycle(ONE, enters_low=1), cycle(ONE, TWO, enters_low=2), last)[-1] == (0, 0, 0)


@pytest.mark.thorough
def test_everything_is_proved() -> None:
    """All properties and lemmas, without bound."""
    assert unproved_of(made().machine, properties(made())) == {}


@pytest.mark.parametrize(
    ("row", "fields", "broken"),
    [
        ("patterns belong to trains", {"when": TRUE}, "another number of patterns belongs to nobody"),
        ("patterns belong to trains", {"set": "belongs only"}, "a pattern holds its train"),
        ("patterns belong to trains", {"set": "belongs only"}, "the order follows: in at the low end"),
        ("patterns belong to nobody", {"set": {}}, "the order follows: out at the high end"),
        ("area is empty", {"when": TRUE}, "an order begins with an empty area"),
        ("area is empty", {"set": {}}, "an order begins with an empty area"),
        ("impossible event", {"when": FALSE}, "two events at once ends the order"),
        ("impossible event", {"when": FALSE}, "a train that is not there ends the order"),
        ("impossible event", {"when": FALSE}, "a train that is there already ends the order"),
        ("order lost", {"when": FALSE}, "a fault ends the order"),
    ],
)
def test_a_broken_row_is_noticed(row: str, fields: dict[str, object], broken: str) -> None:
    """A row without its guard, or an order that is not kept up, loses a proof."""
    own = made().own
    given = {name: dict(zip(own.belongs, Cycle(own).after, strict=True)) if isinstance(value, str) else value
             for name, value in fields.items()}  # fmt: skip
    wrong = replace(made(), machine=changed(made().machine, row, **given))
    assert not inductive(wrong.machine, next(one for one in properties(wrong) if one.name == broken))
