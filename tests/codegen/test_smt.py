"""The z3 encoding means what the interpreter does: proofs speak of the machine that runs."""

from __future__ import annotations

from collections.abc import Mapping

import pytest
import z3
from hypothesis import given
from hypothesis import strategies as st

from safeloc.codegen.smt import Terms, Unrolling, constant
from safeloc.language.expr import Var, boolean, ceil_div, floor_div, ite, maximum, minimum, number
from safeloc.language.interpret import evaluate, read_inputs, run, start
from safeloc.language.nodes import Past, Value
from safeloc.language.system import TransitionSystem, lower
from safeloc.language.trace import Step
from safeloc.language.units import COUNT, Enumeration
from tests.examples import EXAMPLES, Example
from tests.random_machines import Record, first_states, machines, streams


def fixed(unrolling: Unrolling, step: int, values: Mapping[Var, Value]) -> list[z3.BoolRef]:
    """Constraints that give variables these values at a step."""
    return [unrolling.at(var, step) == value for var, value in values.items()]


def assert_same_run(system: TransitionSystem, stream: list[Record], first: Record) -> None:
    """With first state and inputs fixed there is a run, and it is the interpreter's."""
    trace, unrolling, solver = run(system, stream, first=first), Unrolling(system, assume=False), z3.Solver()
    solver.add(unrolling.initially(), *fixed(unrolling, 0, start(system, first)))
    for number_, record in enumerate(stream):
        solver.add(unrolling.transition(number_), *fixed(unrolling, number_, read_inputs(system, record)))
    assert z3.sat == solver.check()
    for number_, step in enumerate(trace.steps):
        assert_same_step(unrolling, solver.model(), number_, step)


def assert_same_step(unrolling: Unrolling, model: z3.ModelRef, before: int, step: Step) -> None:
    """State and outputs after the step, and what fired in it, as the model has them."""
    system = unrolling.system
    assert dict(step.state) == unrolling.values(model, before + 1, system.state)
    for name, term in system.outputs.items():
        assert step.outputs[name] == plain(model.eval(unrolling.at(term, before + 1), model_completion=True))
    for var, fired in system.fired.items():
        assert isinstance(var.unit, Enumeration)
        number_ = plain(model.eval(unrolling.at(fired, before), model_completion=True))
        assert step.fired[var.name] == var.unit.members[number_]


def plain(term: z3.ExprRef) -> Value:
    """A z3 value as a Python value."""
    return int(term.as_long()) if isinstance(term, z3.IntNumRef) else z3.is_true(term)


@given(st.data())
def test_random_machines_run_as_interpreted(data: st.DataObject) -> None:
    """On any machine and any stream, the encoding's only run is the interpreter's."""
    system = lower(data.draw(machines()))
    assert_same_run(system, data.draw(streams(system, 4)), data.draw(first_states(system)))


@pytest.mark.thorough(ordinary=1)
@pytest.mark.parametrize("example", EXAMPLES, ids=lambda example: example.name)
def test_examples_run_as_interpreted(example: Example) -> None:
    """On every example machine and any stream, the encoding's only run is the interpreter's."""

    @given(stream=streams(example.system, 4), first=first_states(example.system))
    def agree(stream: list[Record], first: Record) -> None:
        assert_same_run(example.system, stream, first)

    agree()


@pytest.mark.parametrize("divisor", [1, 2, 3, 7])
@pytest.mark.parametrize("dividend", [-15, -14, -8, -7, -1, 0, 1, 7, 15])
def test_division_rounds_as_in_python(dividend: int, divisor: int) -> None:
    """Floor and ceiling division round down and up, also below zero."""
    var = number("x", COUNT, -20, 20)
    terms = [floor_div(var, divisor), ceil_div(var, divisor)]
    translated = Terms({var: z3.IntVal(dividend)})
    assert [dividend // divisor, -(-dividend // divisor)] == [plain(z3.simplify(translated(term))) for term in terms]
    assert evaluate(terms, {var: dividend}) == [plain(z3.simplify(translated(term))) for term in terms]


def test_the_assumption_binds_only_where_it_is_asked_for() -> None:
    """`assume=False` leaves every stream in range; by default only those that the environment can produce."""
    system = EXAMPLES[0].system
    moved = system.variable("moved")
    for assume, expected in ((True, z3.unsat), (False, z3.sat)):
        unrolling, solver = Unrolling(system, assume=assume), z3.Solver()
        solver.add(unrolling.initially(), unrolling.transition(0), unrolling.at(moved, 0) == 10**10)
        solver.add(unrolling.at(system.variable("movement"), 0) == 0)
        assert expected == solver.check()


def test_inputs_out_of_range_have_no_run() -> None:
    """The encoding knows the ranges of inputs, and that an absent value is written in one way."""
    system = EXAMPLES[0].system
    present, value = system.variable("reference.present"), system.variable("reference")
    unrolling, solver = Unrolling(system), z3.Solver()
    solver.add(unrolling.transition(0))
    assert z3.unsat == solver.check(unrolling.at(system.variable("movement"), 0) > 5000)
    assert z3.unsat == solver.check(z3.Not(unrolling.at(present, 0)), unrolling.at(value, 0) == 7)
    assert z3.sat == solver.check(unrolling.at(present, 0), unrolling.at(value, 0) == 7)


def test_equal_sub_terms_are_translated_once() -> None:
    """Sharing survives: a term of 2^60 paths is translated at once."""
    var = number("x", COUNT, 0, 1)
    term = var + 0
    for _ in range(60):
        term = floor_div(term + term, 2)
    assert plain(z3.simplify(Terms({var: z3.IntVal(1)})(term))) == 1


def test_what_has_no_meaning_is_refused() -> None:
    """Past operators and unknown variables are errors."""
    flag = boolean("flag")
    with pytest.raises(TypeError, match="observe the property first"):
        Terms({flag: constant(flag)})(Past("once", (flag,)))
    with pytest.raises(KeyError, match="'flag' has no z3 term"):
        Terms({})(flag)


def test_terms_are_those_of_z3s_own_operators() -> None:
    """z3 keeps one object for equal terms, so a proof searches as if the operators had made them."""
    a, b, on = number("a", COUNT, 0, 9), number("b", COUNT, 0, 9), boolean("on")
    terms = Terms({var: constant(var) for var in (a, b, on)})
    x, y, p = z3.Int("a"), z3.Int("b"), z3.Bool("on")
    pairs = [
        (a + b, x + y), (a - b, x - y), (3 * a, x * z3.IntVal(3)), (floor_div(a, 4), x / 4), (minimum(a, b), z3.If(x <= y, x, y)),
        (maximum(a, b), z3.If(x >= y, x, y)), (ite(on, a, b), z3.If(p, x, y)), (a < b, x < y), (a <= 5, x <= z3.IntVal(5)),
        (a.eq(5), x == z3.IntVal(5)), (~on, z3.Not(p)), (on & (a < b), z3.And(p, x < y)), (on | (a < b), z3.Or(p, x < y)),
    ]  # fmt: skip
    assert [] == [str(ours) for ours, theirs in pairs if not terms(ours).eq(theirs)]
