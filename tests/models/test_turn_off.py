"""Straight on or turning off: what the lateral motion of a reflector tells, and what it must not tell."""

from __future__ import annotations

from dataclasses import replace

import pytest
from pydantic import ValidationError

from safeloc.language.interpret import run
from safeloc.language.system import lower, without_ghosts
from safeloc.language.trace import Trace
from safeloc.language.verdict import word
from safeloc.models.turn_off import TurnOff, TurnOffConfig, build, machine, parts
from safeloc.proof.provers.limits import Limits
from safeloc.proof.provers.obligations import obligations
from safeloc.proof.provers.portfolio import prove
from safeloc.properties.turn_off import properties
from safeloc.runtime.streams.steps import Cell
from tests.models.everything_proved import shipped_runs
from tests.models.inductive import changed, inductive

ON_BOARD = without_ghosts(lower(machine()))
SWITCH = 50_000


def step(position_mm: int, lateral_mm: int | None = 3_000, **fields: Cell) -> dict[str, Cell]:
    """One cycle: position to half a metre, the reflector measured unless its lateral place is None; switch at 50 m."""
    given: dict[str, Cell] = {
        "reflector_measured": lateral_mm is not None,
        "lateral_mm": 0 if lateral_mm is None else lateral_mm,
        "position_low_mm": position_mm - 500,
        "position_high_mm": position_mm + 500,
        "switch_position_mm": SWITCH,
        "authorised_course": "STRAIGHT",
    }
    return {**given, **fields}


def seen(trace: Trace) -> list[tuple[str, bool]]:
    """Course and contradiction after every step."""
    unit = trace.system.outputs["course"].unit
    return [(str(unit.members[one.outputs["course"]]), bool(one.outputs["contradicts"])) for one in trace.steps]


def drive(*lateral_mm: int | None, **fields: Cell) -> Trace:
    """A run over the switch in steps of 10 m from 30 m on."""
    return run(ON_BOARD, [step(30_000 + 10_000 * n, one, **fields) for n, one in enumerate(lateral_mm)])


def test_straight_on() -> None:
    """The image stays: straight on, stated only when the vehicle is through the turnout."""
    trace = drive(3_000, 3_100, 2_900, 3_000, 3_100, 3_200, 3_000)
    assert [course for course, _ in seen(trace)] == ["UNDECIDED"] * 6 + ["STRAIGHT"]


@pytest.mark.parametrize(("motion", "course"), [(-1, "LEFT"), (1, "RIGHT")])
def test_turning_off(motion: int, course: str) -> None:
    """The vehicle turns left: the image of what lies ahead moves to the right; and the other way round."""
    trace = drive(3_000, 3_000, 3_000, 3_000 + motion * 800, 3_000 + motion * 1_600)
    assert seen(trace)[-2:] == [("UNDECIDED", False), (course, True)]


def test_turning_off_as_authorised() -> None:
    """The same turn contradicts nothing where map and authority ask for it."""
    assert seen(drive(3_000, 3_000, 3_000, 1_000, authorised_course="LEFT"))[-1] == ("LEFT", False)


def test_an_unknown_authority_is_not_contradicted() -> None:
    """Without a course by map and authority there is nothing to contradict."""
    assert seen(drive(3_000, 3_000, 3_000, 1_000, authorised_course="UNDECIDED"))[-1] == ("LEFT", False)


def test_a_late_authority_is_compared() -> None:
    """The contradiction follows the authority of the present cycle."""
    stream = [step(30_000), step(60_000), step(70_000, 1_000), step(80_000, None, authorised_course="LEFT")]
    assert seen(run(ON_BOARD, stream))[-2:] == [("LEFT", True), ("LEFT", False)]


@pytest.mark.parametrize("wrong", ["not measured before", "lost over the switch", "position too wide"])
def test_undecided(wrong: str) -> None:
    """Without the place before the switch, or without a measurement beyond it, nothing is stated."""
    before = [step(30_000, None if wrong == "not measured before" else 3_000), step(60_000, 1_000)]
    if wrong == "position too wide":
        before = [step(30_000, position_high_mm=51_000), step(60_000, 1_000)]
    over = [step(70_000 + n, None) for n in range(25)] if wrong == "lost over the switch" else []
    trace = run(ON_BOARD, [before[0], step(60_000, None), *over, step(80_000, 1_000)])
    assert {course for course, _ in seen(trace)} == {"UNDECIDED"}


def test_backing_off_watches_again() -> None:
    """Backed off before the switch, the lateral place is noted anew; after a decision the switch may be met again."""
    stream = [step(30_000), step(55_000), step(30_000, 2_000), step(55_000, 2_000), step(60_000, 400)]
    assert seen(run(ON_BOARD, stream))[-1] == ("LEFT", True)
    again = [*stream, step(30_000), step(31_000), step(55_000), step(60_000, 4_600)]
    assert seen(run(ON_BOARD, again))[-1] == ("RIGHT", True)


def test_the_next_switch() -> None:
    """After a decision the next switch of the map is watched."""
    first = [step(30_000), step(55_000), step(60_000, 1_000)]
    second = [step(70_000, 1_000, switch_position_mm=90_000), step(95_000, 1_000), step(96_000, 2_600)]
    trace = run(ON_BOARD, [*first, *(one | {"switch_position_mm": 90_000} for one in second)])
    assert [course for course, _ in seen(trace)][-4:] == ["LEFT", "UNDECIDED", "UNDECIDED", "RIGHT"]


def test_another_reflector_is_no_turn() -> None:
    """Over a switch, the reflector behind the next one comes into view: its lateral place is no motion of the first one's."""
    stream = [step(30_000), step(55_000), step(60_000, 600, switch_position_mm=90_000)]
    assert seen(run(ON_BOARD, stream))[-1] == ("UNDECIDED", False)


@pytest.mark.parametrize(
    ("fields", "message"),
    [
        ({"turn_mm": 1_000}, "must exceed sway and twice the lateral error"),
        ({"least_shift_mm": 1_800}, "or turns are missed"),
        ({"give_up_mm": 10_000}, "must not be below decide_mm"),
    ],
)
def test_configurations_that_cannot_decide_are_refused(fields: dict[str, int], message: str) -> None:
    """Thresholds that noise could pass, or a turn could miss, are refused."""
    with pytest.raises(ValidationError, match=message):
        TurnOffConfig(**fields)


def made() -> TurnOff:
    """The machine with its variables."""
    return build(parts(TurnOffConfig()))


@pytest.mark.thorough
def test_everything_is_proved() -> None:
    """All properties and obligations, without bound."""
    whole = made()
    system = lower(whole.machine)
    known = shipped_runs("turn_off")
    found = [
        *prove(system, properties(whole), Limits(seconds=30), jobs=1, **known),
        *obligations(system, Limits(seconds=30), **known),
    ]
    assert {one.id: word(one.result) for one in found if word(one.result) != "proved"} == {}


@pytest.mark.parametrize(
    ("transition", "broken"),
    [
        ("turns left", "the decided course is true"),
        ("runs straight on", "the decided course is true"),
        ("on the switch", "the noted place is from before the switch"),
    ],
)
def test_a_broken_guard_is_noticed(transition: str, broken: str) -> None:
    """A decision without its threshold, and a place noted on the switch, are found."""
    whole = made()
    own = whole.own
    fields: dict[str, object] = {"when": own.measured}
    if transition == "on the switch":
        fields = {"set": {own.noted_lateral: own.lateral}}
    wrong = changed(whole.machine, transition, **fields)
    names = {prop.name: prop for prop in properties(replace(whole, machine=wrong))}
    assert not inductive(wrong, names.get(broken, names["course is true"]), broken)
