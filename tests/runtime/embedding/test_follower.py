"""A host's object follows the machine behind the border: its callbacks run, and wrong input moves nothing (MRK-2)."""

from __future__ import annotations

import subprocess
import sys
from collections.abc import Callable, Mapping
from itertools import pairwise
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest
from hypothesis import given, seed, settings
from hypothesis import strategies as st

from safeloc.errors import InputError
from safeloc.language.interpret import run
from safeloc.language.machine import STAY_NAME, Machine
from safeloc.language.nodes import Value
from safeloc.language.system import lower, without_ghosts
from safeloc.language.trace import Trace
from safeloc.runtime.border import Reason
from safeloc.runtime.embedding import Controller, Program
from safeloc.target import Target
from tests.data.door_controller import CYCLE_MS
from tests.data.door_controller import machine as door
from tests.examples import EXAMPLES
from tests.random_machines import Record, first_states, machines, streams
from tests.runtime.embedding.driving import trusting

ROOT = Path(__file__).parents[3]
STAND = {"speed": 0, "released": True, "blocked": False}
RUN = {"speed": 5_000, "released": True, "blocked": False}
SHUT = {"speed": 0, "released": False, "blocked": False}
MACHINES = [machine for example in EXAMPLES for machine in example.machines]


def program(machine: Machine) -> Program:
    """The machine alone, made ready to run."""
    return Program(Target(machine.name, (machine,), lower(machine), ()))


def followed(host: object, first: Record | None = None, machine: Machine = door) -> Controller:
    """A controller whose machine the host's object follows."""
    controller = Controller(program(machine), period_ms=CYCLE_MS, first=first)
    controller.follow(host)
    return controller


class Host:
    """A host's controller that notes what it is told."""

    def __init__(self) -> None:
        self.told: list[str] = []

    def on_enter_OPEN(self, event: object) -> None:  # noqa: N802, ARG002 # the name of the mode, as `transitions` has it
        self.told.append("enter OPEN")

    def on_exit_locked(self, event: object) -> None:  # noqa: ARG002
        self.told.append("exit locked")


class Everything:
    """A host with a callback for every mode and moment, in either spelling; it notes what it is told."""

    def __init__(self, machine: Machine, *, small: bool) -> None:
        self.told: list[str] = []
        for mode in machine.modes:
            for moment in ("on_exit", "on_enter"):
                told = f"{moment} {mode.label}"
                setattr(self, f"{moment}_{mode.label.lower() if small else mode.label}", self._teller(told))

    def _teller(self, told: str) -> Callable[[object], None]:
        return lambda event: self.told.append(told)


def expected_calls(machine: Machine, trace: Trace) -> list[list[str]]:
    """Per step of a run, what a host is told: leaving and entering where the mode changes, else nothing."""
    labels = [machine.modes[0].label, *(machine.modes[one.state["mode"]].label for one in trace.steps)]
    return [[f"on_exit {old}", f"on_enter {new}"] if old != new else [] for old, new in pairwise(labels)]


def drive(machine: Machine, stream: list[Record], first: Record, *, small: bool) -> list[str]:
    """Hold a host that follows against the interpreter, step by step; all that it was told."""
    host, heard = Everything(machine, small=small), list[str]()
    trace = run(without_ghosts(lower(machine)), stream, first=first)
    controller = followed(host, first, machine)
    assert not [name for name in dir(host) if name.startswith(("to_", "may_to_"))]
    for record, step, told in zip(stream, trace.steps, expected_calls(machine, trace), strict=True):
        host.told.clear()
        report = controller.step_inputs(record)
        assert host.told == told
        assert host.state == machine.modes[step.state["mode"]].label  # type: ignore[attr-defined]
        assert (report.values, [move.name for move in report.moves]) == (step.outputs, moved(step.fired))
        heard.extend(told)
    return heard


def moved(fired: Mapping[str, str]) -> list[str]:
    """The rows of the table that were taken."""
    return [name for name in fired.values() if name != STAY_NAME]


@pytest.mark.thorough(ordinary=6)
@pytest.mark.parametrize("small", [False, True])
@pytest.mark.parametrize("machine", MACHINES, ids=lambda machine: machine.name)
def test_follows_the_interpreter(machine: Machine, small: bool) -> None:
    """On any stream the host's object is in the interpreter's mode, and callbacks run where the mode changes only."""
    system = without_ghosts(lower(machine))

    @settings(max_examples=12)
    @given(stream=streams(system, 10), first=first_states(system))
    def agree(stream: list[Record], first: Record) -> None:
        drive(machine, stream, first, small=small)

    agree()


@pytest.mark.thorough(ordinary=1)
@pytest.mark.parametrize("small", [False, True])
def test_random_machines_in_a_host(small: bool) -> None:
    """Any machine on any stream: same modes, outputs and rows, and callbacks in either spelling."""
    heard: list[str] = []

    @seed(0)  # a draw of machines that change their modes: of some draws none does
    @settings(max_examples=60)
    @given(data=st.data())
    def agree(data: st.DataObject) -> None:
        machine = data.draw(machines())
        system = without_ghosts(lower(machine))
        heard.extend(drive(machine, data.draw(streams(system)), data.draw(first_states(system)), small=small))

    agree()
    assert heard


def test_callbacks() -> None:
    """Callbacks named after a mode, in its own or in small letters, run when it is entered or left, and only then."""
    host = Host()
    controller = followed(host)
    for record in (RUN, STAND, STAND, SHUT):
        controller.step_inputs(record)
    assert host.told == ["exit locked", "enter OPEN"]
    assert host.is_CLOSING()  # type: ignore[attr-defined]


@pytest.mark.parametrize("name", ["on_enter_OPEN", "on_enter_open"])
def test_any_callable_is_a_callback(name: str) -> None:
    """A function that the host merely holds is called like a method of its own, once, in either spelling."""
    told: list[object] = []
    host = SimpleNamespace(**{name: told.append})
    followed(host).step_inputs(STAND)
    assert (host.state, len(told)) == ("OPEN", 1)


def test_callbacks_see_the_step() -> None:
    """A callback finds the report of the step in its event, and the controller has it already."""
    seen: list[Value | str] = []
    controller = Controller(program(door), period_ms=CYCLE_MS)
    host: Any = SimpleNamespace(on_enter_locked=lambda event: seen.append(event.kwargs["report"].values["closing_for"]))
    host.on_exit_closing = lambda _event: seen.append(controller.report.modes["door"])
    controller.follow(host)
    for record in (STAND, *[SHUT] * 7):
        controller.step_inputs(record)
    assert (host.state, seen) == ("LOCKED", ["LOCKED", 0])


def test_no_mode_is_entered_past_its_guard() -> None:
    """The host gets one trigger: there is none that goes to a mode whatever the inputs are."""
    host = SimpleNamespace()
    followed(host)
    assert not [name for name in vars(host) if name.startswith(("to_", "may_to_"))]
    assert host.follow_machine() is False
    assert host.state == "LOCKED"


@pytest.mark.parametrize(
    ("wrong", "reason"),
    [(10**9, Reason.OUT_OF_RANGE), (1.5, Reason.WRONG_TYPE), (float("nan"), Reason.NOT_FINITE)],
)
def test_the_border_stands_before_the_host(wrong: float, reason: Reason) -> None:
    """What it refuses is told with its reason, and takes a marker of the same cycle with it: no callback runs."""
    host: Any = SimpleNamespace(on_enter_front=pytest.fail)
    controller = Controller(trusting())
    controller.follow(host)
    read = {"front_marker": 7, "front_marker_position_mm": 250_000, "front_marker_accuracy_mm": 500}
    report = controller.step_inputs({**read, "front_wheel_mm": wrong})
    assert [fault.reason for fault in report.rejections] == [reason]
    assert host.state == "DELOCALIZED"


def test_a_machine_that_is_halted_moves_no_host() -> None:
    """A door that was told nothing of its speed is not taken for locked, nor is the host's object."""
    host = Host()
    controller = followed(host)
    controller.step_inputs(STAND)
    with pytest.raises(InputError, match=r"its initial state makes a claim about the world"):
        controller.step_inputs({**STAND, "speed": -1})
    assert (host.state, host.told) == ("OPEN", ["exit locked", "enter OPEN"])  # type: ignore[attr-defined]


@pytest.mark.parametrize("name", ["follow_machine", "state", "is_OPEN"])
def test_a_host_that_has_the_name_already(name: str) -> None:
    """A name of the host that would be replaced is an error."""
    with pytest.raises(InputError, match=name):
        followed(SimpleNamespace(**{name: 1}))


async def awaited(event: object) -> None:
    """A callback that has to be awaited."""


class Awaited:
    """A callable that has to be awaited."""

    async def __call__(self, event: object) -> None:
        """Nothing is done."""


@pytest.mark.parametrize("callback", [awaited, Awaited()])
def test_a_callback_that_nobody_would_await_is_refused(callback: object) -> None:
    """It would never run, and nobody would be told."""
    with pytest.raises(InputError, match=r"^on_enter_open of the host object is a coroutine function, .* queue\.$"):
        followed(SimpleNamespace(on_enter_open=callback))


def test_the_example_of_the_readme_runs(tmp_path: Path) -> None:
    """The lines of README.md run as they stand: out of DELOCALIZED, back into it with its reason in words, and out again."""
    text = (ROOT / "README.md").read_text(encoding="utf-8").partition("## Embedding")[2]
    code = text.partition("```python\n")[2].partition("```")[0]
    assert "controller.follow(" in code
    command = [sys.executable, "-c", f"import sys; sys.path.insert(0, {str(ROOT)!r})\n{code}"]
    done = subprocess.run(command, capture_output=True, text=True, check=False, cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    told = [line if line.startswith("restrictive") else line.split()[0] for line in done.stdout.splitlines()]
    changes = [line for number, line in enumerate(told) if told[max(number - 1, 0)] != line or number == 0]
    out_of_it, back = ["located:", "FRONT"], ["restrictive: SENSOR_FAILURE", "DELOCALIZED"]
    assert changes == ["DELOCALIZED", *out_of_it, *back, *out_of_it]


@pytest.mark.parametrize(
    ("name", "meant"), [("on_enter_lokced", "Did you mean 'on_enter_locked'"), ("on_exit_nowhere", "")]
)
def test_a_callback_of_no_mode_is_refused(name: str, meant: str) -> None:
    """It would never be called; the message names the modes, and the nearest callback."""
    with pytest.raises(
        InputError, match=rf"^{name} of the host object belongs to no mode; the modes are .*LOCKED.*{meant}"
    ):
        followed(SimpleNamespace(**{name: lambda event: None}))


def test_what_only_looks_like_a_callback_stays() -> None:
    """A host may keep a number under such a name."""
    host = SimpleNamespace(on_enter_count=3)
    followed(host)
    assert 3 == host.on_enter_count
