"""Many runs step by step do what the interpreter does, in Python, C and numpy, and their inputs may follow from their outputs."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray

from safeloc.codegen import batch_steps
from safeloc.codegen.batch_steps import Stepped, compile_steps
from safeloc.errors import EngineError, InputError
from safeloc.language.expr import number
from safeloc.language.interpret import run
from safeloc.language.machine import Machine, Transition, modes
from safeloc.language.system import lower
from safeloc.language.units import COUNT
from tests.codegen.c_folder import needs_compiler

FEW, MANY = 3, 19
"""Runs that are stepped in Python, and more than fill any register, by no whole number of them."""


def counting() -> Stepped:
    """A machine that adds what it is given up to 1000, and begins anew beyond; it tells its sum, and whether that is even."""
    (only,) = modes("COUNTING")
    total, given = number("total", COUNT, 0, 1_000), number("given", COUNT, 0, 100)
    added = total + given
    transitions = (
        Transition("begin anew", only, only, added > 1_000, {total: given}),
        Transition("add", only, only, added <= 1_000, {total: added}),
    )
    outputs = {"sum": total, "great": total > 500}
    return compile_steps(
        lower(Machine("counting", (only,), (given,), {total: 7}, outputs, transitions)), ["sum", "great"]
    )


@pytest.fixture(params=["few", pytest.param("C", marks=needs_compiler), "numpy"])
def runs(request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch) -> int:
    """The number of runs that takes the back end."""

    def none() -> str:
        raise EngineError("no C compiler")

    if request.param == "numpy":
        monkeypatch.setattr(batch_steps, "compiler", none)
    return FEW if request.param == "few" else MANY


def test_inputs_that_follow_from_outputs(runs: int) -> None:
    """Every run hears a figure made from what it told before; the interpreter tells the same on the inputs that came of it."""
    code, steps = counting(), 40
    given: NDArray[np.int64] = np.zeros((steps, runs), dtype=np.int64)
    under_way, told = code.begin({"given": given}), []
    assert np.array_equal(np.full(runs, 7), under_way.told["sum"])
    for step in range(steps):
        given[step] = (under_way.told["sum"] * 3 + np.arange(runs) + under_way.told["great"]) % 101
        under_way.step(step)
        told.append({name: values.copy() for name, values in under_way.told.items()})
    assert len({tuple(column) for column in given.T}) == runs
    for one in range(runs):
        trace = run(code.system, [{"given": int(value)} for value in given[:, one]])
        expected = [dict(step.outputs) for step in trace.steps]
        assert expected == [{name: values[one].item() for name, values in row.items()} for row in told]
    assert any(row["great"].any() for row in told)


def test_all_steps_at_once_tell_what_each_step_tells(runs: int) -> None:
    """Where no input follows from what was told, the steps need not be taken one by one."""
    code, given = counting(), np.random.default_rng(1).integers(0, 101, (40, runs))
    under_way, found = code.begin({"given": given}), code.through({"given": given})
    for step in range(len(given)):
        under_way.step(step)
        assert all(np.array_equal(values, found[name][step]) for name, values in under_way.told.items())
    assert found["great"].any()


@pytest.mark.parametrize(
    ("inputs", "says"),
    [
        ({}, r"^counting: input 'given' is missing\.$"),
        ({"given": np.zeros((2, 3))}, r"^counting: input 'given' is float64 \(2, 3\); all inputs must be contiguous"),
        ({"given": np.zeros((3, 2), dtype=np.int64).T}, r"^counting: input 'given' is int64 \(2, 3\); all inputs must"),
    ],
    ids=["missing", "kind", "order"],
)
def test_other_inputs_are_refused(inputs: dict[str, NDArray[np.int64]], says: str) -> None:
    """The C code reads the rows where they lie."""
    with pytest.raises(InputError, match=says):
        counting().begin(inputs)


def test_what_is_no_output_cannot_be_told() -> None:
    """The outputs are named."""
    with pytest.raises(InputError, match=r"^counting: no output 'total'; it has \['sum', 'great'\]\.$"):
        compile_steps(counting().system, ["total"])
