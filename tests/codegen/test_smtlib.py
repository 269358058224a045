"""The SMT-LIB2 text means what the interpreter does: cvc5, which reads only the text, agrees."""

from __future__ import annotations

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from safeloc.codegen.smtlib import Query, to_smtlib
from safeloc.errors import ModelError
from safeloc.language.expr import Bool, Expr, Num, Var, boolean, floor_div, number, product
from safeloc.language.interpret import read_inputs, start, step
from safeloc.language.machine import Machine, Transition, modes
from safeloc.language.nodes import Past, Value
from safeloc.language.spec import always
from safeloc.language.system import TransitionSystem, lower
from safeloc.language.units import COUNT
from safeloc.proof.provers.recheck import decide
from tests.examples import EXAMPLES, Example
from tests.random_machines import Record, first_states, machines, records


def answers(text: str) -> list[str]:
    """Return cvc5's answer to each `check-sat` of a text."""
    return decide("test.smt2", text, seconds=10)


def is_(term: Expr, value: Value) -> Bool:
    """The term that says that a term has this value."""
    if isinstance(term, Num):
        return term.eq(int(value))
    assert isinstance(term, Bool)
    return term if value else ~term


def assert_same_step(system: TransitionSystem, record: Record, first: Record) -> None:
    """From fixed values follow the values that the interpreter computes, and not their opposite."""
    known: dict[Var, Value] = {**start(system, first), **read_inputs(system, record)}
    after, fired = step(system, start(system, first), read_inputs(system, record))
    expected = [(system.next[var], value) for var, value in after.items()]
    expected += [(system.fired[var], value) for var, value in fired.items()]
    goals = {f"goal {number_}": is_(term, value) for number_, (term, value) in enumerate(expected)}
    goals |= {f"opposite {number_}": ~is_(term, value) for number_, (term, value) in enumerate(expected)}
    said = answers(to_smtlib(Query("one step", [is_(var, value) for var, value in known.items()], goals)))
    assert ["unsat"] * len(expected) + ["sat"] * len(expected) == said


@settings(max_examples=30)
@given(st.data())
def test_random_machines_step_as_interpreted(data: st.DataObject) -> None:
    """On any machine and any inputs, cvc5 and the interpreter agree on the step."""
    system = lower(data.draw(machines()))
    assert_same_step(system, data.draw(records(system)), data.draw(first_states(system)))


@pytest.mark.thorough(ordinary=3)
@pytest.mark.parametrize("example", EXAMPLES, ids=lambda example: example.name)
def test_examples_step_as_interpreted(example: Example) -> None:
    """On every example machine and any inputs, cvc5 and the interpreter agree on the step."""

    @settings(max_examples=10)
    @given(record=records(example.system), first=first_states(example.system))
    def agree(record: Record, first: Record) -> None:
        assert_same_step(example.system, record, first)

    agree()


def test_the_text_is_plain_and_shares_terms() -> None:
    """Declarations, one definition a shared term, hypotheses, then each goal negated on its own."""
    x, halved = number("x", COUNT, -9, 9), boolean("halved")
    half = floor_div(x - 3, 2)
    query = Query("halving", [halved, half.eq(-1)], {"odd\nor even": half + half < x})
    assert to_smtlib(query) == TEXT
    assert answers(TEXT) == ["unsat"]


TEXT = """; safeloc-certificate/1
; name: halving
(set-logic QF_LIA)
(set-info :status unsat)
(declare-const |halved| Bool)
(declare-const |x| Int)
(define-fun t0 () Int (- |x| 3))
(define-fun t1 () Int (div t0 2))
(define-fun t2 () Bool (= t1 (- 1)))
(define-fun t3 () Int (+ t1 t1))
(define-fun t4 () Bool (< t3 |x|))
(assert |halved|)
(assert t2)
(push 1)
; odd or even
(assert (not t4))
(check-sat)
(pop 1)
"""


def test_what_is_defined_already_is_not_defined_again() -> None:
    """Two terms that were made apart and say the same are one definition; those of other parts are not."""
    x = number("x", COUNT, -9, 9)
    text = to_smtlib(Query("same", [x + 1 < 5], {"twice": (x + 1 < 5) & (x + 2 < 5)}))
    assert [line for line in text.splitlines() if line.startswith("(define-fun")] == [
        "(define-fun t0 () Int (+ |x| 1))",
        "(define-fun t1 () Bool (< t0 5))",
        "(define-fun t2 () Int (+ |x| 2))",
        "(define-fun t3 () Bool (< t2 5))",
        "(define-fun t4 () Bool (and t1 t3))",
    ]


def test_a_goal_that_is_a_property_is_told_by_its_name() -> None:
    """Its place in a file is no part of the text: the same machine in another folder has the same certificates."""
    flag = boolean("flag")
    text = to_smtlib(Query("claims", [flag], {always("it stays", flag): flag}))
    assert [line for line in text.splitlines() if line.startswith(";")][2:] == ["; it stays"]


def test_products_of_variables_name_the_logic_they_need() -> None:
    """A product of two variables is not linear, and the text says so."""
    x = number("x", COUNT, 0, 9)
    assert "(set-logic QF_NIA)" in to_smtlib(Query("square", [], {"positive": product(x, x) >= 0}))
    assert "(set-logic QF_LIA)" in to_smtlib(Query("double", [], {"positive": x * 2 >= 0}))


def test_past_operators_are_refused() -> None:
    """A past operator has no text."""
    with pytest.raises(TypeError, match="observe the property first"):
        to_smtlib(Query("past", [], {"once": Past("once", (boolean("flag"),))}))


@pytest.mark.parametrize("name", ["true", "true'", "not", "abs", "div", "t3", "t4", "t7", "t8", "t8'", "int.pow2", "_"])
def test_names_that_the_language_takes_are_free_for_variables(name: str) -> None:
    """A variable may be called like a word of SMT-LIB or like a term of the text, and two alike stay two."""
    x, y = number(name, COUNT, 0, 9), number("t8", COUNT, 0, 9) if name != "t8" else number("true", COUNT, 0, 9)
    text = to_smtlib(Query("names", [x > 3, y > x], {"sum": x + y > 8, "one": x + 1 > 5}))
    assert ["unsat", "sat"] == answers(text)


@pytest.mark.parametrize("name", ["x@1", "x|y", "x\\", "", "x\n"])
def test_names_that_would_be_misread_are_refused(name: str) -> None:
    """A name that could be taken for another one, or end its own quotes, never comes to a proof."""
    (only,) = table = modes("ONLY")
    with pytest.raises(ModelError, match="a name has printable characters, at least one, without @"):
        Machine("named", table, [boolean(name)], {}, {}, [Transition("stay", only, only)])
