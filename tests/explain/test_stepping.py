"""A run by hand: inputs as they are set, rows as they would fire, steps taken back, the run saved."""

from __future__ import annotations

from pathlib import Path

import pytest

from safeloc.catalogue import Target, load_target
from safeloc.errors import InputError
from safeloc.explain.stepping import Stepper
from safeloc.language.interpret import run
from safeloc.language.machine import Machine, Transition, modes
from safeloc.language.system import lower
from safeloc.runtime.streams.steps import read_steps
from tests.explain.pump import LATE, OPEN, TOO_MANY, target


def begun() -> Stepper:
    """The pump, switched on."""
    stepper = Stepper(target(TOO_MANY, LATE, OPEN), {"label": 5})
    stepper.give("go", "true")
    stepper.take()
    return stepper


def test_what_is_set_counts_for_one_step() -> None:
    """The next one begins at rest."""
    stepper = Stepper(target())
    stepper.give("go", "true")
    stepper.give("extra", "2")
    assert stepper.inputs == {"go": "true", "extra": "2"}
    assert stepper.take().fired == {"fired": "begin"}
    assert stepper.inputs == {"go": "false"}
    assert stepper.state["mode"] == "ON"
    assert stepper.outputs == {"strokes": "0", "left": "9"}


def test_rows_say_what_fires_and_what_keeps_the_others() -> None:
    """A refused one with the part of its guard that does not hold."""
    count, cool = begun().rows()
    assert (count.name, count.enabled, count.fires, count.target) == ("count", True, True, "ON")
    assert (cool.name, cool.enabled, cool.fires) == ("cool", False, False)
    assert [(one.text, one.holds, dict(one.values)) for one in cool.why] == [
        ("9 count ≤ strokes", False, {"strokes": "0"})
    ]


def test_an_enabled_row_of_a_later_rank_does_not_fire() -> None:
    """Enabled and firing are told apart."""
    (only,) = modes("ONLY")
    made = Machine(
        "two", (only,), [], {}, {}, [Transition("first", only, only, rank=0), Transition("second", only, only, rank=1)]
    )
    rows = Stepper(Target("two", (made,), lower(made), ())).rows()
    assert [(row.name, row.enabled, row.fires) for row in rows] == [("first", True, True), ("second", True, False)]


def test_steps_taken_back_leave_nothing() -> None:
    """State, inputs and broken properties are those of the shorter run."""
    stepper = begun()
    for _ in range(4):
        stepper.take()
    assert stepper.broken() == {"too many strokes": 5, "off soon": 4}
    stepper.back(3)
    assert (stepper.number, stepper.broken(), stepper.state["strokes"]) == (2, {}, "1")
    with pytest.raises(InputError, match="there are 2 steps to take back, not 3"):
        stepper.back(3)


def test_a_recording_goes_on_until_something_is_set() -> None:
    """What is set replaces the recorded value in this step alone."""
    stepper = Stepper(target(), recorded=[{"go": True}, {"go": False, "extra": 1}, {"go": False}])
    stepper.take()
    assert stepper.inputs == {"go": "false", "extra": "1"}
    stepper.give("extra", "absent")
    assert stepper.inputs == {"go": "false"}
    stepper.take()
    stepper.take()
    assert stepper.inputs == {"go": "false"}
    assert [step.fired["fired"] for step in stepper.trace.steps] == ["begin", "count", "count"]


@pytest.mark.parametrize(
    ("name", "text", "message"),
    [
        ("gone", "1", "pump has no input 'gone'; it has go, extra"),
        ("go", "absent", "input 'go' is never absent"),
        ("go", "3", "go: expected true or false"),
        ("extra", "4", "extra: 4 count is outside 0..3"),
        ("extra", "1_0", "extra: expected a whole number"),
        ("extra", "\u0663", "extra: expected a whole number"),
        ("extra", "much", "extra: expected a whole number"),
        ("extra.present", "true", "pump has no input"),
    ],
)
def test_a_wrong_value_is_refused(name: str, text: str, message: str) -> None:
    """And changes nothing."""
    stepper = Stepper(target())
    with pytest.raises(InputError, match=message):
        stepper.give(name, text)
    assert stepper.inputs == {"go": "false"}


def test_the_saved_run_replays(tmp_path: Path) -> None:
    """With open first values; nothing is written over."""
    stepper, path = begun(), tmp_path / "run.jsonl"
    stepper.take()
    stepper.save(path)
    stream = read_steps(path)
    assert stream.first == {"label": 5}
    again = run(target().system, stream.steps, first=stream.first)
    assert again.steps == stepper.trace.steps
    with pytest.raises(InputError, match=r"run\.jsonl exists"):
        stepper.save(path)
    with pytest.raises(InputError, match="no step was taken"):
        Stepper(target()).save(tmp_path / "none.jsonl")


def test_a_composition_reads_wires_as_the_step_does() -> None:
    """The guard of a later machine sees what the earlier one computes in the same step."""
    loaded = load_target("supervised_odometry")
    recorded = read_steps(next(iter(load_target("odometry").streams)))
    names = {var.name: var for var in loaded.system.inputs}
    stepper = Stepper(
        loaded, recorded=[{name: step.get(name.removeprefix("odometry.")) for name in names} for step in recorded.steps]
    )
    kept = [name for name, value in stepper.recorded[0].items() if value is not None]
    assert kept
    for _ in range(30):
        told = {row.machine: row.name for row in stepper.rows() if row.fires}
        assert told == {name.partition(".")[0]: row for name, row in stepper.take().fired.items() if row != "(stay)"}


def test_laws_that_the_next_step_breaks() -> None:
    """By machine and name; a machine without a world has none."""
    assert begun().broken_laws() == []
    stepper = Stepper(load_target("delocalized"))
    stepper.give("source_valid", "true")
    stepper.give("next_truth_nm", "1000000000000")
    assert stepper.broken_laws() == ["delocalized: a valid position holds the truth"]
