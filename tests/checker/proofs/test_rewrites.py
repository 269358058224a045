"""Rewrites by cases and normal forms: instances that hold, and instances that do not."""

from __future__ import annotations

from fractions import Fraction

import pytest

from safeloc.checker.proofs import cases
from safeloc.checker.proofs.cases import valid
from safeloc.checker.proofs.rewrites import FAMILIES
from safeloc.checker.proofs.steps import Inference, WrongStep
from safeloc.checker.proofs.terms import Term, make, number, same, variable
from tests.checker.proofs.formulas import at, figure, follows, formula, listed

VALID = [
    "(= (< x y) (not (>= x y)))",
    "(= (<= x y) (not (>= x (+ y 1))))",
    "(= (= x y) (and (>= x y) (<= x y)))",
    "(= (ite (not a) x y) (ite a y x))",
    "(= (>= (ite a 3 0) 0) true)",
    "(= (>= (ite (>= x y) x y) y) true)",
    "(= (ite a (ite a x y) z) (ite a x z))",
    "(= (>= (* 2 x) 3) (>= x 2))",
    "(= (= (* 2 x) 3) false)",
    "(=> (and (>= x 1) (<= x 1)) (= x 1))",
    "(= (div 7 2) 3)",
    "(= (div (- 7) 2) (- 4))",
    "(= (div (- 7) (- 2)) 4)",
    "(= (not (ite a b c)) (ite a (not b) (not c)))",
]
NOT_VALID = [
    "(= (< x y) (not (> x y)))",
    "(= (<= x y) (not (>= x y)))",
    "(= (ite (not a) x y) (ite a x y))",
    "(= (>= (ite a 3 (- 1)) 0) true)",
    "(= (>= (* 2 x) 3) (>= x 1))",
    "(= (= (* 2 x) 4) false)",
    "(=> (and (>= x 1) (<= x 2)) (= x 1))",
    "(= (div (- 7) 2) (- 3))",
    "(= (div x 0) 0)",
    "(= x y)",
    "a",
    "false",
]


@pytest.mark.parametrize("text", VALID)
def test_what_is_valid_is_shown(text: str) -> None:
    """It holds in every case."""
    assert valid(formula(text))


@pytest.mark.parametrize("text", NOT_VALID)
def test_what_is_not_valid_is_not_shown(text: str) -> None:
    """A case speaks against it."""
    assert not valid(formula(text))


def test_rationals_are_not_tightened() -> None:
    """At least 1/2 is at least 1 of whole numbers, not of others; strict bounds are kept apart from others."""
    half, one = number(Fraction(1, 2), "Real"), number(1, "Real")
    r = variable("r", "Real")
    assert valid(same(make(">=", figure("x"), half), make(">=", figure("x"), number(1))))
    assert not valid(same(make(">=", r, half), make(">=", r, one)))
    assert not valid(same(make(">", r, half), make(">=", r, half)))
    assert valid(make("=>", make(">", r, half), make(">=", r, half)))


def test_a_division_by_zero_is_never_evaluated() -> None:
    """Division by 0 has no value here, and total division by 0 is not taken for division."""
    by_zero = make("div", figure("x"), number(0)), make("div_total", figure("x"), number(0))
    assert not valid(same(*by_zero))
    by_two = make("div", figure("x"), number(2)), make("div_total", figure("x"), number(2))
    assert valid(same(*by_two))


def test_premises_are_used_and_needed() -> None:
    """A condition of a rewrite makes it hold, and without it it does not."""
    claim, condition = formula("(= (ite a x y) x)"), formula("a")
    assert valid(claim, [condition])
    assert not valid(claim)
    assert not valid(claim, [formula("b")])


def test_too_many_cases_are_not_shown(monkeypatch: pytest.MonkeyPatch) -> None:
    """A claim that takes too long to check is not called valid."""
    wide = formula("(or (and a b c) (and a b (not c)) (and a (not b)) (not a))")
    assert valid(wide)
    monkeypatch.setattr(cases, "MOST_TERMS", 10)
    assert not valid(wide)


def test_an_instance_of_a_rewrite() -> None:
    """Terms put in are not looked into, unless one holds the other."""
    claim = formula("(= (<= (* x y) (div z 2)) (>= (div z 2) (* x y)))")
    assert follows("DSL_REWRITE", [], [at(1), figure("(* x y)"), figure("(div z 2)")], claim)
    inner = figure("(ite a x y)")
    nested = same(make("ite", formula("a"), inner, inner), make("ite", formula("a"), figure("x"), inner))
    assert follows("DSL_REWRITE", [], [at(1), formula("a"), figure("x"), figure("y"), inner], nested)
    with pytest.raises(NotImplementedError):
        follows("DSL_REWRITE", [], [at(1), figure("x"), figure("y")], "(= (<= x y) (>= x y))")


def test_a_step_without_a_rule_is_shown_or_trusted() -> None:
    """What cvc5 gives no rule for is shown by cases, and where that fails it is left for trust, not refused."""
    assert follows("TRUST", [], [at(51)], "(= (and a b) (and b a))")
    with pytest.raises(NotImplementedError):
        FAMILIES["TRUST"](Inference((), (at(51),), formula("(= a b)")))


@pytest.mark.parametrize(
    ("rule", "args", "claim"),
    [
        ("EVALUATE", ["(+ 2 3)"], "(= (+ 2 3) 5)"),
        ("ACI_NORM", None, "(= (and a (and b a) true) (and b a))"),
        ("ACI_NORM", None, "(= (or a false) a)"),
        ("ACI_NORM", None, "(= (+ x (+ y z)) (+ (+ z y) x))"),
        ("ABSORB", None, "(= (and a (and b false)) false)"),
        ("ABSORB", None, "(= (or a true) true)"),
    ],
)
def test_values_and_normal_forms(rule: str, args: list[str] | None, claim: str) -> None:
    """A value that is computed, the same parts in another order, and what absorbs the rest."""
    taken: list[Term] = [formula(claim)] if args is None else [figure(arg) for arg in args]
    assert follows(rule, [], taken, claim)


@pytest.mark.parametrize(
    ("rule", "args", "claim"),
    [
        ("EVALUATE", ["(+ 2 3)"], "(= (+ 2 3) 6)"),
        ("EVALUATE", ["(+ 2 4)"], "(= (+ 2 3) 5)"),
        ("EVALUATE", ["(+ x 3)"], "(= (+ x 3) 5)"),
        ("ACI_NORM", None, "(= (and a b) (or a b))"),
        ("ACI_NORM", None, "(= (and a b) (and a c))"),
        ("ACI_NORM", None, "(= (or a true) a)"),
        ("ACI_NORM", None, "(= (not a) (not b))"),
        ("ACI_NORM", None, "(= (- x y) (- y x))"),
        ("ABSORB", None, "(= (and a true) true)"),
        ("ABSORB", None, "(= (and a (or b false)) false)"),
        ("ABSORB", None, "(= (or a false) false)"),
    ],
)
def test_other_values_and_parts_are_refused(rule: str, args: list[str] | None, claim: str) -> None:
    """Another value, other parts, another connective."""
    taken: list[Term] = [formula(claim)] if args is None else [figure(arg) for arg in args]
    with pytest.raises(WrongStep):
        follows(rule, [], taken, claim)


def test_lists_are_put_in_part_by_part() -> None:
    """A rewrite over a list of formulas is shown with each of them as it is."""
    parts = [formula(text) for text in ("(< x y)", "(< y z)", "(< z x)")]
    claim = same(make("not", make("and", *parts)), make("or", *(make("not", part) for part in parts)))
    assert follows("DSL_REWRITE", [], [at(1), parts[0], listed(*parts[1:])], claim)
