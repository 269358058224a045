"""Generated C does what the interpreter does, under strict flags and sanitizers, and a wrong generator is noticed."""

from __future__ import annotations

import ctypes
import re
from pathlib import Path
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from safeloc.codegen.c99 import Run, library_texts, to_c
from safeloc.codegen.c99_layout import layout_of
from safeloc.codegen.c_loader import CMachine, load_c
from safeloc.errors import InputError
from safeloc.language.composition import compose
from safeloc.language.expr import (
    BoolVar,
    Expr,
    Num,
    Var,
    abs_,
    before,
    boolean,
    floor_div,
    maximum,
    minimum,
    number,
    product,
)
from safeloc.language.interpret import run
from safeloc.language.machine import Machine, Transition, modes
from safeloc.language.nodes import INT64_MAX, INT64_MIN, Past, Value
from safeloc.language.system import TransitionSystem, lower, without_ghosts
from safeloc.language.trace import Trace
from safeloc.language.units import COUNT, MM, ONE
from safeloc.proof.drawn_runs.sampled import sampled_runs
from safeloc.shipped_machines import ENTRIES
from tests.codegen.c_folder import exported, make, needs_compiler, replaced, runs_of
from tests.examples import EXAMPLES, Example
from tests.random_machines import Record, first_states, machines, streams
from tests.shipped import SMALLEST_FIRST

pytestmark = needs_compiler
SLOW_TO_SANITIZE = 60_000  # letters


def example(name: str) -> Example:
    """One of the shared examples."""
    return next(one for one in EXAMPLES if one.name == name)


def assert_same_run(system: TransitionSystem, trace: Trace, stream: list[Record], first: Record, folder: Path) -> None:
    """State, fired transitions and outputs of every step, and outputs of the loop."""
    machine = load_c(system, folder=folder, first=first)
    for record, expected in zip(stream, trace.steps, strict=True):
        outputs = machine.step(record)
        assert dict(expected.outputs) == outputs
        assert dict(expected.fired) == machine.fired
        assert dict(expected.state) == machine.state
    machine.reset(first)
    rows = machine.rows(stream)
    assert [dict(step.outputs) for step in trace.steps] == machine.history(rows)
    machine.reset(first)
    machine.run(rows)
    assert dict(trace.steps[-1].state if trace.steps else trace.initial) == machine.state
    machine.reset(first)
    machine.run_columns(machine.columns(by_column(machine, rows)))
    assert dict(trace.steps[-1].state if trace.steps else trace.initial) == machine.state


def by_column(machine: CMachine, rows: ctypes.Array[Any]) -> list[ctypes.Array[Any]]:
    """The same inputs, an array each."""
    fields = type(machine.rows([]))._type_._fields_[: len(machine.layout.inputs)]
    return [(kind * len(rows))(*(getattr(row, name) for row in rows)) for name, kind in fields]


@settings(max_examples=settings.default.max_examples // 5)
@given(st.data())
def test_random_machines_run_as_interpreted(tmp_path_factory: pytest.TempPathFactory, data: st.DataObject) -> None:
    """On any machine and any stream, generated C and the interpreter agree step by step."""
    system = without_ghosts(lower(data.draw(machines())))
    stream, first = data.draw(streams(system)), data.draw(first_states(system))
    assert_same_run(system, run(system, stream, first=first), stream, first, tmp_path_factory.mktemp("c"))


@pytest.mark.thorough(ordinary=2)
@pytest.mark.parametrize("example", EXAMPLES, ids=lambda example: example.name)
def test_examples_run_as_interpreted(example: Example, tmp_path: Path) -> None:
    """On every example machine and any stream, generated C and the interpreter agree step by step."""
    system = without_ghosts(example.system)

    @given(stream=streams(system, 20), first=first_states(system))
    def agree(stream: list[Record], first: Record) -> None:
        assert_same_run(system, run(system, stream, first=first), stream, first, tmp_path)

    agree()


@pytest.mark.thorough(ordinary=1)
@pytest.mark.parametrize("example", EXAMPLES, ids=lambda example: example.name)
def test_examples_pass_their_own_check(example: Example, tmp_path: Path) -> None:
    """The exported folder compiles under the strictest flags and passes, plain and under sanitizers."""
    folder = exported(tmp_path, example.system)
    code, printed = make(folder, "all", "check", "sanitize")
    assert code == 0, printed
    assert len(re.findall(r"\d+ steps in 3 runs agree", printed)) == 2


@pytest.mark.thorough(ordinary=1)
@pytest.mark.parametrize("name", SMALLEST_FIRST)
def test_shipped_machines_pass_their_own_check(name: str, tmp_path: Path) -> None:
    """Every shipped machine on the beginnings of recorded, simulated and drawn streams; small ones under sanitizers."""
    entry = ENTRIES[name]
    target = entry.make(entry.config())
    runs = sampled_runs(target, steps=25)
    folder = exported(tmp_path, target.system, runs)
    big = (folder / f"{name}.c").stat().st_size > SLOW_TO_SANITIZE
    code, printed = make(folder, *(["check", "CFLAGS=-O1"] if big else ["sanitize"]))
    assert code == 0, printed
    assert f"steps in {len(runs)} runs agree" in printed


@pytest.mark.slow
@pytest.mark.parametrize("name", ENTRIES)
def test_shipped_machines_pass_long_runs_under_sanitizers(name: str, tmp_path: Path) -> None:
    """The same on long stretches, as exported, plain and under sanitizers."""
    entry = ENTRIES[name]
    target = entry.make(entry.config())
    runs = sampled_runs(target, seed=1)
    code, printed = make(exported(tmp_path, target.system, runs), "check", "sanitize")
    assert code == 0, printed
    assert printed.count(f"steps in {len(runs)} runs agree") == 2


# ------------------------------------------------------------------ a wrong generator is noticed

WRONG = {
    "division truncates": ("rounding", "return left / divisor - (left % divisor < 0);", "return left / divisor;"),
    "division rounds up for down": ("rounding", "- (left % divisor < 0)", "+ (left % divisor > 0)"),
    "a comparison is off by one": ("odometer", "> 1000000000", ">= 999999999"),
    "an update is forgotten": ("odometer", "state->margin = 0;\n        outputs", "outputs"),
    "a wrong transition is told": ("doors", "outputs->fired = DOORS_FIRED_OPENED;", "outputs->fired = 0;"),
    "the border lets through": ("odometer", "inputs->movement > 5000", "inputs->movement > 5001"),
    "any state is taken": ("odometer", "state->declaration != ODOMETER_DECLARATION", "state == NULL"),
}


@pytest.mark.thorough(ordinary=3)
@pytest.mark.parametrize("wrong", WRONG)
def test_a_wrong_generator_is_noticed(wrong: str, tmp_path: Path) -> None:
    """A change of the generated step makes the self-check fail, at a named step and value."""
    name, old, new = WRONG[wrong]
    folder = exported(tmp_path, example(name).system, runs_of(example(name).system, steps=150))
    replaced(folder, f"{name}.c", old, new)
    code, printed = make(folder, "check")
    assert code != 0
    assert re.search(
        r"^run \d+, step \d+: (status(?: with a state that was not set)?|output \S+|state \S+) is -?\d+, expected -?\d+$",
        printed,
        re.M,
    )


def test_vectors_without_steps_check_nothing(tmp_path: Path) -> None:
    """Neither the generator nor the check program takes an empty set of steps for agreement."""
    system = without_ghosts(example("doors").system)
    with pytest.raises(
        InputError, match=r"^doors: there are no steps for the self-check; give at least one run with a step\.$"
    ):
        to_c(system, [Run("empty", [])])
    folder = exported(tmp_path, system)
    (folder / "vectors.txt").write_text("# nothing\nbegin\n", encoding="utf-8")
    code, printed = make(folder, "check")
    assert code != 0
    assert "vectors.txt: no steps" in printed


@pytest.mark.parametrize("cut", ["step 1 0\n", "stop 1\n", "step\n"])
def test_damaged_vectors_are_no_agreement(cut: str, tmp_path: Path) -> None:
    """A vector file that was cut off or is none is told."""
    folder = exported(tmp_path, example("doors").system)
    (folder / "vectors.txt").write_text(f"begin\n{cut}", encoding="utf-8")
    code, printed = make(folder, "check")
    assert code != 0
    assert "missing in the vectors" in printed or "expected begin or step" in printed


# ------------------------------------------------------------------ what it can hold


def test_whole_range_of_64_bits(tmp_path: Path) -> None:
    """Ranges that end where 64 bits end are held and compared exactly."""
    (only,) = table = modes("ONLY")
    wide, seen = number("wide", MM, INT64_MIN, INT64_MAX), number("seen", MM, INT64_MIN, INT64_MAX)
    lower_half = boolean("lower_half")
    row = Transition("see", only, only, set={seen: wide, lower_half: wide < 0})
    system = lower(
        Machine("wide", table, [wide], {seen: INT64_MIN, lower_half: True}, {"third": floor_div(seen, 3)}, [row])
    )
    values = [INT64_MIN, INT64_MIN + 1, -1, 0, 1, INT64_MAX - 1, INT64_MAX]
    steps: list[dict[str, Value]] = [{"wide": value} for value in values]
    code, printed = make(exported(tmp_path, system, [Run("ends", steps)]), "check", "sanitize")
    assert code == 0, printed


def test_products_of_constants_are_wide(tmp_path: Path) -> None:
    """A choice between constants, multiplied: nothing is computed in fewer than 64 bits."""
    (only,) = table = modes("ONLY")
    large, seen = boolean("large"), number("seen", ONE, 0, 10**18)
    chosen = number("chosen", ONE, 0, 10**9)
    factor = floor_div(product(chosen, chosen), 1)
    row = Transition("see", only, only, large, {seen: factor})
    machine = Machine("products", table, [large, chosen], {seen: 0}, {"seen": seen}, [row])
    steps: list[dict[str, Value]] = [{"large": True, "chosen": 10**9}, {"large": False, "chosen": 1}]
    code, printed = make(exported(tmp_path, lower(machine), [Run("ends", steps)]), "check", "sanitize")
    assert code == 0, printed


def test_terms_beyond_64_bits_are_refused() -> None:
    """A system that might overflow is not generated; the message names the term."""
    (only,) = table = modes("ONLY")
    wide, seen = number("wide", MM, 0, INT64_MAX), number("seen", MM, 0, INT64_MAX)
    row = Transition("see", only, only, wide + 1 <= 5, {seen: wide})
    with pytest.raises(InputError, match=r"^wide: \(\+ wide 1\) may exceed 64 bits; narrow the ranges"):
        layout_of(lower(Machine("wide", table, [wide], {seen: 0}, {}, [row])))


def test_past_operators_are_refused() -> None:
    """A system whose moves look back cannot run."""
    from dataclasses import replace

    system = example("doors").system
    (flag, *_) = [var for var in system.inputs if isinstance(var, BoolVar)]
    looking_back = replace(system, next={**system.next, flag: Past("once", (flag,))}, state=(*system.state, flag))
    with pytest.raises(InputError, match=r"^doors: past operators cannot run; `observe` the property first\.$"):
        layout_of(looking_back)


NAMES = ("x", "x_", "a.b", "a_b", "a_b_2", "ä", "int", "int64_t", "INT64_C", "state", "t1", "NULL", "9th", "floor_div")


def test_names_that_mean_something_in_c_stay_apart(tmp_path: Path) -> None:
    """Variables called like words of C, of the generated text or of each other are not mixed up; nor is a machine."""
    (only,) = table = modes("ONLY")
    variables = [number(name, COUNT, 0, 99) for name in NAMES]
    turned: dict[Var, Expr | Value] = dict(zip(variables, [*variables[1:], variables[0]], strict=True))
    row = Transition('a "row" /* of ??/ */ \\', only, only, set=turned)
    outputs: dict[str, Expr] = {f"{name}!": var for name, var in zip(NAMES, variables, strict=True)}
    first = dict(zip(variables, range(len(NAMES)), strict=True))
    system = lower(Machine("Turn-table 2", table, [], dict(first), outputs, [row]))
    code, printed = make(exported(tmp_path, system, [Run("turning", [{}] * 20)]), "check", "sanitize")
    assert code == 0, printed


def test_the_text_reads_like_the_table() -> None:
    """Locals for what is read, mode by mode, constants by name; values are written last."""
    text = library_texts(layout_of(without_ghosts(example("doors").system)))["doors.c"]
    assert text[text.index("static inline void advance") : text.index("static inline void show")] == STEP_OF_DOORS


STEP_OF_DOORS = """static inline void advance(doors_state *state, const doors_inputs *inputs, doors_outputs *outputs)
{
    const int64_t mode = state->mode;
    const int64_t command = inputs->command;
    const bool obstructed = inputs->obstructed != 0;
    const int64_t speed = inputs->speed;
    if (mode == DOORS_MODE_CLOSED) {
        if (command == DOORS_COMMAND_TO_OPEN && speed == 0) {
            state->mode = DOORS_MODE_MOVING;
            state->warned = true;
            outputs->fired = DOORS_FIRED_OPEN;
            return;
        }
        outputs->fired = DOORS_FIRED__STAY;
        return;
    }
    if (mode == DOORS_MODE_OPEN) {
        if (command == DOORS_COMMAND_TO_CLOSE) {
            state->mode = DOORS_MODE_MOVING;
            outputs->fired = DOORS_FIRED_CLOSE;
            return;
        }
        outputs->fired = DOORS_FIRED__STAY;
        return;
    }
    if (obstructed) {
        state->mode = DOORS_MODE_OPEN;
        state->warned = true;
        outputs->fired = DOORS_FIRED_OBSTRUCTED;
        return;
    }
    if (command == DOORS_COMMAND_TO_OPEN && speed == 0) {
        state->mode = DOORS_MODE_OPEN;
        outputs->fired = DOORS_FIRED_OPENED;
        return;
    }
    if (command == DOORS_COMMAND_TO_CLOSE || command == DOORS_COMMAND_NOTHING) {
        state->mode = DOORS_MODE_CLOSED;
        state->warned = obstructed;
        outputs->fired = DOORS_FIRED_CLOSED;
        return;
    }
    outputs->fired = DOORS_FIRED__STAY;
    return;
}

"""


def test_nothing_is_allocated_and_nothing_recurs() -> None:
    """The machine's own source calls no allocator and no function of the library; its functions call earlier ones only."""
    entry = ENTRIES["supervised_odometry"]
    layout = layout_of(without_ghosts(entry.make(entry.config()).system))
    source = library_texts(layout)["supervised_odometry.c"]
    code = re.sub(r"/\*.*?\*/|\"[^\"]*\"", "", source, flags=re.DOTALL)
    defined = re.findall(r"^[\w *]*?\b(\w+)\([^;]*?\)\n\{(.*?)^\}", code, re.MULTILINE | re.DOTALL)
    known: set[str] = {"if", "while", "for", "switch", "INT64_C", "UINT64_C"}
    for name, body in defined:
        assert set(re.findall(r"\b(\w+)\(", body)) <= known
        known.add(name)
    assert {"advance", "show", "supervised_odometry_step", "supervised_odometry_restore"} <= known
    assert set(re.findall(r"#include [<\"](.*)[>\"]", source)) == {"supervised_odometry.h", "stdbool.h"}


def test_the_header_tells_units_ranges_and_requirements() -> None:
    """The header describes each field and each transition for the integrator."""
    entry = ENTRIES["odometry"]
    header = library_texts(layout_of(without_ghosts(entry.make(entry.config()).system)), "Told.")["odometry.h"]
    assert "    int64_t front_wheel_mm; /* mm, -" in header
    assert "; read only where front_marker_present is 1 */" in header
    assert re.search(r"ODOMETRY_FIRED_\w+ = \d+, /\* .*: .* -> .*; .*MRK-", header)
    assert "* Told." in header


def test_what_is_computed_already_is_not_declared_again() -> None:
    """A move that two tests depend on in turn, of a machine that hears itself a step late and of one that hears the same wire."""

    def within(term: Num, low: int, high: int) -> Num:
        return maximum(minimum(term, high), low)

    kept, first, second = (number(name, COUNT, -50, 50) for name in ("kept", "first", "second"))
    heard, given_, told, again = (number(name, COUNT, 0, 9) for name in ("heard", "given", "told", "again"))
    m0, _, m2 = ms = modes("M0", "M1", "M2")
    n0, n1, n2 = ns = modes("N0", "N1", "N2")
    moved = within(floor_div(kept, 7) + minimum(heard, 3), -50, 50)
    a = Machine(
        "A", ms, [heard, given_], {kept: 0}, {},
        [Transition("t1", m0, m2), Transition("t2", (m2, m0), m2, set={kept: moved}, rank=1)],
    )  # fmt: skip
    rows = [
        Transition("u0", (n2, n0), n2, again * 2 - again < 3, {first: within(abs_(told) - second, -50, 50)}),
        Transition("u2", (n0, n1), n0, rank=1),
    ]
    b = Machine("B", ns, [told, again], {first: 0, second: 0}, {}, rows)
    wires: dict[Var, Expr] = {heard: within(before(kept), 0, 9), again: heard, told: within(given_, 0, 9)}
    whole = compose("w", [a, b], wires).system
    given_steps = [{"A.given": value} for value in (9, 3, 0, 7, 1)]
    steps = run(whole, given_steps).steps
    machine = load_c(whole)
    for read, step in zip(given_steps, steps, strict=True):
        machine.step(read)
        assert step.state == machine.state
