"""Generated Python does what the interpreter does, and reads like the transition table."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

import pytest
from hypothesis import given
from hypothesis import strategies as st

from safeloc.codegen import case_splitting
from safeloc.codegen.compiled import Compiled, compile_rows, compile_system, compile_terms
from safeloc.codegen.python_code import to_python
from safeloc.errors import InputError
from safeloc.language.expr import (
    TRUE,
    Bool,
    BoolVar,
    Expr,
    Lit,
    Num,
    Var,
    abs_,
    all_of,
    any_of,
    as_num,
    between,
    boolean,
    choice,
    enumeration,
    floor_div,
    ite,
    members,
    minimum,
    number,
    optional,
)
from safeloc.language.interpret import evaluate, read_inputs, run, start
from safeloc.language.machine import Machine, Transition, modes
from safeloc.language.nodes import Past, Value
from safeloc.language.system import lower, without_ghosts
from safeloc.language.terms import in_order, variables
from safeloc.language.trace import Trace
from safeloc.language.units import COUNT, MM
from tests.examples import EXAMPLES, Example
from tests.random_machines import Record, first_states, machines, streams


def assert_same_run(code: Compiled, trace: Trace, stream: Sequence[Record], first: Record) -> None:
    """State, fired transitions and outputs of every step, with the state kept inside as well, and both loops."""
    states, state = [], code.first(first)
    tick, now = code.begin(state)
    rows = [code.read(record) for record in stream]
    for row, expected in zip(rows, trace.steps, strict=True):
        state, numbers = code.step(state, row)
        states.append(state)
        assert (numbers, state) == (tick(row), now())
        assert dict(expected.state) == dict(zip(code.state_names, state, strict=True))
        assert dict(expected.fired) == code.fired(numbers)
        assert dict(expected.outputs) == code.named_outputs(state)
    assert states == code.history(rows, code.first(first))
    assert state == code.run(rows, code.first(first))


@given(st.data())
def test_random_machines_run_as_interpreted(data: st.DataObject) -> None:
    """On any machine and any stream, generated Python and the interpreter agree step by step."""
    system = lower(data.draw(machines()))
    stream, first = data.draw(streams(system)), data.draw(first_states(system))
    assert_same_run(compile_system(system), run(system, stream, first=first), stream, first)


@pytest.mark.thorough(ordinary=3)
@pytest.mark.parametrize("example", EXAMPLES, ids=lambda example: example.name)
def test_examples_run_as_interpreted(example: Example) -> None:
    """On every example machine and any stream, generated Python and the interpreter agree step by step."""
    code = compile_system(example.system)

    @given(stream=streams(example.system, 20), first=first_states(example.system))
    def agree(stream: list[Record], first: Record) -> None:
        assert_same_run(code, run(example.system, stream, first=first), stream, first)

    agree()


@given(st.data())
def test_terms_without_branches_have_the_interpreters_values(data: st.DataObject) -> None:
    """Generated code for a list of terms, of which some are parts of others, gives what the interpreter gives, in value and in type."""
    system = lower(data.draw(machines()))
    moves = [*system.next.values(), *system.fired.values()]
    terms = [*moves, *(node for node in in_order(moves) if not isinstance(node, Past)), *moves[:1]]
    function, first = compile_terms([*system.state, *system.inputs], terms), data.draw(first_states(system))
    for record in data.draw(streams(system)):
        values = {**start(system, first), **read_inputs(system, record)}
        found = function([values[var] for var in (*system.state, *system.inputs)])
        assert [(type(one), one) for one in found] == [(type(one), one) for one in evaluate(terms, values)]


def test_names_that_look_alike_stay_apart() -> None:
    """Variables whose names differ only in what Python cannot spell, or in an underscore, are not mixed up."""
    (only,) = table = modes("ONLY")
    names = ("x", "x_", "a.b", "a_b", "a_b_2", "ä", "ö")
    variables = [number(name, COUNT, 0, 9) for name in names]
    turned: dict[Var, Expr | Value] = dict(zip(variables, [*variables[1:], variables[0]], strict=True))
    machine = Machine("turn", table, [], dict(zip(variables, range(7), strict=True)), {}, [_row(only, turned)])
    code = compile_system(lower(machine))
    assert code.step(code.first(), ()) == ((0, 1, 2, 3, 4, 5, 6, 0), (1,))


def _row(mode: Lit, updates: Mapping[Var, Expr | Value], *, when: Bool = TRUE, rank: int = 0) -> Transition:
    return Transition(f"row {rank}", mode, mode, when, updates, rank=rank)


def _long_conjunction() -> Machine:
    """A truth value that says whether 120 inputs are all within narrower bounds."""
    (only,) = table = modes("ONLY")
    heard = [number(f"heard_{n}", COUNT, -9, 9) for n in range(120)]
    within = boolean("within")
    told: dict[Var, Expr] = {within: all_of(between(-8, one, 8) for one in heard)}
    return Machine(
        "judge", table, heard, {within: True}, {"within": within}, [Transition("judge", only, only, set=told)]
    )


def test_a_long_conjunction_stays_one_test() -> None:
    """Each of its parts would be worth a test of its own, but Python has a limit to tests within tests."""
    code = compile_system(lower(_long_conjunction()))
    assert code.step(code.first(), (0,) * 120) == ((0, True), (1,))
    assert code.step(code.first(), (0,) * 119 + (9,)) == ((0, False), (1,))


@pytest.mark.thorough
def test_tests_within_tests_without_end_are_noticed(monkeypatch: pytest.MonkeyPatch) -> None:
    """Without the limit the text cannot be loaded."""
    monkeypatch.setattr(case_splitting, "DEEPEST_CASE", 1_000)
    with pytest.raises(IndentationError):
        compile_system(lower(_long_conjunction()))


@pytest.mark.parametrize("shared", [False, True], ids=["elif", "nested"])
def test_long_tables_compile(shared: bool) -> None:
    """A table of 150 rows is no problem, although Python refuses 100 levels of indentation."""
    (only,) = table = modes("ONLY")
    chosen, sum_ = number("chosen", COUNT, 0, 10**6), number("sum", COUNT, 0, 10**6)
    rows = []
    for rank in range(150):
        term = chosen + rank if shared else chosen
        rows.append(_row(only, {sum_: term}, when=term.eq(2 * rank if shared else rank), rank=rank))
    system = lower(Machine("long", table, [chosen], {sum_: 0}, {}, rows))
    code = compile_system(system)
    assert ((0, 298 if shared else 149), (150,)) == code.step(code.first(), (149,))
    assert code.step(code.first(), (1000,)) == ((0, 0), (0,))


def test_the_text_reads_like_the_table() -> None:
    """One if/elif ladder for all variables; a term that only some rows need is computed only there."""
    idle, busy = table = modes("IDLE", "BUSY")
    load, sum_ = number("load", COUNT, -9, 9), number("sum", COUNT, 0, 99)
    rows = [
        Transition("stop", busy, idle, load.eq(0), {sum_: 0}),
        Transition("work", table, busy, sum_ + abs_(load) <= 99, {sum_: sum_ + abs_(load)}, rank=1),
    ]
    source = to_python(lower(Machine("worker", table, [load], {sum_: 0}, {"sum": sum_}, rows)))
    assert source[source.index("def step") : source.index("\n\n\ndef moving")] == STEP_OF_WORKER


STEP_OF_WORKER = """def step(state, inputs):
    (v_mode, v_sum) = state
    (v_load,) = inputs
    if v_mode == 0:
        t1 = v_sum + (v_load if v_load >= 0 else -v_load)
        if t1 <= 99:
            return (1, t1), (2,)
        return state, (0,)
    if v_load == 0:
        return (0, 0), (1,)
    t2 = v_sum + (v_load if v_load >= 0 else -v_load)
    if t2 <= 99:
        return (1, t2), (2,)
    return state, (0,)"""


def test_what_happens_seldom_costs_nothing_else() -> None:
    """A message, or a measurement out of bounds, is looked for once; without, only what is needed is computed."""
    off, on = table = modes("OFF", "ON")
    verdicts = members("verdict", "GOOD", "FAST", "FAR")
    good, fast, far = verdicts
    speed, message = number("speed", COUNT, 0, 99), optional("message", COUNT, -99, 99)
    seen, way = choice("seen", enumeration(verdicts)), number("way", COUNT, -999, 999)
    verdict = ite(speed > 50, fast, ite(speed > way, far, good))
    told = ite(
        message.present, abs_(message.value - way) + floor_div(message.value * 7, 3) * 2 - abs_(message.value), 0
    )
    moved = ite(verdict.eq(good), way + speed, way) + told
    rows = [
        Transition("run", on, on, between(-999, moved, 999), {way: moved, seen: verdict}),
        Transition("out", on, off, set={seen: verdict}, rank=1),
    ]
    machine = Machine("runner", table, [speed, message], {way: 0, seen: good}, {}, rows)
    source = to_python(without_ghosts(lower(machine)))
    busy, quiet = source[source.index("    if ") : source.index("\n\n\ndef moving")].split("\n    if v_mode == 0:", 1)
    assert busy.startswith("    if v_message_present or (v_speed > 50) or (v_way < v_speed):")
    assert quiet == QUIET_STEP_OF_RUNNER


QUIET_STEP_OF_RUNNER = """
        return state, (0,)
    t6 = v_way + v_speed
    if -999 <= t6 <= 999:
        return (1, t6, 0), (1,)
    return (0, v_way, 0), (2,)"""


def _step_of_one_row(when: Bool, state: dict[Var, int], updates: dict[Var, Expr]) -> str:
    """The generated step of a machine of one mode whose one row has this guard."""
    (on,) = table = modes("ON")
    inputs = [var for var in variables([when, *updates.values()]) if var not in state]
    row = Transition("row", on, on, when, updates)
    source = to_python(without_ghosts(lower(Machine("one_row", table, inputs, dict(state), {}, [row]))))
    return source[source.index(" = inputs\n") + 10 : source.index("\n\n\ndef moving")]


def test_what_is_read_twice_is_named_where_it_is_read_first() -> None:
    """So that a guard computes a distance only where its first part holds."""
    is_open, near, far = boolean("open"), number("near", COUNT, 0, 9), number("far", COUNT, 0, 9)
    step = _step_of_one_row(is_open & (abs_(near - far) > 3) & (minimum(near + far, 7) > 2), {}, {})
    distance, sum_ = (
        "((p1 if (p1 := v_near - v_far) >= 0 else -p1) > 3)",
        "((p2 if (p2 := v_near + v_far) < 7 else 7) > 2)",
    )
    assert f"if {distance} and {sum_}:" in step
    assert "t1 =" not in step


def test_reasons_are_looked_at_as_far_as_it_takes() -> None:
    """A test of many reasons names none of them; which one it was is looked for only where there is one."""
    values = [number(f"value_{n}", COUNT, 0, 9) for n in range(3)]
    reasons = [value * 3 + 1 > 20 for value in values]
    why = number("why", COUNT, 0, 3)
    told: Num = as_num(0, COUNT)
    for at, reason in enumerate(reasons, 1):
        told = ite(reason, as_num(at, COUNT), told)
    tests = [f"((v_value_{n} * 3) + 1) > 20" for n in range(3)]
    step = _step_of_one_row(any_of(reasons), {why: 0}, {why: told}).splitlines()
    assert [f"    if ({tests[0]}) or ({tests[1]}) or ({tests[2]}):", f"        if {tests[2]}:"] == step[:2]


def test_what_saves_work_either_way_is_decided_first() -> None:
    """Two values that only one side of a condition needs are computed only there."""
    side, one, two = number("side", COUNT, 0, 1), number("one", COUNT, 0, 99), number("two", COUNT, 0, 99)
    left, right = number("left", COUNT, 0, 10**6), number("right", COUNT, 0, 10**6)
    is_left = side.eq(0)
    updates: dict[Var, Expr] = {
        left: ite(is_left & (one * 3 + two * 5 > 9), abs_(one - two) * 7, 0),
        right: ite(~is_left & (two * 9 - one * 4 > 11), minimum(one, two) * 6, 0),
    }
    step = _step_of_one_row(TRUE, {left: 0, right: 0}, updates)
    then, other = step.split("    if v_side == 0:\n")[1].split("\n    if ", 1)
    assert ("* 9" in then, "* 9" in other, "* 5" in then, "* 5" in other) == (False, True, True, False)


def test_composed_machines_are_told_apart_by_their_modes() -> None:
    """Also where a composition has renamed the mode variables; each machine looks at its own."""
    source = to_python(next(example for example in EXAMPLES if example.name == "alarm_chain").system)
    assert "    while True:  # judge\n        if v_judge_mode == 1:\n" in source
    assert "    while True:  # brake\n        if v_brake_mode == 0:\n" in source


def test_raw_inputs_are_refused_as_by_the_interpreter() -> None:
    """`read` admits nothing that the interpreter refuses."""
    code = compile_system(without_ghosts(EXAMPLES[0].system))
    assert code.read({"movement": 100}) == (100, False, 0)
    with pytest.raises(InputError, match=r"^movement: 5001 mm is outside -5000\.\.5000\.$"):
        code.read({"movement": 5001})
    with pytest.raises(InputError, match=r"^movement: expected a whole number of mm, got nan\.$"):
        code.read({"movement": float("nan")})


def test_a_first_value_can_be_chosen_only_where_it_is_open() -> None:
    """`first` takes values for ANY variables and refuses others."""
    example = next(example for example in EXAMPLES if example.name == "timer")
    code = compile_system(without_ghosts(example.system))
    assert code.first({"left": 4}) == (0, 4)
    with pytest.raises(InputError, match="breaks `initially`"):
        code.first({"left": 1})


def test_past_operators_are_refused() -> None:
    """A system whose moves look back cannot run; the message says what to do."""
    system = EXAMPLES[0].system
    (flag,) = [var for var in system.inputs if isinstance(var, BoolVar)]
    looking_back = replace(system, next={**system.next, flag: Past("once", (flag,))}, state=(*system.state, flag))
    with pytest.raises(InputError, match=r"^odometer: past operators cannot run; `observe` the property first\.$"):
        to_python(looking_back)


def test_terms_over_several_rows_take_what_they_read() -> None:
    """Each variable comes from its own row; what is not read may be anything, even missing."""
    far, near, flag = number("far", MM, 0, 9), number("near", MM, 0, 9), boolean("flag")
    judge = compile_rows({"before": (near,), "inputs": (flag, far)}, [flag & (near < far), far - near])
    assert (True, 2) == judge((3,), (True, 5))
    assert (False, -1) == judge((3,), (True, 2))
    assert (7,) == compile_rows({"before": (near,), "inputs": (flag, far)}, [near + 4])((3,), ())
