"""The numpy back end does what the interpreter does in every run, and refuses what the interpreter refuses."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray

from safeloc.codegen.batch import BatchTrace, compile_batch, simulate
from safeloc.errors import InputError
from safeloc.language.expr import BoolVar, number, product
from safeloc.language.interpret import read_inputs, run
from safeloc.language.machine import Machine, Transition, modes
from safeloc.language.system import TransitionSystem, lower
from safeloc.language.trace import Trace
from safeloc.language.units import COUNT, MM, Enumeration
from tests.examples import EXAMPLES, Example
from tests.random_machines import Record, first_states, machines, records

ODOMETER = EXAMPLES[0].system
TIMER = next(example.system for example in EXAMPLES if example.name == "timer")


def arrays(system: TransitionSystem, streams: Sequence[Sequence[Mapping[str, object]]]) -> dict[str, NDArray[Any]]:
    """Streams of equal length, one a run, as arrays [step, run]."""
    admitted = [[read_inputs(system, record) for record in stream] for stream in streams]
    return {
        var.name: np.array(
            [[stream[step][var] for stream in admitted] for step in range(len(streams[0]))],
            dtype=bool if isinstance(var, BoolVar) else np.int64,
        )
        for var in system.inputs
    }


def everything(system: TransitionSystem) -> list[str]:
    """All that a batch run can keep."""
    names = [*(var.name for var in system.state), *(var.name for var in system.fired), *system.outputs]
    return list(dict.fromkeys(names))


def assert_same_runs(batch: BatchTrace, traces: Sequence[Trace]) -> None:
    """State, fired transitions and outputs of every step of every run."""
    for run_, trace in enumerate(traces):
        for number_, step in enumerate(trace.steps):
            found = {name: array[number_, run_].item() for name, array in batch.kept.items()}
            expected = {**step.outputs, **step.state, **_fired_numbers(trace, number_)}
            assert expected == found
        last = trace.steps[-1].state if trace.steps else trace.initial
        assert dict(last) == {name: array[run_].item() for name, array in batch.last.items()}


def _fired_numbers(trace: Trace, step: int) -> dict[str, int]:
    numbers = {}
    for var in trace.system.fired:
        assert isinstance(var.unit, Enumeration)
        numbers[var.name] = var.unit.index(trace.steps[step].fired[var.name])
    return numbers


def assert_batch_agrees(data: st.DataObject, system: TransitionSystem) -> None:
    """Three runs of one length, in blocks of two."""
    if not system.inputs:
        return
    steps = data.draw(st.integers(1, 8))
    streams = [data.draw(st.lists(records(system), min_size=steps, max_size=steps)) for _ in range(3)]
    first = data.draw(first_states(system))
    batch = simulate(system, arrays(system, streams), start_state=first, keep=everything(system), block_runs=2)
    assert_same_runs(batch, [run(system, stream, first=first) for stream in streams])


@given(st.data())
def test_random_machines_run_as_interpreted(data: st.DataObject) -> None:
    """On any machine and any streams, numpy and the interpreter agree step by step."""
    assert_batch_agrees(data, lower(data.draw(machines())))


@pytest.mark.thorough(ordinary=1)
@pytest.mark.parametrize("example", EXAMPLES, ids=lambda example: example.name)
def test_examples_run_as_interpreted(example: Example) -> None:
    """On every example machine and any streams, numpy and the interpreter agree step by step."""

    @given(st.data())
    def agree(data: st.DataObject) -> None:
        assert_batch_agrees(data, example.system)

    agree()


@given(st.lists(first_states(TIMER), min_size=1, max_size=5))
def test_every_run_may_start_differently(firsts: list[Record]) -> None:
    """Open first values may be given run by run."""
    start_state = {"left": np.array([first["left"] for first in firsts])}
    restart = np.zeros((3, len(firsts)), dtype=bool)
    batch = simulate(TIMER, {"restart": restart}, start_state=start_state, keep=everything(TIMER))
    assert_same_runs(batch, [run(TIMER, [{"restart": False}] * 3, first=first) for first in firsts])


def odometer_inputs(**changed: NDArray[Any]) -> dict[str, NDArray[Any]]:
    """Two steps of three runs that rest; `changed` replaces or adds arrays."""
    return {"movement": np.zeros((2, 3), dtype=np.int64), "moved": np.zeros((2, 3), dtype=np.int64), **changed}


def one(value: object, *, at: tuple[int, int] = (1, 2), rest: object = 0) -> NDArray[Any]:
    """An array [2 steps, 3 runs] with `value` at one place."""
    array = np.full((2, 3), rest)
    array = array.astype(np.result_type(array, np.asarray(value)))
    array[at] = value
    return array


@pytest.mark.parametrize(
    ("changed", "message"),
    [
        (
            {"movement": one(5001)},
            r"^odometer: input 'movement' at step 1, run 2 is 5001, outside -5000\.\.5000 mm\.$",
        ),
        ({"movement": one(float("nan"))}, r"^odometer: input 'movement' has dtype float64; it takes whole numbers\.$"),
        ({"movement": np.zeros((2, 3))}, r"^odometer: input 'movement' has dtype float64; it takes whole numbers\.$"),
        ({"movement": np.zeros((2, 3), bool)}, r"^odometer: input 'movement' has dtype bool; it takes whole"),
        ({"movement": np.zeros((2, 3), object)}, r"^odometer: input 'movement' has dtype object; it takes whole"),
        ({"movement": one(2**64 - 1, rest=np.uint64(0))}, r"at step 1, run 2 is 18446744073709551615, outside"),
        ({"movement": np.zeros((2, 4), int)}, r"arrays of one shape \[step, run\]; got \[\(2, 3\), \(2, 4\)\]\.$"),
        ({"speed": np.zeros((2, 3), int)}, r"^odometer: unknown inputs \['speed'\]\.$"),
        ({"movement": np.ma.zeros((2, 3), int)}, r"^odometer: input 'movement' is a MaskedArray; it must be a plain"),
        ({"reference": one(7), "reference.present": np.zeros((2, 3), bool)}, r"at step 1, run 2, 'reference.present'"),
        ({"reference.present": one(True, rest=False)}, r"at step 1, run 2, 'reference.present' is True but"),
        ({"reference": one(7), "reference.present": np.ones((2, 3), int)}, r"has dtype int64; it takes booleans\.$"),
    ],
)  # fmt: skip
def test_wrong_inputs_are_refused(changed: dict[str, NDArray[Any]], message: str) -> None:
    """Values that the interpreter refuses are refused in an array too, with array, step and run in the message."""
    with pytest.raises(InputError, match=message):
        simulate(ODOMETER, odometer_inputs(**changed))


def test_a_missing_input_is_refused() -> None:
    """Only optional inputs may be left out."""
    inputs = odometer_inputs()
    del inputs["moved"]
    with pytest.raises(InputError, match=r"^odometer: input 'moved' is missing\.$"):
        simulate(ODOMETER, inputs)


def test_an_array_by_an_old_name_is_refused() -> None:
    """The message says what inputs, state variables and what is kept are called now."""
    height, seen = number("margin_above_mm", MM, 0, 9), number("seen_margin_below_mm", MM, 0, 9)
    (on,) = modes("ON")
    rises = Transition("rise", on, on, set={height: seen})
    gate = lower(Machine("gate", [on], [seen], {height: 0}, {}, [rises]))
    told = np.zeros((2, 3), int)
    missing = r"^gate: input 'seen_margin_below_mm' is missing; 'seen_under_mm' is now 'seen_margin_below_mm'\.$"
    with pytest.raises(InputError, match=missing):
        simulate(gate, {"seen_under_mm": told})
    with pytest.raises(InputError, match=r"^gate: unknown state variables \['over_mm'\]; 'over_mm' is now"):
        simulate(gate, {"seen_margin_below_mm": told}, start_state={"over_mm": np.zeros(3, int)})
    with pytest.raises(InputError, match=r"^gate: cannot keep 'over_mm'; .*; 'over_mm' is now 'margin_above_mm'\.$"):
        simulate(gate, {"seen_margin_below_mm": told}, keep=("over_mm",))


def test_left_out_optional_inputs_are_absent() -> None:
    """An optional input without arrays is absent in every step; with values only, it is present in every step."""
    inputs = odometer_inputs()
    assert simulate(ODOMETER, inputs).last["position"].tolist() == [0, 0, 0]
    inputs["reference"] = one(7)
    assert simulate(ODOMETER, inputs).last["position"].tolist() == [0, 0, 7]


@pytest.mark.parametrize(
    ("start_state", "message"),
    [
        ({"left": np.array([2, 6])}, r"^timer: start 'left' must be 0\.\.5, which run 1 does not satisfy\.$"),
        (
            {"left": np.array([3, 1])},
            r"^timer: the chosen first state must satisfy `initially`, which run 1 does not satisfy\.$",
        ),
        ({"left": np.array([3.0, 4.0])}, r"^timer: start 'left' has dtype float64; it takes whole numbers\.$"),
        ({"left": np.array([3])}, r"^timer: start 'left' has shape \(1,\), expected \(2,\)\.$"),
        (
            {"left": np.array([3, 4]), "mode": np.array([0, 1])},
            r"^timer: start 'mode' must be 0\.\.0, which run 1 does not",
        ),
        ({"left": np.array([3, 4]), "right": np.array([0, 1])}, r"^timer: unknown state variables \['right'\]\.$"),
        ({"left": 1}, r"^timer: the chosen first state breaks `initially`; choose values that satisfy it\.$"),
        ({}, r"^timer: the chosen first state breaks `initially`; choose values that satisfy it\.$"),
    ],
)
def test_wrong_first_states_are_refused(start_state: dict[str, Any], message: str) -> None:
    """First states are held to declaration, range and `initially`, in every run."""
    with pytest.raises(InputError, match=message):
        simulate(TIMER, {"restart": np.zeros((1, 2), dtype=bool)}, start_state=start_state)


def test_a_machine_that_may_overflow_is_refused() -> None:
    """int64 wraps in silence, so terms that might leave 64 bits are refused before anything runs."""
    (only,) = table = modes("ONLY")
    huge, small = number("huge", COUNT, 0, 2**40), number("small", COUNT, 0, 1)
    guard = product(huge, huge) > product(small, small)
    system = lower(Machine("huge", table, [huge, small], {}, {}, [Transition("go", only, only, guard)]))
    with pytest.raises(
        InputError, match=r"^huge: 1 terms may exceed 64 bits, for example .*; narrow the ranges of their variables\.$"
    ):
        compile_batch(system)


def test_unknown_names_to_keep_are_refused() -> None:
    """A misspelt name is an error, not an empty answer."""
    with pytest.raises(InputError, match=r"^timer: cannot keep 'lefft'; it has \['mode', 'left', 'fired'\]\.$"):
        compile_batch(TIMER, ["lefft"])


def test_runs_are_never_left_out() -> None:
    """A block size below one run would leave every run where it started."""
    with pytest.raises(InputError, match=r"^block_runs is 0, keep is \(\); give a block_runs of at least 1"):
        simulate(ODOMETER, odometer_inputs(), block_runs=0)


def test_inputs_are_not_changed() -> None:
    """The caller's arrays are only read."""
    inputs = odometer_inputs(movement=one(40))
    simulate(ODOMETER, inputs)
    assert one(40).tolist() == inputs["movement"].tolist()


def test_constant_truth_values_are_negated_as_truth_values() -> None:
    """Where a state becomes a constant, an output is a plain True, and in Python ~True is -2."""
    (only,) = table = modes("ONLY")
    level, unread = number("level", COUNT, 0, 9), number("unread", COUNT, 0, 9)
    outputs = {"high": ~(level < 4) & ~level.eq(7)}
    system = lower(
        Machine("constant", table, [unread], {level: 0}, outputs, [Transition("go", only, only, set={level: 3})])
    )
    batch = simulate(system, {"unread": np.zeros((1, 2), dtype=np.int64)}, keep=["high", "level"])
    assert [array.tolist() for array in batch.kept.values()] == [[[False, False]], [[3, 3]]]
