"""A machine as a script does what generated Python and the interpreter do, exactly, and explains itself as `safeloc step` does."""

from __future__ import annotations

import json
import random
import runpy
from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from safeloc.codegen.compiled import compile_system
from safeloc.codegen.javascript import STREAM_SCHEMA, common, javascript, on_board
from safeloc.errors import InputError
from safeloc.explain.failing_parts import failing_parts
from safeloc.explain.pytest_file import run_file, run_file_pieces
from safeloc.explain.stepping import Stepper
from safeloc.language.expr import (
    TRUE,
    Bool,
    BoolVar,
    Expr,
    Var,
    abs_,
    boolean,
    ceil_div,
    choice,
    enumeration,
    floor_div,
    ite,
    maximum,
    members,
    minimum,
    number,
    optional,
    product,
)
from safeloc.language.interpret import evaluate, fired_names, outputs, read_inputs, run, start, step
from safeloc.language.machine import ANY, Initial, Machine, Transition, modes
from safeloc.language.monitor import Broken, Holds, Monitor
from safeloc.language.nodes import INT64_MAX, INT64_MIN, Past, Value
from safeloc.language.spec import observe
from safeloc.language.system import TransitionSystem, lower, without_ghosts
from safeloc.language.units import COUNT, MM, ONE
from safeloc.models.emitter import EmitterConfig
from safeloc.proof.drawn_runs.lawful import first_state
from safeloc.proof.drawn_runs.sampled import drawn_run, recorded_run
from safeloc.proof.verification.replay import read_recording
from safeloc.runtime.streams.steps import SCHEMA, write_steps
from safeloc.shipped_machines import ENTRIES
from safeloc.target import Target
from tests.codegen.explained import broken, explained, part_told, unfolded_rows, without_wires
from tests.codegen.in_node import Node, NodeError, as_json, expected, loaded, needs_node, node, state_told, told
from tests.examples import EXAMPLES, Example
from tests.explain import pump
from tests.random_machines import Record, first_states, machines, streams
from tests.shipped import SMALLEST_FIRST

__all__ = ["node"]


def example(name: str) -> Example:
    """One of the shared examples."""
    return next(one for one in EXAMPLES if one.name == name)


def assert_same_run(node: Node, system: TransitionSystem, stream: Sequence[Mapping[str, Any]], first: Record) -> None:
    """State, outputs and fired transitions of every step, and why each transition of the mode is enabled or refused."""
    state = start(system, first)
    assert node.ask("first", as_json(first)) == state_told(system, row_of(system, state))
    for record in stream:
        inputs = read_inputs(system, record)
        given = as_json(record)
        assert node.ask("call", "explain", given) == explained(system, state, inputs)
        assert node.ask("call", "broken", given) == broken(system, state, inputs)
        expected_rows = unfolded_rows(system, state, inputs, 3)
        assert without_wires(node.ask("unfold", given, 3), expected_rows) == expected_rows
        state, fired = step(system, state, inputs)
        made = node.ask("step", given)
        assert made["state"] == state_told(system, row_of(system, state))
        assert made["fired"] == list(fired_names(fired).values())
        shown = outputs(system, state)
        stand_in = {name for name, value in made["outputs"].items() if value is None}
        assert {name: told(system.outputs[name], value) for name, value in shown.items() if name not in stand_in} == {
            name: value for name, value in made["outputs"].items() if name not in stand_in
        }


def row_of(system: TransitionSystem, state: Mapping[Var, Value]) -> tuple[Value, ...]:
    """The values in the order of the system."""
    return tuple(state[var] for var in system.state)


# ------------------------------------------------------------------ as Python and the interpreter


@needs_node
@settings(max_examples=40)
@given(data=st.data())
def test_random_machines_run_as_interpreted(node: Node, data: st.DataObject) -> None:
    """On any machine and any stream, the script and the interpreter agree step by step, and on why."""
    system = lower(data.draw(machines()))
    stream, first = data.draw(streams(system)), data.draw(first_states(system))
    loaded(node, system, first)
    assert_same_run(node, system, stream, first)


@pytest.mark.thorough(ordinary=3)
@needs_node
@pytest.mark.parametrize("example", EXAMPLES, ids=lambda example: example.name)
def test_examples_run_as_interpreted(node: Node, example: Example) -> None:
    """On every example machine and any stream, the script and the interpreter agree step by step, and on why."""

    @settings(max_examples=15)
    @given(stream=streams(example.system, 12), first=first_states(example.system))
    def agree(stream: list[Record], first: Record) -> None:
        assert_same_run(node, example.system, stream, first)

    loaded(node, example.system, first_state(example.system, random.Random(0)))
    agree()


@needs_node
@pytest.mark.thorough(ordinary=1)
@pytest.mark.parametrize("name", SMALLEST_FIRST)
def test_shipped_machines_run_as_interpreted(node: Node, name: str) -> None:
    """Every shipped machine, with its world and on board, on the beginning of a recording and on drawn inputs."""
    entry = ENTRIES[name]
    target = entry.make(entry.config())
    board = on_board(target.system)
    loaded(node, board, first_state(board, random.Random(0)))
    runs = [recorded_run(board, path, 15) for path in target.streams[:1]]
    for one in [*runs, drawn_run(board, 1, 15, lawful=False)]:
        assert_same_run(node, board, one.steps, dict(one.first or {}))
    whole, first = target.system, first_state(target.system, random.Random(0))
    loaded(node, whole, first)
    assert_same_run(node, whole, _with_ghosts(whole), first)


def _with_ghosts(system: TransitionSystem) -> list[dict[str, object]]:
    """Five steps at rest, and five with every input at an end of its range, the world's choices among them."""
    draw = random.Random(3)
    optional_names = {option.present.name for option in system.optionals}
    steps = []
    for at in range(10):
        values: dict[str, object] = {}
        for var in system.inputs:
            if var.name in optional_names:
                continue
            if isinstance(var, BoolVar):
                values[var.name] = at >= 5 and draw.random() < 0.5
            else:
                values[var.name] = draw.choice((var.low, var.high)) if at >= 5 else min(max(0, var.low), var.high)
        steps.append(values)
    return steps


@needs_node
def test_a_run_agrees_with_generated_python(node: Node) -> None:
    """The comparison of the long run (`make test-long TOPIC=javascript`), on one machine."""
    system = without_ghosts(example("odometer").system)
    code = compile_system(system)
    loaded(node, system)
    state = code.first()
    node.ask("first", {})
    for movement in (100, -40, 5000, 0, -5000):
        state, numbers = code.step(state, code.read({"movement": movement}))
        assert node.ask("step", {"movement": movement}) == expected(code, state, numbers)


WRONG = {
    "division truncates": ("rounding", "value%divisor<0n?quotient-1n:quotient", "quotient"),
    "a comparison is off by one": ("odometer", "1000000000n", "999999999n"),
    "an update is forgotten": ("odometer", "o[2]=0n;", ""),
    "a wrong transition is told": ("doors", "f[0]=1n", "f[0]=2n"),
}


def assert_same_drawn_runs(node: Node, system: TransitionSystem) -> None:
    """Three runs of inputs anywhere in range."""
    for seed in range(3):
        run = drawn_run(system, seed, 150, lawful=False)
        assert_same_run(node, system, run.steps, dict(run.first or {}))


@needs_node
@pytest.mark.parametrize("wrong", WRONG)
def test_a_wrong_generator_is_noticed(node: Node, wrong: str) -> None:
    """A change of the generated step makes some run differ from the interpreter's."""
    name, old, new = WRONG[wrong]
    system = without_ghosts(example(name).system)
    text = javascript(system).replace(" % ", "%").replace(" < ", "<").replace(" - ", "-").replace(" ? ", "?")
    text = text.replace(" : ", ":")
    assert old in text
    node.load(text.replace(old, new))
    with pytest.raises(AssertionError):
        assert_same_drawn_runs(node, system)


# ------------------------------------------------------------------ values computed by hand


def one_row(
    inputs: Sequence[Any], state: Mapping[Var, Initial], updates: Mapping[Var, Expr | Value], *, when: Bool = TRUE
) -> TransitionSystem:
    """A machine of one mode whose one row sets these values."""
    (on,) = table = modes("ON")
    shown: dict[str, Expr] = {var.name: var for var in state}
    row = Transition("go", on, on, when, updates)
    return lower(Machine("by_hand", table, list(inputs), dict(state), shown, [row]))


def stepped(node: Node, inputs: Mapping[str, object]) -> dict[str, Any]:
    """The state after one step from the first state."""
    node.ask("first", {})
    made: dict[str, Any] = node.ask("step", inputs)["state"]
    return made


@needs_node
def test_division_rounds_as_declared(node: Node) -> None:
    """Towards minus or plus infinity, of negative numbers too; JavaScript's own division rounds towards zero."""
    value, floor, ceiling = number("value", MM, -9, 9), number("floor", MM, -9, 9), number("ceiling", MM, -9, 9)
    system = one_row([value], {floor: 0, ceiling: 0}, {floor: floor_div(value, 4), ceiling: ceil_div(value, 4)})
    loaded(node, system)
    by_hand = {-9: (-3, -2), -8: (-2, -2), -7: (-2, -1), -1: (-1, 0), 0: (0, 0), 1: (0, 1), 4: (1, 1), 9: (2, 3)}
    for given_value, (down, up) in by_hand.items():
        after = stepped(node, {"value": given_value})
        assert (after["floor"], after["ceiling"]) == (str(down), str(up))


@needs_node
def test_extremes_and_magnitudes(node: Node) -> None:
    """The smaller, the greater and the magnitude, with operands that are computed and so named within the expression."""
    left, right = number("left", MM, -100, 100), number("right", MM, -100, 100)
    small, great, size = (number(name, MM, -300, 300) for name in ("small", "great", "size"))
    updates = {small: minimum(left + 1, right - 1), great: maximum(left + 1, right - 1), size: abs_(left - right)}
    loaded(node, one_row([left, right], {small: 0, great: 0, size: 0}, updates))
    for one, other, by_hand in ((3, 3, ("2", "4", "0")), (-100, 100, ("-99", "99", "200")), (7, -7, ("-8", "8", "14"))):
        after = stepped(node, {"left": one, "right": other})
        assert (after["small"], after["great"], after["size"]) == by_hand


@needs_node
def test_64_bits_are_exact(node: Node) -> None:
    """The ends of 64 bits are held, compared and divided exactly, where floating point would round."""
    wide, third, below = (
        number("wide", MM, INT64_MIN, INT64_MAX),
        number("third", MM, INT64_MIN, INT64_MAX),
        boolean("below"),
    )
    system = one_row([wide], {third: 0, below: False}, {third: floor_div(wide, 3), below: wide < INT64_MAX})
    loaded(node, system)
    by_hand = {
        INT64_MIN: ("-3074457345618258603", True),
        INT64_MAX - 1: ("3074457345618258602", True),
        INT64_MAX: ("3074457345618258602", False),
        2**53 + 1: ("3002399751580331", True),
    }
    for value, (quotient, is_below) in by_hand.items():
        after = stepped(node, as_json({"wide": value}))
        assert (after["third"], after["below"]) == (quotient, is_below)


@needs_node
def test_products_beyond_floating_point_are_exact(node: Node) -> None:
    """999 999 999 times itself has more digits than a floating-point number."""
    factor, result = number("factor", ONE, 0, 10**9), number("result", ONE, 0, 10**18)
    loaded(node, one_row([factor], {result: 0}, {result: product(factor, factor)}))
    assert stepped(node, {"factor": 999_999_999})["result"] == "999999998000000001"


@needs_node
def test_an_overflow_is_an_error(node: Node) -> None:
    """Where a term of the step leaves 64 bits, nothing moves; C refuses such a machine altogether."""
    wide, seen = number("wide", MM, 0, INT64_MAX), boolean("seen")
    loaded(node, one_row([wide], {seen: False}, {seen: wide + 1 <= 5}))
    assert stepped(node, {"wide": 4})["seen"] is True
    with pytest.raises(NodeError, match=r"^Error: a value of the step, 9223372036854775808, exceeds 64 bits\.$"):
        stepped(node, as_json({"wide": INT64_MAX}))


@needs_node
def test_a_state_may_leave_its_range_but_not_64_bits(node: Node) -> None:
    """A machine of the user's that leaves a range goes on as in the interpreter, until a value exceeds 64 bits."""
    factor, value = number("factor", ONE, 0, 10**9), number("value", ONE, 1, 9)
    loaded(node, one_row([factor], {value: 9}, {value: product(factor, value)}))
    node.ask("first", {})
    made = [node.ask("step", {"factor": 10**9})["state"]["value"] for _ in range(2)]
    assert made == ["9000000000", "9000000000000000000"]
    with pytest.raises(NodeError, match=r"^Error: by_hand: value would be 9{1}0{27}, which exceeds 64 bits\.$"):
        node.ask("step", {"factor": 10**9})
    with pytest.raises(NodeError, match=r"^RangeError: value: 9223372036854775808 1 exceeds 64 bits\.$"):
        node.ask("raw", "machine.step({...state, value: 2n**63n}, {factor: 0n})")


@needs_node
def test_absent_inputs(node: Node) -> None:
    """An optional input may be left out or null; it then holds the value nearest to zero, and its flag is false."""
    heard, was, last = optional("heard", MM, 5, 9), boolean("was"), number("last", MM, 0, 9)
    loaded(node, one_row([heard], {was: False, last: 0}, {was: heard.present, last: heard.value}))
    for given_inputs, by_hand in (
        ({"heard": 7}, (True, "7")),
        ({}, (False, "5")),
        ({"heard": None}, (False, "5")),
        ({"heard": 7, "heard.present": True}, (True, "7")),
        ({"heard": 5, "heard.present": False}, (False, "5")),
    ):
        after = stepped(node, given_inputs)
        assert (after["was"], after["last"]) == by_hand
    with pytest.raises(NodeError, match=r"^RangeError: by_hand: heard\.present is false but heard is 7n\.$"):
        stepped(node, {"heard": 7, "heard.present": False})


@needs_node
def test_booleans_and_members(node: Node) -> None:
    """Truth values come back as truth values, members as their labels."""
    colours = red, green, blue = members("colour", "RED", "GREEN", "BLUE")
    seen, a, b = choice("seen", enumeration(colours)), boolean("a"), boolean("b")
    kept, odd, both = choice("kept", enumeration(colours)), boolean("odd"), boolean("both")
    updates: dict[Var, Expr | Value] = {
        kept: ite(a, seen, ite(b, blue, red)),
        odd: (a & ~b) | (~a & b),
        both: ite(a, b, seen.eq(green)),
    }
    loaded(node, one_row([seen, a, b], {kept: red, odd: False, both: False}, updates))
    for (colour, one, other), by_hand in {
        ("GREEN", True, False): ("GREEN", True, False),
        ("GREEN", False, True): ("BLUE", True, True),
        ("BLUE", False, False): ("RED", False, False),
        ("RED", True, True): ("RED", False, True),
    }.items():
        after = stepped(node, {"seen": colour, "a": one, "b": other})
        assert (after["kept"], after["odd"], after["both"]) == by_hand


@needs_node
def test_modes_and_priorities(node: Node) -> None:
    """The first enabled row fires; of none the machine stays, and says so."""
    idle, busy = table = modes("IDLE", "BUSY")
    load, sum_ = number("load", COUNT, -9, 9), number("sum", COUNT, 0, 20)
    rows = [
        Transition("stop", busy, idle, load.eq(0), {sum_: 0}),
        Transition("work", table, busy, sum_ + abs_(load) <= 20, {sum_: sum_ + abs_(load)}, rank=1),
    ]
    loaded(node, lower(Machine("worker", table, [load], {sum_: 0}, {"total": sum_}, rows)))
    node.ask("first", {})
    made = [node.ask("step", {"load": one}) for one in (-9, 9, 5, 0, 0)]
    assert [one["fired"] for one in made] == [["work"], ["work"], ["(stay)"], ["stop"], ["work"]]
    assert [one["state"]["mode"] for one in made] == ["BUSY", "BUSY", "BUSY", "IDLE", "BUSY"]
    assert [one["outputs"]["total"] for one in made] == ["9", "18", "18", "0", "0"]


@needs_node
def test_a_refused_transition_says_why(node: Node) -> None:
    """The conjunct that is false with the values in it; of an enabled one the guard alone."""
    near, far, ready = number("near", MM, 0, 99), number("far", MM, 0, 99), boolean("ready")
    (on,) = table = modes("ON")
    row = Transition("go", on, on, ready & (near + 5 <= far))
    loaded(node, lower(Machine("gate", table, [near, far, ready], {}, {}, [row])))
    node.ask("first", {})
    (told_row,) = node.ask("call", "explain", {"near": 30, "far": 20, "ready": True})
    assert (told_row["transition"], told_row["enabled"], told_row["fires"]) == ("go", False, False)
    whole, part = told_row["parts"]
    assert whole == {
        "text": "ready and ((near + 5 mm) ≤ far)", "value": False, "depth": 0, "values": {}, "leftOut": 0,
    }  # fmt: skip
    values = {"near + 5 mm": "35", "far": "20", "near": "30"}
    assert part == {"text": "(near + 5 mm) ≤ far", "value": False, "depth": 1, "values": values, "leftOut": 0}
    (told_row,) = node.ask("call", "explain", {"near": 15, "far": 20, "ready": True})
    assert [(one["depth"], one["value"]) for one in told_row["parts"]] == [(0, True)]


@needs_node
def test_a_composition_reads_what_earlier_machines_moved(node: Node) -> None:
    """Fired transitions in the order of the step; the second machine sees the new value of the first."""
    system = example("alarm_chain").system
    loaded(node, on_board(system))
    assert node.ask("raw", "machine.machines") == [machine.name for machine in example("alarm_chain").machines]
    run = drawn_run(system, 3, 40, lawful=False)
    assert_same_run(node, on_board(system), run.steps, dict(run.first or {}))
    assert len(node.ask("step", run.steps[0])["fired"]) == 2


@needs_node
def test_the_configuration_reaches_the_script(node: Node) -> None:
    """A pattern that is due after 3 cycles has failed to come in the fourth step; one due after 20 has not."""
    for due, by_hand in ((3, "pattern does not come"), (20, "wait for the first pattern")):
        config = EmitterConfig(due_cycles=due, window_cycles=1, answer_cycles=2)
        loaded(node, on_board(ENTRIES["emitter"].make(config).system))
        node.ask("first", {})
        made = [node.ask("step", {"test_requested": False}) for _ in range(4)]
        assert [one["fired"] for one in made] == [["wait for the first pattern"]] * 3 + [[by_hand]]
        assert [one["outputs"]["next_due_in_cycles"] for one in made[:3]] == [str(due - at) for at in (1, 2, 3)]


@needs_node
def test_named_terms_have_their_values(node: Node) -> None:
    """Those that the machine names, and in a composition the wired inputs of each machine, as the interpreter has them."""
    entry = ENTRIES["fibre_handover"]
    target = entry.make(entry.config())
    board = on_board(target.system)
    loaded(node, board, first_state(board, random.Random(0)))
    run = drawn_run(board, 4, 10, lawful=False)
    state = start(board, run.first)
    node.ask("first", as_json(run.first or {}))
    names = {one["name"] for one in node.ask("raw", "machine.named")}
    for record in run.steps:
        inputs = read_inputs(board, record)
        found = node.ask("call", "values", as_json(record))
        assert found.keys() == names
        for part in board.parts:
            for name, term in part.machine.definitions.items():
                [value] = evaluate([part.in_a_step(term)], {**state, **inputs})
                assert found[f"{part.name}.{name}"] == told(term, value)
        node.ask("step", as_json(record))
        state, _ = step(board, state, inputs)


# ------------------------------------------------------------------ claims


def assert_same_claims(node: Node, target: Target, steps: Sequence[Mapping[str, Any]], first: Record) -> set[str]:
    """What becomes of each property in each step, and of a broken one the parts that fail, as the monitor and `explain` have them."""
    asked = [prop for prop in target.properties if prop.kind != "reachable"]
    node.load(javascript(target.system, first=first, properties=target.properties))
    assert [prop.name for prop in asked] == node.ask("raw", "machine.claims.map((one) => one.name)")
    monitors, seen = [Monitor(observe(target.system, prop), first) for prop in asked], set[str]()
    node.ask("first", as_json(first))
    assert node.ask("watch") == [_status(one.status) for one in monitors]
    for at, row in enumerate(steps, 1):
        for monitor in monitors:
            monitor.step(row)
        found = node.ask("claims", as_json(row))
        for prop, monitor, one in zip(asked, monitors, found, strict=True):
            why = one and one.pop("why", None)
            assert one == _status(monitor.status), prop.name
            if why is not None:
                trace = run(target.system, steps[:at], first=first)
                assert why == [part_told(part) for part in failing_parts(trace, prop)]
                seen.add(prop.name)
    return seen


def _status(status: Any) -> Any:
    return None if isinstance(status, Holds) else {"broken": isinstance(status, Broken), "step": status.at}


@needs_node
def test_claims_of_every_kind_are_monitored(node: Node) -> None:
    """Of states alone, of steps, of the past, of a response in time: each is broken in the step in which the monitor breaks it."""
    props = (pump.TOO_MANY, pump.LATE, pump.FALLS, pump.KEPT, pump.COMES, pump.FEW_LEFT, pump.AT_FIRST)
    target, seen = pump.target(*props), set[str]()
    for seed in range(6):
        drawn = drawn_run(target.system, seed, 30, lawful=False)
        seen |= assert_same_claims(node, target, drawn.steps, {"label": seed % 3 + 5})
    steps = [{"go": True}, *[{"go": False}] * 12, {"go": True, "extra": 1}, {"go": True}]
    seen |= assert_same_claims(node, target, steps, {"label": 0})
    assert {pump.TOO_MANY.name, pump.LATE.name, pump.FALLS.name} <= seen


@needs_node
@pytest.mark.thorough(ordinary=1)
@pytest.mark.parametrize("name", SMALLEST_FIRST)
def test_claims_of_shipped_machines_are_monitored(node: Node, name: str) -> None:
    """Also where a drawn run breaks what they assume: such a claim says nothing any more."""
    entry = ENTRIES[name]
    target = entry.make(entry.config())
    first = first_state(target.system, random.Random(0))
    assert_same_claims(node, target, _with_ghosts(target.system), first)


@needs_node
def test_a_claim_about_the_world_is_left_out_on_board(node: Node) -> None:
    """It reads what is not there; the others stay."""
    target = ENTRIES["odometry"].make(ENTRIES["odometry"].config())
    board = on_board(target.system)
    node.load(javascript(board, first=first_state(board, random.Random(0)), properties=target.properties))
    told_names = node.ask("raw", "machine.claims.map((one) => one.name)")
    assert 0 < len(told_names) < len([prop for prop in target.properties if prop.kind != "reachable"])


@needs_node
def test_a_script_without_what_all_have_in_common(node: Node) -> None:
    """It takes that from whoever loads it, and is the same machine."""
    system = without_ghosts(example("odometer").system)
    short = javascript(system, with_common=False)
    assert len(short) < len(javascript(system)) / 2
    node.load(f"globalThis.safelocCommon = {common()};\n{short}")
    run_ = drawn_run(system, 1, 20, lawful=False)
    assert_same_run(node, system, run_.steps, dict(run_.first or {}))


# ------------------------------------------------------------------ what is refused

REFUSED = {
    "missing": ("{}", 'RangeError: odometer: input "movement" is missing.'),
    "unknown": ("{movement: 1n, extra: 2n}", 'RangeError: odometer: unknown inputs "extra".'),
    "null": ("{movement: null}", "RangeError: movement: expected a whole number of mm as BigInt, got null."),
    "a floating-point number": (
        "{movement: 1}",
        "RangeError: movement: expected a whole number of mm as BigInt, got 1.",
    ),
    "text": ('{movement: "1"}', 'RangeError: movement: expected a whole number of mm as BigInt, got "1".'),
    "a truth value": ("{movement: true}", "RangeError: movement: expected a whole number of mm as BigInt, got true."),
    "out of range": ("{movement: 5001n}", "RangeError: movement: 5001 mm is outside -5000..5000."),
    "far out of range": (
        "{movement: -(2n**80n)}",
        "RangeError: movement: -1208925819614629174706176 mm is outside -5000..5000.",
    ),
}


@needs_node
@pytest.mark.parametrize("case", REFUSED)
def test_inputs_are_refused(node: Node, case: str) -> None:
    """Nothing is clipped, filled in or converted; the message says what is wrong with which input."""
    text, message = REFUSED[case]
    loaded(node, without_ghosts(example("odometer").system))
    node.ask("first", {})
    with pytest.raises(NodeError) as caught:
        node.ask("raw", f"machine.step(state, {text})")
    assert str(caught.value) == message


@needs_node
def test_members_are_refused(node: Node) -> None:
    """A label that the enumeration does not have, and a number in its place."""
    loaded(node, without_ghosts(example("doors").system))
    node.ask("first", {})
    rest = "command: 'KEEP', obstructed: false, speed: 0n"
    for text, got in (("'FLY'", '"FLY"'), ("1n", "1n"), ("undefined", "undefined")):
        with pytest.raises(NodeError, match=rf"^RangeError: command: expected [A-Z_, ]+, got {got}\.$"):
            node.ask("raw", f"machine.step(state, {{{rest}, command: {text}}})")


@needs_node
def test_states_are_refused(node: Node) -> None:
    """A state that misses a variable, has one more, or one of the wrong kind."""
    loaded(node, without_ghosts(example("odometer").system))
    node.ask("first", {})
    for text, message in (
        ("{}", r'RangeError: odometer: state variable "\w+" is missing\.'),
        ("{...state, more: 1n}", r'RangeError: odometer: unknown state variables "more"\.'),
        ("{...state, margin: 0}", r"RangeError: margin: expected a whole number of nm as BigInt, got 0\."),
    ):
        with pytest.raises(NodeError, match=f"^{message}$"):
            node.ask("raw", f"machine.step({text}, {{movement: 0n}})")


@needs_node
def test_a_first_value_can_be_chosen_only_where_it_is_open(node: Node) -> None:
    """As `interpret.start`: unknown names, declared values and what `initially` excludes are refused."""
    system = without_ghosts(example("timer").system)
    with pytest.raises(InputError, match="breaks `initially`"):
        javascript(system, first={"left": 1})
    loaded(node, system, {"left": 4})
    assert node.ask("first", {}) == {"mode": told(system.state[0], 0), "left": "4"}
    with pytest.raises(NodeError, match=r"breaks `initially`; choose values that satisfy it\.$"):
        node.ask("first", {"left": 1})
    with pytest.raises(NodeError, match=r'^RangeError: timer: unknown state variables "right"\.$'):
        node.ask("first", {"right": 1})


@needs_node
def test_json_holds_every_value(node: Node) -> None:
    """Safe integers are numbers, greater ones text; both are read; labels and truth values stay."""
    wide, way = number("wide", MM, INT64_MIN, INT64_MAX), boolean("way")
    loaded(node, one_row([wide, way], {}, {}))
    written = node.ask("raw", "machine.toJson({wide: 9007199254740992n, small: -5n, way: true, member: 'RED'})")
    assert written == {"wide": "9007199254740992", "small": -5, "way": True, "member": "RED"}
    for text in ("9007199254740992", '"9007199254740993"', "1.5", '"1.5"', '""'):
        read = node.ask("raw", f"typeof machine.fromJson({{wide: {text}}}).wide")
        assert read == ("bigint" if text == '"9007199254740993"' else "string" if '"' in text else "number")


def test_past_operators_are_refused() -> None:
    """A system whose moves look back cannot run; the message says what to do."""
    system = example("odometer").system
    (flag,) = [var for var in system.inputs if isinstance(var, BoolVar)]
    looking_back = replace(system, next={**system.next, flag: Past("once", (flag,))}, state=(*system.state, flag))
    with pytest.raises(InputError, match=r"^odometer: past operators cannot run; `observe` the property first\.$"):
        javascript(looking_back)


def test_a_composition_without_its_parts_is_refused() -> None:
    """It could not say why a transition is refused."""
    with pytest.raises(
        InputError, match=r"^alarm_chain: a composition without its parts cannot be explained; use on_board"
    ):
        javascript(without_ghosts(example("alarm_chain").system))


# ------------------------------------------------------------------ the text

HOSTILE = "</script><script>alert(1)</script><!-- ' \" ` ${x}"


@needs_node
def test_hostile_names_stay_names(node: Node) -> None:
    """The text may stand in a page: it is ASCII and ends no script, whatever the machine's names are."""
    (on,) = table = modes(f"ON {HOSTILE}")
    value, kept = number(f"value {HOSTILE}", MM, 0, 9), number(f"kept {HOSTILE}", MM, 0, 9)
    row = Transition(f"go {HOSTILE}", on, on, value > 3, {kept: value})
    name = f"hostile {HOSTILE.replace('/', '')}"
    system = lower(Machine(name, table, [value], {kept: 0}, {f"out {HOSTILE}": kept}, [row]))
    text = javascript(system)
    assert text.isascii()
    assert "</" not in text
    assert "<!--" not in text
    loaded(node, system)
    node.ask("first", {})
    assert node.ask("call", "explain", {value.name: 1})[0]["parts"][0]["text"] == f"3 mm < value {HOSTILE}"
    made = node.ask("step", {value.name: 5})
    assert made["fired"] == [f"go {HOSTILE}"]
    assert made["outputs"] == {f"out {HOSTILE}": "5"}


NAMES = (
    "x",
    "x_",
    "a.b",
    "a_b",
    "ä",
    "s",
    "i",
    "o",
    "f",
    "t1",
    "p1",
    "n1",
    "down",
    "fits",
    "constructor",
    "__proto__",
    "9",
    "8",
)


@needs_node
def test_names_that_mean_something_in_javascript_stay_apart(node: Node) -> None:
    """Variables called like words of the generated text, of JavaScript's objects, or like numbers are not mixed up."""
    (only,) = table = modes("ONLY")
    variables = [number(name, COUNT, 0, 99) for name in NAMES]
    turned: dict[Var, Expr | Value] = dict(zip(variables, [*variables[1:], variables[0]], strict=True))
    first = dict(zip(variables, range(len(NAMES)), strict=True))
    system = lower(Machine("turn", table, [], dict(first), {}, [Transition("turn", only, only, set=turned)]))
    loaded(node, system)
    node.ask("first", {})
    after = node.ask("step", {})["state"]
    assert {name: after[name] for name in NAMES} == {name: str((at + 1) % len(NAMES)) for at, name in enumerate(NAMES)}


def test_a_machine_with_open_values_is_declared_so() -> None:
    """The table says which first values may be chosen."""
    left = number("left", COUNT, 2, 9)
    (on,) = table = modes("ON")
    text = javascript(lower(Machine("open", table, [], {left: ANY}, {}, [Transition("go", on, on)])))
    assert '"first":"2","open":true' in text


# ------------------------------------------------------------------ a run as a file


def saved_run(node: Node, target: Target) -> tuple[Stepper, list[dict[str, object]]]:
    """A run that was made by hand, and its inputs as JSON; the script of the machine is in the process."""
    first = first_state(target.system, random.Random(0))
    test = run_file_pieces(target, None)
    node.load(javascript(target.system, first=first, test=test))
    rows = [as_json(inputs) for inputs in _with_ghosts(target.system)]
    stepper = Stepper(target, first, [dict(row) for row in rows])
    for _ in rows:
        stepper.take()
    return stepper, rows


@needs_node
@pytest.mark.parametrize("name", ["train_order", "sections"])
def test_a_saved_stream_is_the_one_of_the_terminal(node: Node, name: str, tmp_path: Path) -> None:
    """Byte for byte what `safeloc step` saves of the same run; and `safeloc replay` reads it."""
    entry = ENTRIES[name]
    target = entry.make(entry.config())
    stepper, rows = saved_run(node, target)
    stepper.save(tmp_path / "terminal.jsonl")
    text = node.ask("raw", f"machine.asStream({json.dumps(rows)}.map(machine.fromJson))")
    assert text == (tmp_path / "terminal.jsonl").read_text(encoding="utf-8")
    path = tmp_path / "page.jsonl"
    path.write_text(text, encoding="utf-8")
    recording, _ = read_recording(target, path)
    trace = run(target.system, recording.steps, first=recording.first)
    assert [list(one.fired.values()) for one in trace.steps] == [
        list(one.fired.values()) for one in stepper.trace.steps
    ]
    assert any(one.fired != {"fired": "(stay)"} for one in trace.steps)


@needs_node
def test_a_saved_test_is_the_one_of_python(node: Node, tmp_path: Path) -> None:
    """The same text as `run_file`; the file runs, passes, and fails where the machine moves otherwise."""
    entry = ENTRIES["axle_head"]
    target = entry.make(entry.config())
    stepper, rows = saved_run(node, target)
    text = node.ask("raw", f"machine.asTest({json.dumps(rows)}.map(machine.fromJson))")
    assert text == run_file(target, stepper.trace, None)
    last = json.dumps(list(stepper.trace.steps[-1].fired.values()))
    spoiled = text.replace(f"    {last},\n]", '    ["another"],\n]')
    assert spoiled != text
    for name, content in (("made.py", text), ("spoiled.py", spoiled)):
        (tmp_path / name).write_text(content, encoding="utf-8")
        tests = runpy.run_path(str(tmp_path / name))
        tests["test_no_property_is_violated"]()
        if content == text:
            tests["test_the_machine_moves_as_it_did"]()
        else:
            with pytest.raises(AssertionError):
                tests["test_the_machine_moves_as_it_did"]()


@needs_node
def test_a_run_without_steps_is_no_run(node: Node) -> None:
    """And a script without the text of a test writes none; rows are checked as in a step."""
    loaded(node, without_ghosts(example("odometer").system))
    for text, message in (
        ("machine.asStream([])", r"RangeError: no step was taken; there is no run to save\."),
        (
            "machine.asStream([{movement: 1}])",
            r"RangeError: movement: expected a whole number of mm as BigInt, got 1\.",
        ),
        ("machine.asTest([{movement: 1n}])", r"Error: odometer: this script was made without the text of a test\."),
    ):
        with pytest.raises(NodeError, match=f"^{message}$"):
            node.ask("raw", text)


@needs_node
def test_a_stream_holds_64_bits_and_letters_beyond_ascii(node: Node, tmp_path: Path) -> None:
    """Numbers as digits, whatever their size, and names as Python's JSON writes them."""
    wide, heard = number("weit ✓ 𝒳", MM, INT64_MIN, INT64_MAX), optional("gehört", MM, -9, 9)
    loaded(node, one_row([wide, heard], {}, {}))
    rows = "[{'weit ✓ 𝒳': 9223372036854775807n}, {'weit ✓ 𝒳': -1n, 'gehört': -9n}]"
    path = tmp_path / "python.jsonl"
    write_steps(path, [{wide.name: INT64_MAX}, {"gehört": -9, wide.name: -1}], machine="by_hand")
    assert node.ask("raw", f"machine.asStream({rows})") == path.read_text(encoding="utf-8")


def test_the_schema_is_the_one_that_is_read() -> None:
    """A stream that a page writes names the form that `safeloc replay` reads."""
    assert STREAM_SCHEMA == SCHEMA
