"""The language: terms refuse to be values, units are checked at birth, rounding has a direction."""

from __future__ import annotations

from collections.abc import Callable

import pytest
from hypothesis import given
from hypothesis import strategies as st

from safeloc.errors import ModelError, TruthValueError, UnitError
from safeloc.language.expr import (
    Lit,
    abs_,
    between,
    boolean,
    ceil_div,
    ceil_to,
    exact_to,
    floor_div,
    floor_to,
    ite,
    maximum,
    members,
    minimum,
    number,
    product,
)
from safeloc.language.interpret import evaluate
from safeloc.language.terms import Sharing, Substitution, in_order, text
from safeloc.language.units import CM, MM, MM_S, MS, NM, PPM, UM

X, Y = number("x", MM, -1000, 1000), number("y", MM, -1000, 1000)
SPEED, P = number("v", MM_S, 0, 100_000), boolean("p")
RED, GREEN = members("colour", "RED", "GREEN")


@pytest.mark.parametrize(
    ("use", "remedy"),
    [
        (lambda: bool(X), "has no truth value"),
        (lambda: 0 <= X <= 10, "between(low, x, high)"),
        (lambda: X in [Y], "one_of"),
        (lambda: X == 3, "a.eq(b)"),
        (lambda: f"{X}", "Use repr(term)"),
        (lambda: not P, "has no truth value"),
        (lambda: list(P), "cannot be iterated"),  # type: ignore[call-overload]
        (lambda: 3 in P, "one_of"),
    ],
)
def test_a_term_is_no_value(use: Callable[[], object], remedy: str) -> None:
    """Using a term as a Python value raises, names the remedy and the caller's line."""
    with pytest.raises(TruthValueError) as caught:
        use()
    assert remedy in str(caught.value)
    assert "test_expr.py:" in str(caught.value)


@pytest.mark.parametrize(
    ("use", "message"),
    [
        (lambda: X + SPEED, "cannot add mm and mm/s. They are of different kinds; with_unit"),
        (lambda: X < SPEED, "cannot compare mm and mm/s. They are of different kinds; with_unit"),
        (
            lambda: X < number("n", NM, 0, 9),
            "cannot compare mm and nm. Convert one with floor_to, ceil_to or exact_to.",
        ),
        (lambda: X + 1.5, "expected a whole number"),  # type: ignore[operator]
        (lambda: X + True, "expected a whole number"),
        (lambda: P & 1, "expected a truth value"),  # type: ignore[operator]
        (lambda: RED + 1, "arithmetic on enumeration"),
        (lambda: RED < GREEN, "has no order"),
        (lambda: ite(P, X, P), "mixes a number and a truth value"),  # type: ignore[call-overload]
        (lambda: exact_to(SPEED, MM), "cannot convert mm/s to mm"),
    ],
)
def test_units_and_kinds_are_checked_at_birth(use: Callable[[], object], message: str) -> None:
    """Terms that do not fit are refused where they are written."""
    with pytest.raises(UnitError, match=message):
        use()


@pytest.mark.parametrize(
    ("use", "message"),
    [
        (lambda: X * Y, "product of two variables"),
        (lambda: X // 2, "hides the direction of rounding"),
        (lambda: X / 2, "not exact"),
        (lambda: floor_div(X, 0), "positive whole-number constant"),
        (lambda: floor_div(X, -3), "positive whole-number constant"),
        (lambda: number("n", MM, 3, 2), "must be non-empty"),
        (lambda: number("n", MM, 0, 2**63), "fit 64 bits"),
        (lambda: exact_to(number("n", NM, 0, 9), MM), "use floor_to or ceil_to"),
    ],
)
def test_what_is_not_linear_or_not_exact_is_refused(use: Callable[[], object], message: str) -> None:
    """Hidden rounding, products of variables and impossible ranges are errors."""
    with pytest.raises(ModelError, match=message):
        use()


@given(st.integers(-1000, 1000), st.integers(1, 50))
def test_rounding_goes_the_stated_way(value: int, divisor: int) -> None:
    """floor_div is never above and ceil_div never below the exact quotient, for negatives as well."""
    low, high = evaluate([floor_div(X, divisor), ceil_div(X, divisor)], {X: value})
    assert low * divisor <= value <= high * divisor
    assert high - low == (0 if value % divisor == 0 else 1)


@given(st.integers(-1000, 1000), st.integers(-1000, 1000), st.booleans())
def test_terms_mean_what_python_means(x: int, y: int, p: bool) -> None:
    """Every operation agrees with Python's on the same numbers."""
    terms = [X + Y, X - Y, -X, X * 3, minimum(X, Y), maximum(X, Y), abs_(X), ite(P, X, Y), product(X, Y), 5 - X]
    assert evaluate(terms, {X: x, Y: y, P: p}) == [
        x + y, x - y, -x, x * 3, min(x, y), max(x, y), abs(x), x if p else y, x * y, 5 - x,
    ]  # fmt: skip
    logic = [X < Y, X <= Y, X > Y, X >= Y, X.eq(Y), X.ne(Y), between(-5, X, 5), P & (X < Y), P | (X < Y), ~P,
             P.implies(X < Y), P.iff(X < Y), X.one_of(Y, 7), ite(P, X < Y, Y < X)]  # fmt: skip
    assert evaluate(logic, {X: x, Y: y, P: p}) == [
        x < y, x <= y, x > y, x >= y, x == y, x != y, -5 <= x <= 5, p and x < y, p or x < y, not p,
        not p or x < y, p == (x < y), x in (y, 7), x < y if p else y < x,
    ]  # fmt: skip


def test_products_carry_their_unit() -> None:
    """mm x ppm is nm, mm/s x ms is um; a um is no mm until it is converted on purpose."""
    assert (X * Lit(5, PPM)).unit is NM
    travelled = product(SPEED, number("t", MS, 0, 100))
    assert travelled.unit is UM
    with pytest.raises(UnitError):
        _ = travelled + X
    values = {SPEED: 1_999, in_order([travelled])[1]: 3}
    low, high = evaluate([floor_to(travelled, MM), ceil_to(travelled, MM)], values)  # type: ignore[arg-type]
    assert (low, high) == (5, 6)


def test_constants_fold() -> None:
    """Operations on constants are computed when the term is built."""
    assert text(Lit(3, MM) + 4) == "7"
    assert text(P & True) == "p"
    assert text(P & False) == "false"
    assert text(ite(True, X, Y)) == "x"
    assert text(~~P) == "p"


def test_equal_terms_become_one() -> None:
    """Sharing makes equal sub-terms the same node, also across calls."""
    share = Sharing()
    assert share(abs_(X - Y) + 1) is share(abs_(X - Y) + 1)
    assert share(X - Y) is not share(Y - X)


def test_walking_can_leave_out_what_is_done() -> None:
    """Nodes below a done one are left out with it, so that work added bit by bit looks at every node once."""
    inner = X - Y
    outer = abs_(inner + 1)
    assert [X, Y, inner] == in_order([inner])
    assert [node for node in in_order([outer]) if node not in set(in_order([inner]))] == in_order([outer], {inner})
    share, term = Sharing(), X + 1
    for _ in range(2_000):
        term = share.num(term + 1)
    assert term is share.num(term)


def test_substitution_keeps_sharing() -> None:
    """A deep graph of shared terms is rewritten in one pass and written out bounded."""
    deep = X
    for _ in range(60):
        deep = deep + deep  # type: ignore[assignment]
    rewritten = Substitution({X: Y})(deep)
    assert len(in_order([rewritten])) == 61
    assert len(repr(rewritten)) < 5_000


@pytest.mark.parametrize(("low", "high"), [(0, 1e6), (0.5, 3), (False, True)])
def test_a_range_is_whole_numbers(low: int, high: int) -> None:
    """1e6 is a float and False a truth value; neither bounds a whole number."""
    with pytest.raises(ModelError, match=r"range of 'n' is .*; give its bounds as whole numbers\.$"):
        number("n", MM, low, high)


def test_labels_are_distinct() -> None:
    """Two members of one label could not be told apart when they are read."""
    with pytest.raises(ModelError, match=r"colour has labels \['RED', 'RED'\]; they must be distinct\.$"):
        members("colour", "RED", "RED")


def test_sharing_leaves_what_is_there() -> None:
    """A term whose parts are the first of their kind stays itself; a later one becomes it, whole and parts."""
    share, first, second = Sharing(), abs_(X - Y) + 1, abs_(X - Y) + 1
    assert share(first) is first
    assert share(second) is first
    assert share(second + 2) is share(first + 2)
    assert len(in_order([first])) == len(in_order([share(first), share(second)]))


def test_sharing_keeps_units_apart() -> None:
    """A length in um divided by 1000 is not the same term as that length in mm, though their numbers agree."""
    length = number("length", UM, 0, 9_999)
    share = Sharing()
    assert [MM, UM] == [share.num(floor_to(length, MM)).unit, share.num(floor_div(length, 1000)).unit]


@pytest.mark.parametrize(("value", "down", "up"), [(-11, -2, -1), (-10, -1, -1), (-1, -1, 0), (0, 0, 0), (11, 1, 2)])
def test_rounding_of_constants_and_of_variables_agree(value: int, down: int, up: int) -> None:
    """Millimetres to centimetres, below zero as well: folded when written and computed when run."""
    assert [str(down), str(up)] == [text(floor_to(Lit(value, MM), CM)), text(ceil_to(Lit(value, MM), CM))]
    assert [down, up] == evaluate([floor_to(X, CM), ceil_to(X, CM)], {X: value})
    assert [value * 10**6] == evaluate([exact_to(X, NM)], {X: value})


def test_conversions_carry_the_unit_they_name() -> None:
    """with_unit gives a term of any form the requested unit."""
    for term in (X, X + Y, floor_div(X, 3), Lit(7, MM)):
        assert [CM, CM, UM] == [floor_to(term, CM).unit, ceil_to(term, CM).unit, exact_to(term, UM).unit]


@pytest.mark.parametrize(
    ("use", "message"),
    [
        (lambda: ite(P, X, SPEED), "cannot choose between mm and mm/s"),
        (lambda: ite(1, X, Y), "expected a truth value or a Bool term, got int 1"),  # type: ignore[call-overload]
        (lambda: ite(P, X, 1.5), "expected a whole number or a Num term, got float 1.5"),  # type: ignore[call-overload]
        (lambda: X.eq("OPEN"), "got str 'OPEN'. Give a mode or a member itself"),  # type: ignore[arg-type]
        (lambda: product(RED, X), "arithmetic on an enumeration"),
        (lambda: floor_div(RED, 2), "arithmetic on an enumeration"),
        (lambda: X.eq(RED), "cannot compare mm and colour. A member of an enumeration is compared with"),
    ],
)
def test_choices_and_products_fit(use: Callable[[], object], message: str) -> None:
    """Both sides of a choice have one kind and unit, and members of an enumeration are not reckoned with."""
    with pytest.raises(UnitError, match=message):
        use()


def test_a_long_chain_is_no_recursion() -> None:
    """Depth is no limit: a sum of 5000 terms is walked, rewritten and computed; printed, it stays short."""
    chain = X + 1
    for _ in range(4_999):
        chain = chain + 1
    assert evaluate([chain, Substitution({X: Y})(chain)], {X: 5, Y: 6}) == [5_005, 5_006]
    assert len(repr(chain)) < 2_000
