"""The whole localizer as a co-simulation unit: as a user exports it, equal to the interpreter on shipped journeys."""

from __future__ import annotations

import random
from collections.abc import Sequence
from functools import cache
from pathlib import Path
from typing import Any

import pytest

from safeloc.cli.export import export
from safeloc.codegen.c99 import Run
from safeloc.language.interpret import run
from safeloc.language.nodes import Value
from safeloc.language.system import TransitionSystem, without_ghosts
from safeloc.language.trace import Step
from safeloc.proof.drawn_runs.lawful import first_state
from safeloc.proof.drawn_runs.sampled import drawn_run, recorded_run
from safeloc.runtime.streams.gzipped import name_of
from safeloc.shipped_machines import ENTRIES
from safeloc.target import recorded
from tests.codegen.c_folder import needs_compiler
from tests.codegen.fmi_unit import Unit, loaded

pytestmark = [needs_compiler, pytest.mark.slow]  # exporting proves first what a state has to keep: a minute
PERIOD_S = 0.1
JOURNEYS = {name_of(path): path for path in recorded("localizer")}
SHORT, WHOLE, DRAWN = 60, 10_000, 300


@pytest.fixture(scope="module")
def path(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The unit, as `safeloc export localizer --to fmu` writes it."""
    path = tmp_path_factory.mktemp("localizer") / "localizer.fmu"
    export("localizer", "fmu", None, path)
    return path


@cache
def on_board() -> TransitionSystem:
    """The localizer without ghosts."""
    return without_ghosts(ENTRIES["localizer"].make(ENTRIES["localizer"].config()).system)


def interpreted(chosen: Run) -> tuple[Step, ...]:
    """Every step of a run, with all inputs, as the interpreter takes it."""
    return run(on_board(), chosen.steps, first=chosen.first).steps


def simulated(path: Path, steps: Sequence[Step]) -> Any:
    """The outputs that fmpy's master records when it feeds the unit these steps; row n + 1 is after step n."""
    fmpy = pytest.importorskip("fmpy", reason="needs fmpy (extra fmi)")
    numpy = pytest.importorskip("numpy")
    variables = fmpy.read_model_description(str(path)).modelVariables
    inputs = [(one.name, "?" if one.type == "Boolean" else "i8") for one in variables if one.causality == "input"]
    rows = [(n * PERIOD_S, *(step.inputs[name] for name, _ in inputs)) for n, step in enumerate(steps)]
    given = numpy.array(rows, dtype=[("time", "f8"), *inputs])
    outputs = list(steps[0].outputs)
    return fmpy.simulate_fmu(str(path), input=given, stop_time=len(steps) * PERIOD_S, output=outputs)


def require_equal(path: Path, steps: Sequence[Step]) -> None:
    """Every output of every step."""
    result = simulated(path, steps)
    assert len(steps) + 1 == len(result)
    for number, step in enumerate(steps, 1):
        row = {name: int(result[name][number]) for name in step.outputs}
        assert {name: int(value) for name, value in step.outputs.items()} == row, f"step {number}"


def moved(unit: Unit, steps: Sequence[Step], first_number: int = 0) -> list[list[Value]]:
    """Outputs and state after each of these steps."""
    found = []
    for number, step in enumerate(steps, first_number):
        for name, value in step.inputs.items():
            unit.set(name, value)
        unit.slave.doStep(number * PERIOD_S, PERIOD_S)
        found.append(unit.get([*step.outputs, *(f"state.{name}" for name in step.state)]))
    return found


def test_nothing_is_found_wrong(path: Path) -> None:
    """fmpy finds no problem in it, and a communication step is the cycle that its machines are configured for."""
    validation = pytest.importorskip("fmpy.validation", reason="needs fmpy (extra fmi)")
    fmpy = pytest.importorskip("fmpy")
    assert validation.validate_fmu(str(path)) == []
    assert fmpy.read_model_description(str(path)).defaultExperiment.stepSize == str(PERIOD_S)


def test_a_journey_begins_as_interpreted(path: Path) -> None:
    """Under fmpy's own master the first seconds of a shipped journey give the interpreter's outputs."""
    require_equal(path, interpreted(recorded_run(on_board(), JOURNEYS["localizer-metro"], SHORT)))


def test_a_saved_state_goes_on_as_before(path: Path) -> None:
    """A state that was saved as bytes gives the same steps in another instance, also its state variables."""
    steps = interpreted(recorded_run(on_board(), JOURNEYS["localizer-metro"], SHORT))
    expected = [[*step.outputs.values(), *step.state.values()] for step in steps]
    half = SHORT // 2
    with loaded(path) as unit, loaded(path) as other:
        unit.begin({})
        other.begin({})
        assert expected[:half] == moved(unit, steps[:half])
        kept = unit.slave.serializeFMUState(unit.slave.getFMUState())
        assert expected[half:] == moved(unit, steps[half:], half)
        other.slave.setFMUState(other.slave.deserializeFMUState(kept))
        assert expected[half:] == moved(other, steps[half:], half)


@pytest.mark.slow
@pytest.mark.parametrize("journey", JOURNEYS)
def test_a_whole_journey_is_as_interpreted(journey: str, path: Path) -> None:
    """Every output of every step of a shipped journey."""
    require_equal(path, interpreted(recorded_run(on_board(), JOURNEYS[journey], WHOLE)))


@pytest.mark.slow
def test_inputs_that_no_journey_has_are_as_interpreted(path: Path) -> None:
    """Every output on inputs that are in range and keep no assumption."""
    assert first_state(on_board(), random.Random(0)) == first_state(on_board(), random.Random(1))  # nothing to choose
    require_equal(path, interpreted(drawn_run(on_board(), 5, DRAWN, lawful=False)))
