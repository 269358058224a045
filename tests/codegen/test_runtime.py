"""Embedding in a host: its object follows the machine, its callbacks run, and wrong input changes nothing (MRK-2)."""

from __future__ import annotations

import asyncio
import subprocess
import sys
from collections.abc import Callable, Coroutine
from itertools import pairwise
from pathlib import Path
from types import SimpleNamespace

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from safeloc.codegen.runtime import to_async_fsm, to_fsm
from safeloc.errors import InputError
from safeloc.language.interpret import run
from safeloc.language.machine import Machine
from safeloc.language.nodes import Value
from safeloc.language.system import lower, without_ghosts
from safeloc.language.trace import Trace
from safeloc.models import odometry
from safeloc.models.odometry.simulate import simulate
from safeloc.models.odometry.variables import OdometryConfig
from tests.data.door_controller import machine as door
from tests.examples import EXAMPLES
from tests.random_machines import Record, first_states, machines, streams

ROOT = Path(__file__).parents[2]
STAND = {"speed": 0, "released": True, "blocked": False}
RUN = {"speed": 5_000, "released": True, "blocked": False}
SHUT = {"speed": 0, "released": False, "blocked": False}
LOCKED = door.modes[0].value
MACHINES = [machine for example in EXAMPLES for machine in example.machines]


class Host:
    """A host's controller that notes what it is told."""

    def __init__(self) -> None:
        self.told: list[str] = []

    def on_enter_OPEN(self, event: object) -> None:  # noqa: N802, ARG002 # the name of the mode, as `transitions` has it
        self.told.append("enter OPEN")

    def on_exit_locked(self, event: object) -> None:  # noqa: ARG002
        self.told.append("exit locked")


class AsyncHost:
    """The same with a coroutine."""

    def __init__(self) -> None:
        self.told: list[str] = []

    async def on_enter_open(self, event: object) -> None:  # noqa: ARG002
        await asyncio.sleep(0)
        self.told.append("enter open")


@pytest.mark.parametrize("machine", MACHINES, ids=lambda machine: machine.name)
def test_follows_the_interpreter(machine: Machine) -> None:
    """On any stream the host's object is in the mode, with the values and outputs, that the interpreter computes."""
    system = without_ghosts(lower(machine))

    @settings(max_examples=20)
    @given(stream=streams(system, 10), first=first_states(system))
    def agree(stream: list[Record], first: Record) -> None:
        host = SimpleNamespace()
        embedded = to_fsm(machine, host, first=first)
        for record, expected in zip(stream, run(system, stream, first=first).steps, strict=True):
            host.tick(**record)
            assert host.state == machine.modes[expected.state["mode"]].label
            assert embedded.values == expected.state
            assert embedded.outputs == expected.outputs
            assert embedded.fired == expected.fired["fired"]

    agree()


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


@pytest.mark.parametrize("small", [False, True])
def test_random_machines_in_a_host(small: bool) -> None:
    """Any machine on any stream: same modes, values, outputs and rows, and callbacks where the mode changes only."""
    heard: list[str] = []

    @settings(max_examples=60)
    @given(data=st.data())
    def agree(data: st.DataObject) -> None:
        machine = data.draw(machines())
        system = without_ghosts(lower(machine))
        stream, first = data.draw(streams(system)), data.draw(first_states(system))
        host, trace = Everything(machine, small=small), run(system, stream, first=first)
        embedded = to_fsm(machine, host, first=first)
        assert not [name for name in dir(host) if name.startswith(("to_", "may_to_"))]
        for record, step, told in zip(stream, trace.steps, expected_calls(machine, trace), strict=True):
            host.told.clear()
            host.tick(**record)  # type: ignore[attr-defined]
            assert host.told == told
            assert host.state == machine.modes[step.state["mode"]].label  # type: ignore[attr-defined]
            assert (embedded.values, embedded.outputs) == (step.state, step.outputs)
            assert embedded.fired == step.fired["fired"]
            heard.extend(told)

    agree()
    assert len(heard) > 10


@pytest.mark.parametrize("small", [False, True])
@pytest.mark.parametrize("machine", MACHINES, ids=lambda machine: machine.name)
def test_awaitable_callbacks_of_every_mode(machine: Machine, small: bool) -> None:
    """The asynchronous variant awaits a callback at every change of mode, and none on internal steps."""
    system = without_ghosts(lower(machine))

    @settings(max_examples=8)
    @given(stream=streams(system, 10), first=first_states(system))
    def agree(stream: list[Record], first: Record) -> None:
        host, trace = AwaitedEverything(machine, small=small), run(system, stream, first=first)
        expected = expected_calls(machine, trace)

        async def drive() -> None:
            embedded = to_async_fsm(machine, host, first=first)
            for record, step, told in zip(stream, trace.steps, expected, strict=True):
                host.told.clear()
                await host.tick(**record)  # type: ignore[attr-defined]
                assert host.told == told
                assert (embedded.values, embedded.outputs) == (step.state, step.outputs)

        asyncio.run(drive())

    agree()


class AwaitedEverything(Everything):
    """The same with coroutines, which note what they are told only after a wait."""

    def _teller(self, told: str) -> Callable[[object], Coroutine[None, None, None]]:  # type: ignore[override]
        async def tell(_event: object) -> None:
            await asyncio.sleep(0)
            self.told.append(told)

        return tell


def test_refused_input_of_the_awaitable_variant_changes_nothing() -> None:
    """What the asynchronous variant refuses leaves mode, values and outputs as they were."""

    async def drive() -> None:
        host = SimpleNamespace()
        embedded = to_async_fsm(door, host)
        await host.tick(**STAND)
        before = (host.state, embedded.values, embedded.outputs, embedded.fired)
        with pytest.raises(InputError, match="outside"):
            await host.tick(**{**STAND, "speed": -1})
        assert (host.state, embedded.values, embedded.outputs, embedded.fired) == before
        assert host.state == "OPEN"

    asyncio.run(drive())


def test_odometry_in_a_host() -> None:
    """Odometry embedded in a host passes through the same modes as the interpreter on a simulated run."""
    config, host = OdometryConfig(), SimpleNamespace()
    machine = odometry.machine(config)
    stream = [sensors(record) for record in simulate(config, seed=5, seconds=40)]
    embedded = to_fsm(machine, host)
    modes = []
    for record in stream:
        host.tick(**record)
        modes.append((host.state, embedded.outputs["position_mm"]))
    expected = run(without_ghosts(lower(machine)), stream).steps
    assert modes == [(machine.modes[one.state["mode"]].label, one.outputs["position_mm"]) for one in expected]
    assert len({mode for mode, _ in modes}) >= 2


def sensors(record: dict[str, Value]) -> dict[str, Value]:
    """A simulated step without the truth."""
    return {name: value for name, value in record.items() if not name.endswith("_nm") and name != "truth_mm"}


def test_callbacks() -> None:
    """Callbacks named after a mode, in its own or in small letters, run when it is entered or left, and only then."""
    host = Host()
    to_fsm(door, host)
    for record in (RUN, STAND, STAND, SHUT):
        host.tick(**record)  # type: ignore[attr-defined]
    assert host.told == ["exit locked", "enter OPEN"]
    assert host.is_CLOSING()  # type: ignore[attr-defined]


@pytest.mark.parametrize("name", ["on_enter_OPEN", "on_enter_open"])
def test_any_callable_is_a_callback(name: str) -> None:
    """A function that the host merely holds is called like a method of its own, once, in either spelling."""
    told: list[object] = []
    host = SimpleNamespace(**{name: told.append})
    to_fsm(door, host)
    host.tick(**STAND)
    assert (host.state, len(told)) == ("OPEN", 1)


def test_callbacks_see_the_step() -> None:
    """A callback that runs when a mode is entered sees the values and outputs of that step already."""
    seen: list[Value] = []
    host = SimpleNamespace(on_enter_locked=lambda event: seen.append(embedded.outputs["closing_for"]))
    host.on_exit_closing = lambda event: seen.append(embedded.values["mode"])
    embedded = to_fsm(door, host)
    for record in (STAND, *[SHUT] * 7):
        host.tick(**record)
    assert host.state == "LOCKED"
    assert seen == [LOCKED, 0]


def test_no_mode_is_entered_past_its_guard() -> None:
    """The host gets one trigger: there is none that goes to a mode whatever the inputs are."""
    host = SimpleNamespace()
    embedded = to_fsm(door, host)
    assert not [name for name in vars(host) if name.startswith(("to_", "may_to_"))]
    assert list(embedded.fsm.events) == ["tick"]


@pytest.mark.parametrize(
    ("record", "message"),
    [
        ({"speed": 0, "released": True}, "blocked"),
        ({**STAND, "speed": -1}, "outside"),
        ({**STAND, "speed": 1.5}, "whole number"),
        ({**STAND, "sped": 1}, "sped"),
    ],
)
def test_refused_input_changes_nothing(record: dict[str, object], message: str) -> None:
    """Input that the interpreter refuses is refused, and mode, values and outputs stay."""
    host = SimpleNamespace()
    embedded = to_fsm(door, host)
    for first in (STAND, SHUT, SHUT):
        host.tick(**first)
    before = (host.state, embedded.values, embedded.outputs, embedded.fired)
    with pytest.raises(InputError, match=message):
        host.tick(**record)
    assert (host.state, embedded.values, embedded.outputs, embedded.fired) == before
    assert (host.state, embedded.values["closing_for"]) == ("CLOSING", 500)


def test_inputs_by_position_are_refused() -> None:
    """Inputs go by name; one without a name is refused."""
    host = SimpleNamespace()
    to_fsm(door, host)
    with pytest.raises(InputError, match="takes inputs by name"):
        host.tick(5)


@pytest.mark.parametrize("name", ["tick", "state", "is_OPEN"])
def test_a_host_that_has_the_name_already(name: str) -> None:
    """A name of the host that would be replaced is an error."""
    with pytest.raises(InputError, match=name):
        to_fsm(door, SimpleNamespace(**{name: 1}))


def test_awaitable() -> None:
    """The asynchronous variant awaits its callbacks and goes the same way."""
    host = AsyncHost()

    async def drive() -> list[str]:
        to_async_fsm(door, host)
        states = []
        for record in (RUN, STAND, SHUT):
            await host.tick(**record)  # type: ignore[attr-defined]
            states.append(str(host.state))  # type: ignore[attr-defined]
        return states

    assert asyncio.run(drive()) == ["LOCKED", "OPEN", "CLOSING"]
    assert host.told == ["enter open"]


def test_the_example_of_the_readme_runs(tmp_path: Path) -> None:
    """The lines of README.md run as they stand: out of DELOCALIZED, back into it with its reason in words, and out again."""
    text = (ROOT / "README.md").read_text(encoding="utf-8").partition("## Embedding")[2]
    code = text.partition("```python\n")[2].partition("```")[0]
    assert "to_fsm" in code
    command = [sys.executable, "-c", f"import sys; sys.path.insert(0, {str(ROOT)!r})\n{code}"]
    done = subprocess.run(command, capture_output=True, text=True, check=False, cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    told = [line.split()[0] if line[0].isupper() else line for line in done.stdout.splitlines()]
    changes = [line for number, line in enumerate(told) if told[max(number - 1, 0)] != line or number == 0]
    out_of_it, back = ["located", "FRONT"], ["restrictive: SENSOR_FAILURE", "DELOCALIZED"]
    assert changes == ["DELOCALIZED", *out_of_it, *back, *out_of_it]
