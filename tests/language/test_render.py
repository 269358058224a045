"""Terms as a person reads them: signs and units, brackets where needed, names of definitions, and a bounded length."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from safeloc.language.expr import (
    TRUE,
    Bool,
    Expr,
    Lit,
    Num,
    Optional,
    Var,
    abs_,
    as_num,
    boolean,
    floor_div,
    ite,
    maximum,
    members,
    minimum,
    number,
    optional,
    product,
)
from safeloc.language.machine import Machine
from safeloc.language.render import infix, names_of_outputs
from safeloc.language.spec import once, previous, since
from safeloc.language.system import lower
from safeloc.language.terms import Sharing, in_order, variables
from safeloc.language.units import MM, MM_S, MS, ONE
from tests.random_machines import machines

A, B = number("a", MM, -100, 100), number("b", MM, -100, 100)
P, Q = boolean("p"), boolean("q")
COUNT = number("count", ONE, 0, 9)
RED, GREEN = members("colour", "RED", "GREEN")
READING: Optional = optional("reading", MM, 0, 10)
DEEP = 60


@pytest.mark.parametrize(
    ("term", "text"),
    [
        (A, "a"),
        (A + B, "a + b"),
        (A - B, "a − b"),
        (A * 3, "a × 3"),
        (A + 5, "a + 5 mm"),
        (COUNT + 5, "count + 5"),
        (RED, "RED"),
        (product(number("v", MM_S, 0, 9), number("t", MS, 0, 9)), "v × t"),
        (floor_div(A, 7), "⌊a / 7⌋"),
        (minimum(A, B), "min(a, b)"),
        (maximum(A, B), "max(a, b)"),
        (abs_(A), "|a|"),
        (ite(P, A, B), "a if p else b"),
        (A < B, "a < b"),
        (A <= B, "a ≤ b"),
        (A.eq(B), "a = b"),
        (A.ne(B), "a ≠ b"),
        (~P, "not p"),
        (P & Q, "p and q"),
        (P | Q, "p or q"),
        ((P | Q) & (A < B), "(p or q) and (a < b)"),
        (TRUE, "true"),
        (previous(P), "previous(p)"),
        (once(P), "once(p)"),
        (since(P, Q), "since(p, q)"),
        (READING.present, READING.present.name),
    ],
    ids=str,
)
def test_notation(term: Expr, text: str) -> None:
    """Every kind of term has its usual sign, constants have their unit, and no outermost bracket is left."""
    assert text == infix(term)


def test_brackets_tell_terms_apart() -> None:
    """Terms that differ only in how they are grouped read differently."""
    grouped = [A - (B - A), (A - B) - A, (A - B) * 2, A - B * 2]
    assert len({infix(term) for term in grouped}) == len(grouped)
    assert infix((A + B) - (A - B)) == "(a + b) − (a − b)"


def test_definitions_are_shown_by_name() -> None:
    """A named part is shown by its name, also when it is the whole term, and the rest is unaffected."""
    share = Sharing()
    whole, part = share((A + B) * 2 < 7), share(A + B)
    assert infix(whole, names={part: "way"}) == "(way × 2) < 7 mm"
    assert infix(whole, names={whole: "near"}) == "near"
    assert infix(share(A - B), names={part: "way"}) == "a − b"


@pytest.mark.parametrize("most", [10, 40, 160])
def test_length_is_bounded(most: int) -> None:
    """A long term is cut to the given length, and an ellipsis says so; a short one is complete."""
    long = infix(chain(DEEP), most)
    assert len(long) <= most
    assert "…" in long
    assert infix(A + B, most) == "a + b"


def chain(length: int) -> Num:
    """A term nested so deep that no reader follows it."""
    term: Num = as_num(0, MM)
    for _ in range(length):
        term = minimum(term + A, B)
    return term


def test_shared_parts_do_not_blow_up() -> None:
    """A term whose written-out form would have 2^60 parts is still rendered, with an ellipsis."""
    term: Bool = P
    for _ in range(DEEP):
        term = ite(Q, ~term, term & (A < B))
    assert "…" in infix(term)


@given(data=st.data(), most=st.integers(5, 300))
def test_any_term_is_readable(data: st.DataObject, most: int) -> None:
    """Any guard or update fits the length; an unabridged one names every variable and balances its brackets."""
    machine: Machine = data.draw(machines())
    terms = [t.when for t in machine.transitions]
    terms += [value for t in machine.transitions for value in t.set.values() if isinstance(value, Bool)]
    for term in (*terms, *lower(machine).next.values(), *machine.outputs.values()):
        text = infix(term, most)
        assert len(text) <= most
        whole = infix(term, 10**6)
        assert text == whole or text[:-1] == whole[: most - 1]
        if "…" not in whole:
            assert unnamed(term, whole) == []
            assert whole.count("(") == whole.count(")")
            assert whole.count("⌊") == whole.count("⌋")


def unnamed(term: Expr, text: str) -> list[Var]:
    """Variables of a term that its text does not name."""
    return [var for var in variables([term]) if var.name not in text]


@given(machines())
def test_every_constant_of_a_short_guard_is_shown(machine: Machine) -> None:
    """Without abridgement the text contains all constants of the term; only zeros may fold into a sign."""
    for t in machine.transitions:
        text = infix(t.when, 10**6)
        for node in in_order([t.when]):
            if isinstance(node, Lit) and node.value != 0 and "…" not in text:
                assert node.label in text


def test_equal_outputs_have_all_their_names() -> None:
    """One term that two outputs show is not told under the name of one of them; what is a variable has its own name."""
    level = number("level_mm", MM, 0, 9)
    outputs = {"below_mm": level + 1, "level_mm": level, "above_mm": level + 1, "double_mm": 2 * level}
    assert ["below_mm, above_mm", "double_mm"] == list(names_of_outputs(outputs, Sharing()).values())
