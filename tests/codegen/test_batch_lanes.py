"""The batch in C does what the interpreter and numpy do in every run, on any width of register and any threads."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from safeloc.codegen import batch_lanes, lanes_code
from safeloc.codegen.batch import BatchTrace, simulate
from safeloc.codegen.batch_lanes import LanesBatch, compile_lanes
from safeloc.codegen.c99_build import compiler
from safeloc.codegen.lanes_code import to_lanes
from safeloc.errors import EngineError, InputError
from safeloc.language.expr import Bool, Num, Var, ceil_div, floor_div, ite, maximum, number, product
from safeloc.language.interpret import run
from safeloc.language.machine import Machine, Transition, modes
from safeloc.language.nodes import INT64_MAX, INT64_MIN
from safeloc.language.system import TransitionSystem, canonical, lower, without_ghosts
from safeloc.language.units import COUNT, MM
from safeloc.proof.drawn_runs.sampled import drawn_run, sampled_runs
from safeloc.shipped_machines import ENTRIES
from tests.codegen.c_folder import needs_compiler
from tests.codegen.test_batch import (
    ODOMETER,
    TIMER,
    arrays,
    assert_same_runs,
    everything,
    odometer_inputs,
    one,
)
from tests.examples import EXAMPLES, Example
from tests.random_machines import first_states, machines, records
from tests.shipped import SMALLEST_FIRST

pytestmark = needs_compiler

COLUMNS = [0, 1, 2, 0, 2, 1, 1, 0, 2, 0, 1, 2, 2, 1, 0, 0, 0, 1, 2]
"""The stream (one of three) of each run; the number of runs exceeds the lanes and is no multiple of them."""


def compiled(system: TransitionSystem, folder: Path, threads: int = 2, cc: str | None = None) -> LanesBatch:
    """The system, everything kept."""
    return compile_lanes(system, everything(system), threads=threads, folder=folder, cc=cc)


def spread(found: BatchTrace, columns: Sequence[int]) -> list[BatchTrace]:
    """The runs, a trace for each group of as many as there are streams, in the order of the streams."""
    count = max(columns) + 1
    places = [[place for place, stream in enumerate(columns) if stream == wanted] for wanted in range(count)]
    return [_chosen(found, [places[stream][turn] for stream in range(count)]) for turn in range(min(map(len, places)))]


def _chosen(found: BatchTrace, places: list[int]) -> BatchTrace:
    kept = {name: array[:, places] for name, array in found.kept.items()}
    return BatchTrace(kept, {name: array[places] for name, array in found.last.items()})


def assert_lanes_agree(data: st.DataObject, system: TransitionSystem, batch: LanesBatch) -> None:
    """Nineteen runs of three streams, in blocks, and the three alone, which are fewer than lanes."""
    if not system.inputs:
        return
    steps = data.draw(st.integers(1, 8))
    streams = [data.draw(st.lists(records(system), min_size=steps, max_size=steps)) for _ in range(3)]
    first = data.draw(first_states(system))
    traces = [run(system, stream, first=first) for stream in streams]
    inputs = arrays(system, streams)
    assert_same_runs(simulate(batch, inputs, start_state=first), traces)
    many = {name: array[:, COLUMNS] for name, array in inputs.items()}
    for some in spread(simulate(batch, many, start_state=first, block_runs=8), COLUMNS):
        assert_same_runs(some, traces)


@settings(max_examples=settings.default.max_examples // 3)
@given(st.data())
def test_random_machines_run_as_interpreted(tmp_path_factory: pytest.TempPathFactory, data: st.DataObject) -> None:
    """On any machine and any streams, lanes and the interpreter agree step by step."""
    system = lower(data.draw(machines()))
    assert_lanes_agree(data, system, compiled(system, tmp_path_factory.getbasetemp() / "lanes"))


@pytest.mark.thorough(ordinary=1)
@pytest.mark.parametrize("example", EXAMPLES, ids=lambda example: example.name)
def test_examples_run_as_interpreted(example: Example, tmp_path: Path) -> None:
    """On every example machine and any streams, lanes and the interpreter agree step by step."""
    batch = compiled(example.system, tmp_path)

    @given(st.data())
    def agree(data: st.DataObject) -> None:
        assert_lanes_agree(data, example.system, batch)

    agree()


LARGE = ("fibre_area", "localizer", "localizer_sections", "reflector")
SHIPPED = [pytest.param(name, marks=[pytest.mark.slow] if name in LARGE else []) for name in SMALLEST_FIRST]


@pytest.mark.thorough(ordinary=1)
@pytest.mark.parametrize("name", SHIPPED)
def test_shipped_machines_run_as_interpreted(name: str, tmp_path: Path) -> None:
    """Recorded, simulated, lawful and any streams: lanes, numpy and the interpreter agree, everything of every step."""
    target = ENTRIES[name].make(ENTRIES[name].config())
    system = without_ghosts(target.system)
    batch = compiled(system, tmp_path)
    for sampled in filter(lambda sampled: sampled.steps, sampled_runs(target, steps=25)):
        trace = run(system, sampled.steps, first=sampled.first)
        inputs = {key: np.repeat(array, 11, axis=1) for key, array in arrays(system, [sampled.steps]).items()}
        found = simulate(batch, inputs, start_state=dict(sampled.first or {}))
        by_numpy = simulate(system, inputs, start_state=dict(sampled.first or {}), keep=batch.keep)
        assert_same_runs(found, [trace] * 11)
        assert_same_runs(by_numpy, [trace] * 11)


# ------------------------------------------------------------------ processors


def other_compiler(folder: Path, line: str) -> str:
    """A compiler that does as told by a line of shell, else as the real one."""
    path = folder / "other-cc"
    path.write_text(f"#!/bin/sh\n{line.format(cc=compiler())}\n", encoding="utf-8")
    path.chmod(0o755)
    return str(path)


@pytest.mark.parametrize(
    ("line", "widths"),
    [
        ('exec {cc} "$@" -U__AVX512F__ -U__AVX2__', {2}),
        ('exec {cc} "$@" -U__AVX512F__', {2, 4}),
        ('case "$*" in *-march=native*) exit 1;; esac; exec {cc} "$@"', {2, 4, 8}),
    ],
    ids=["two lanes", "four lanes", "no flag for this processor"],
)
def test_narrower_registers_give_the_same(line: str, widths: set[int], tmp_path: Path) -> None:
    """Results do not depend on the number of lanes, nor on flags for the processor."""
    batch = compiled(ODOMETER, tmp_path, cc=other_compiler(tmp_path, line))
    assert batch.lanes in widths
    movement = np.arange(-9, 13).reshape(2, 11)
    inputs = odometer_like(movement, np.repeat(movement % 3 == 0, 1, axis=0))
    expected = simulate(ODOMETER, inputs, keep=batch.keep)
    found = simulate(batch, inputs)
    assert all((expected.kept[name] == found.kept[name]).all() for name in batch.keep)
    assert all((array == found.last[name]).all() for name, array in expected.last.items())


def odometer_like(movement: NDArray[Any], present: NDArray[Any]) -> dict[str, NDArray[Any]]:
    """Inputs of the odometer: it moves as it says, and reads its place where it may."""
    return {
        "movement": movement,
        "moved": movement,
        "reference": np.where(present, 5, 0),
        "reference.present": present,
    }


def test_libraries_are_kept_for_their_processor(tmp_path: Path) -> None:
    """In a folder, a library is found again; what another processor was compiled for is not."""
    compile_lanes(ODOMETER, folder=tmp_path / "kept")
    compile_lanes(ODOMETER, folder=tmp_path / "kept")
    assert len(list((tmp_path / "kept").iterdir())) == 1
    cc = other_compiler(tmp_path, 'exec {cc} "$@" -DANOTHER_PROCESSOR')
    source = to_lanes(ODOMETER, [])
    assert source.count("run_lanes(") == 1
    compile_lanes(ODOMETER, folder=tmp_path / "kept", cc=cc)
    assert len(list((tmp_path / "kept").iterdir())) == 2


# ------------------------------------------------------------------ what is admitted


@pytest.mark.parametrize(
    ("changed", "message"),
    [
        ({"movement": one(5001)}, r"^odometer: input 'movement' at step 1, run 2 is 5001, outside -5000\.\.5000 mm\.$"),
        ({"movement": one(2**32)}, r"^odometer: input 'movement' at step 1, run 2 is 4294967296, outside"),
        ({"movement": np.zeros((2, 3))}, r"^odometer: input 'movement' has dtype float64; it takes whole numbers\.$"),
        ({"movement": np.zeros((2, 4), int)}, r"arrays of one shape \[step, run\]; got \[\(2, 3\), \(2, 4\)\]\.$"),
        ({"reference": one(7), "reference.present": np.zeros((2, 3), bool)}, r"at step 1, run 2, 'reference.present'"),
    ],
)  # fmt: skip
def test_wrong_inputs_are_refused(changed: dict[str, NDArray[Any]], message: str, tmp_path: Path) -> None:
    """Inputs that numpy's batch refuses are refused here too, with array, step and run in the message."""
    with pytest.raises(InputError, match=message):
        simulate(compiled(ODOMETER, tmp_path), odometer_inputs(**changed))


def test_a_missing_input_is_refused(tmp_path: Path) -> None:
    """Only optional inputs may be left out."""
    inputs = odometer_inputs()
    del inputs["moved"]
    with pytest.raises(InputError, match=r"^odometer: input 'moved' is missing\.$"):
        simulate(compiled(ODOMETER, tmp_path), inputs)


def test_arrays_of_other_layouts_are_read_as_they_are(tmp_path: Path) -> None:
    """Narrow, swapped, strided and transposed arrays mean the same numbers, and are left as they were."""
    batch = compiled(ODOMETER, tmp_path)
    plain = np.arange(20).reshape(2, 10)
    expected = simulate(batch, odometer_like(plain, plain % 4 == 0))
    layouts = [plain.astype(np.int16), plain.astype(">i8"), np.repeat(plain, 2, axis=1)[:, ::2], plain.T.copy().T]
    for layout in layouts:
        found = simulate(batch, odometer_like(layout, plain % 4 == 0))
        assert all((expected.kept[name] == found.kept[name]).all() for name in batch.keep)
        assert (layout == plain).all()


def test_rows_that_are_one_row_in_memory_are_read_again_in_every_step(tmp_path: Path) -> None:
    """An input that is the same in all cycles need not be written out for each; one out of range is refused all the same."""
    batch, row = compiled(ODOMETER, tmp_path), np.arange(10)[None, :]
    for moved in (row % 4 == 0, np.ones((1, 10), dtype=np.bool_)):
        long = [np.repeat(one, 6, axis=0) for one in (row, moved)]
        once = [np.broadcast_to(one, (6, 10)) for one in (row, moved)]
        assert [array.strides[0] for array in once] == [0, 0]
        expected, found = (simulate(batch, odometer_like(*some)) for some in (long, once))
        assert all(np.array_equal(values, found.kept[name]) for name, values in expected.kept.items())
    with pytest.raises(InputError, match=r"input 'movement' at step 0, run 9 is 9999999, outside"):
        simulate(batch, odometer_like(np.broadcast_to(np.where(row == 9, 9_999_999, row), (6, 10)), once[1]))


def test_bytes_that_are_neither_0_nor_1_are_true(tmp_path: Path) -> None:
    """A flag of 2, as other programs may write it, is taken for true by lanes as by numpy."""
    flags = np.array([[0, 1, 2, 255, 0, 4, 0, 128, 0, 1]], dtype=np.uint8).view(np.bool_)
    movement = np.zeros((1, 10), dtype=np.int64)
    inputs = odometer_like(movement, flags)
    assert simulate(compiled(ODOMETER, tmp_path), inputs).last["position"].tolist() == [0, 5, 5, 5, 0, 5, 0, 5, 0, 5]


def test_no_runs_and_no_steps(tmp_path: Path) -> None:
    """Of no runs nothing comes back; after no steps every run is where it began."""
    batch = compiled(ODOMETER, tmp_path)
    for shape in ((3, 0), (0, 12), (0, 1)):
        nothing = np.zeros(shape, dtype=np.int64)
        found = simulate(batch, {"movement": nothing, "moved": nothing})
        assert [0] * shape[1] == found.last["position"].tolist()
        assert all(array.shape == shape for array in found.kept.values())


@pytest.mark.parametrize("runs", [1, 7, 8, 9, 16, 100])
@pytest.mark.parametrize("threads", [1, 3])
def test_every_run_may_start_differently(runs: int, threads: int, tmp_path: Path) -> None:
    """Open first values may be given run by run, however runs are dealt out."""
    left = 2 + np.arange(runs) % 4
    restart = np.zeros((2, runs), dtype=bool)
    found = simulate(
        compiled(TIMER, tmp_path, threads), {"restart": restart}, start_state={"left": left}, block_runs=16
    )
    assert simulate(TIMER, {"restart": restart}, start_state={"left": left}).last["left"].tolist() == list(
        found.last["left"]
    )


def test_wrong_requests_are_refused(tmp_path: Path) -> None:
    """Neither no thread, nor an unknown name, nor a second list of names, nor a compiler that is not there."""
    with pytest.raises(InputError, match=r"^threads is 0; give at least 1\.$"):
        compile_lanes(ODOMETER, threads=0)
    with pytest.raises(InputError, match=r"^timer: cannot keep 'lefft'; it has \['mode', 'left', 'fired'\]\.$"):
        compile_lanes(TIMER, ["lefft"])
    with pytest.raises(InputError, match=r"at least 1, and no keep for a compiled batch\.$"):
        simulate(compiled(ODOMETER, tmp_path), odometer_inputs(), keep=["position"])
    with pytest.raises(EngineError, match=r"^no C compiler: no-such-compiler not found\."):
        compile_lanes(ODOMETER, cc="no-such-compiler")


def test_a_machine_that_may_overflow_is_refused() -> None:
    """Both branches of every choice are computed, so no term at all may leave 64 bits."""
    (only,) = table = modes("ONLY")
    huge, small = number("huge", COUNT, 0, 2**40), number("small", COUNT, 0, 1)
    guard = product(huge, huge) > product(small, small)
    system = lower(Machine("huge", table, [huge, small], {}, {}, [Transition("go", only, only, guard)]))
    with pytest.raises(
        InputError, match=r"^huge: 1 terms may exceed 64 bits, for example .*; narrow the ranges of their variables\.$"
    ):
        compile_lanes(system)


# ------------------------------------------------------------------ arithmetic


def arithmetic() -> TransitionSystem:
    """Division both ways, and the whole range of 64 bits."""
    (only,) = table = modes("ONLY")
    wide, seen = number("wide", MM, INT64_MIN, INT64_MAX), number("seen", MM, INT64_MIN, INT64_MAX)
    down, up = number("down", MM, INT64_MIN, INT64_MAX), number("up", MM, INT64_MIN, INT64_MAX)
    moved: dict[Var, Bool | Num | int | bool] = {
        seen: ite(wide < -1, wide, 7),
        down: floor_div(wide, 3),
        up: ceil_div(maximum(wide, -9), 4),
    }
    return lower(
        Machine("wide", table, [wide], {seen: 0, down: 0, up: 0}, {}, [Transition("see", only, only, set=moved)])
    )


ENDS = np.array([[INT64_MIN, INT64_MIN + 1, -10, -9, -4, -3, -2, -1, 0, 1, 2, 3, 4, 5, INT64_MAX - 1, INT64_MAX]])


def test_whole_range_of_64_bits(tmp_path: Path) -> None:
    """Ranges that end where 64 bits end are held, compared and divided exactly."""
    system = arithmetic()
    traces = [run(system, [{"wide": value}]) for value in ENDS[0].tolist()]
    assert_same_runs(simulate(compiled(system, tmp_path), {"wide": ENDS}), traces)


@pytest.mark.parametrize(
    ("right", "wrong"),
    [
        ("return quotient + (inexact", "return quotient + 0 * (inexact"),
        ("return (condition & then) | (~condition & other)", "return (condition & other) | (~condition & then)"),
        ("(const int64_t *)column + place,", "(const int64_t *)column + (place & 3U),"),
        ("(int64_t *)column + place, &values", "(int64_t *)column + (place & 3U), &values"),
    ],
    ids=["division truncates", "branches swapped", "reads another run", "writes another run"],
)
def test_a_wrong_generator_is_noticed(right: str, wrong: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A change of the generated text gives other values than the interpreter's."""
    assert right in lanes_code._TOP
    monkeypatch.setattr(lanes_code, "_TOP", lanes_code._TOP.replace(right, wrong))
    with pytest.raises(AssertionError):
        test_whole_range_of_64_bits(tmp_path)


# ------------------------------------------------------------------ steps without messages


def balise_runs(system: TransitionSystem) -> dict[str, NDArray[Any]]:
    """Twenty-four runs of drawn rows, each from another place on: messages come to some of them, to none or to all."""
    inputs = arrays(system, [drawn_run(system, 3, 80, lawful=False).steps])
    places = np.arange(50)[:, None] + np.arange(24) // 8
    heard = np.arange(50)[:, None] % 5 < np.array([0] * 8 + [1, 4] * 4 + [1] * 8)
    found = {name: array[places, 0] for name, array in inputs.items()}
    for option in system.optionals:
        present = found[option.present.name] & heard
        found[option.present.name] = present
        found[option.value.name] = np.where(present, found[option.value.name], canonical(option.value))
    return found


def same_as_numpy(system: TransitionSystem, batch: LanesBatch) -> bool:
    """Whether everything of every step is what numpy computes."""
    inputs = balise_runs(system)
    expected, found = simulate(system, inputs, keep=batch.keep), simulate(batch, inputs)
    return all((expected.kept[name] == found.kept[name]).all() for name in batch.keep)


def test_steps_without_messages_are_written_apart(tmp_path: Path) -> None:
    """Where messages make much of the work, they are looked for first, and nothing else comes of it."""
    system = without_ghosts(ENTRIES["balise"].make(ENTRIES["balise"].config()).system)
    source = to_lanes(system, [])
    assert "move_0_calm(state, fired, inputs, place);" in source
    assert "_calm" not in to_lanes(ODOMETER, [])
    assert same_as_numpy(system, compiled(system, tmp_path))


@pytest.mark.thorough(ordinary=1)
@pytest.mark.parametrize("wrong", [") * 0 == 0) {", ") % 256 == 0) {"], ids=["no message", "the first run's only"])
def test_a_message_that_is_overlooked_is_noticed(wrong: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """If flags were not looked at, or not those of all runs, messages would be lost, and the comparison tells."""
    system = without_ghosts(ENTRIES["balise"].make(ENTRIES["balise"].config()).system)
    monkeypatch.setattr(batch_lanes, "to_lanes", lambda *given: to_lanes(*given).replace(") == 0) {", wrong))
    assert not same_as_numpy(system, compiled(system, tmp_path))
