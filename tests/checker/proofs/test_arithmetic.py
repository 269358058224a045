"""Rules of arithmetic: coefficients, bounds and signs that are right, and some that are not."""

from __future__ import annotations

from fractions import Fraction

import pytest

from safeloc.checker.proofs.goals import RULES
from safeloc.checker.proofs.polynomials import direction, polynomial
from safeloc.checker.proofs.steps import Inference, WrongStep
from safeloc.checker.proofs.terms import TRUE, Term, make, number, same
from tests.checker.proofs.formulas import figure, follows, formula

X, Y = figure("x"), figure("y")
NORM, REL = "ARITH_POLY_NORM", "ARITH_POLY_NORM_REL"


def conclusion(rule: str, premises: list[Term], *args: Term, claim: Term = TRUE) -> Term:
    """Return the conclusion of the rule."""
    return RULES[rule](Inference(tuple(premises), args, claim))


@pytest.mark.parametrize(
    "claim",
    [
        "(= (+ x (* 2 y)) (+ y x y))",
        "(= (* (+ x y) (- x y)) (- (* x x) (* y y)))",
        "(= (- x x) 0)",
        "(= (* 3 (- x)) (* (- 3) x))",
    ],
)
def test_equal_polynomials_are_equal(claim: str) -> None:
    """Sums and products in another order have one normal form."""
    text = claim.replace("(+ y x y)", "(+ y (+ x y))")
    assert follows(NORM, [], [formula(text)], text)


@pytest.mark.parametrize(
    "claim", ["(= (+ x y) (+ x z))", "(= (* 2 x) (* 3 x))", "(= x (+ x 1))", "(<= x x)", "(= a a)"]
)
def test_other_polynomials_are_not(claim: str) -> None:
    """Another coefficient, variable or constant is refused, and so is what is no equation of numbers."""
    with pytest.raises(WrongStep):
        follows(NORM, [], [formula(claim)], claim)


@pytest.mark.parametrize(
    ("premise", "claim"),
    [
        ("(= (* 1 (- x y)) (* 1 (- (+ x 1) (+ y 1))))", "(= (>= x y) (>= (+ x 1) (+ y 1)))"),
        ("(= (* 2 (- x y)) (* 1 (- (* 2 x) (* 2 y))))", "(= (< x y) (< (* 2 x) (* 2 y)))"),
        ("(= (* (- 1) (- x y)) (* 1 (- y x)))", "(= (= x y) (= y x))"),
    ],
)
def test_a_comparison_of_equal_differences(premise: str, claim: str) -> None:
    """Comparisons whose differences are positive multiples of each other (equations: any but 0) are equal."""
    assert follows(REL, [premise], [formula(claim)], claim)


@pytest.mark.parametrize(
    ("premise", "claim"),
    [
        ("(= (* (- 1) (- x y)) (* 1 (- y x)))", "(= (>= x y) (>= y x))"),
        ("(= (* 0 (- x y)) (* 0 (- y z)))", "(= (= x y) (= y z))"),
        ("(= (* z (- x y)) (* z (- y x)))", "(= (= x y) (= y x))"),
        ("(= (* 1 (- x y)) (* 1 (- y z)))", "(= (>= x y) (> y z))"),
        ("(= (* 1 (- x z)) (* 1 (- y z)))", "(= (>= x y) (>= y z))"),
    ],
)
def test_a_comparison_of_other_differences(premise: str, claim: str) -> None:
    """A negative factor, 0, a factor that is no number, another relation, another difference: each is refused."""
    with pytest.raises(WrongStep):
        follows(REL, [premise], [formula(claim)], claim)


def test_sums_of_bounds() -> None:
    """Upper bounds add up, strict where one is; a lower bound among them is refused."""
    assert follows("ARITH_SUM_UB", ["(<= x y)", "(< y z)"], [], "(< (+ x y) (+ y z))")
    assert follows("ARITH_SUM_UB", ["(<= x y)", "(= y z)"], [], "(<= (+ x y) (+ y z))")
    assert not follows("ARITH_SUM_UB", ["(<= x y)", "(<= y z)"], [], "(< (+ x y) (+ y z))")
    assert not follows("ARITH_SUM_UB", ["(<= x y)", "(<= y z)"], [], "(<= (+ x z) (+ y z))")
    for other in ("(>= y z)", "(not (<= y z))", "(= a b)"):
        with pytest.raises(WrongStep):
            follows("ARITH_SUM_UB", ["(<= x y)", other], [], "(<= (+ x y) (+ y z))")


def test_multiples_of_bounds() -> None:
    """A positive factor keeps a comparison, a negative one turns it; neither is taken for granted of the factor."""
    atom = formula("(>= x y)")
    kept = "(=> (and (> z 0) (>= x y)) (>= (* z x) (* z y)))"
    turned = "(=> (and (< z 0) (>= x y)) (<= (* z x) (* z y)))"
    assert follows("ARITH_MULT_POS", [], [figure("z"), atom], kept)
    assert follows("ARITH_MULT_NEG", [], [figure("z"), atom], turned)
    assert not follows("ARITH_MULT_NEG", [], [figure("z"), atom], kept)
    assert not follows("ARITH_MULT_POS", [], [figure("z"), atom], "(=> (>= x y) (>= (* z x) (* z y)))")


def test_bounds_of_whole_numbers_are_tightened() -> None:
    """Below 3 is at most 2, and below 5/2 as well; above 5/2 is at least 3. Only of whole numbers."""
    half = number(Fraction(5, 2), "Real")
    assert conclusion("INT_TIGHT_UB", [formula("(< x 3)")]) is formula("(<= x 2)")
    assert conclusion("INT_TIGHT_UB", [make("<", X, half)]) is formula("(<= x 2)")
    assert conclusion("INT_TIGHT_LB", [make(">", X, half)]) is formula("(>= x 3)")
    assert conclusion("INT_TIGHT_LB", [formula("(> x 3)")]) is formula("(>= x 4)")
    for premise in (make("<", make("to_real", X), half), formula("(<= x 3)")):
        with pytest.raises(WrongStep):
            conclusion("INT_TIGHT_UB", [premise])
    with pytest.raises(TypeError):
        conclusion("INT_TIGHT_UB", [formula("(< x y)")])


def test_one_of_three_comparisons_holds() -> None:
    """A number neither below nor above another is equal to it; other conclusions are refused."""
    assert follows("ARITH_TRICHOTOMY", ["(>= x y)", "(<= x y)"], [], "(= x y)")
    assert follows("ARITH_TRICHOTOMY", ["(>= x y)", "(not (= x y))"], [], "(> x y)")
    for premises in (["(>= x y)", "(<= y z)"], ["(>= x y)"], ["(>= x y)", "(>= y x)", "(< x z)"]):
        with pytest.raises(WrongStep):
            follows("ARITH_TRICHOTOMY", premises, [], "(< x y)")


def test_division_by_a_constant() -> None:
    """A quotient q of x by 7 has 7 q <= x < 7 (q + 1); by -7 it has -7 q <= x < -7 (q - 1). None by 0 or a variable."""
    for by, up in ((7, 1), (-7, -1)):
        term = make("div_total", X, number(by))
        name = make("purify", term)
        low, high = make("*", number(by), name), make("*", number(by), make("+", name, number(up)))
        bounds = make("and", make("<=", low, X), make("<", X, high))
        assert conclusion("ARITH_REDUCTION", [], term) is make("and", same(term, name), bounds)
    for divisor in (number(0), Y):
        with pytest.raises(WrongStep):
            conclusion("ARITH_REDUCTION", [], make("div_total", X, divisor))


def test_the_sign_of_a_product() -> None:
    """Odd powers of what is negative count; a factor that is only not 0 has to come in an even power."""
    product, square = figure("(* x y)"), figure("(* (* x x) y)")
    negative = make("<", product, number(0))
    given = formula("(and (< x 0) (> y 0))")
    assert conclusion("ARITH_MULT_SIGN", [], given, product) is make("=>", given, negative)
    given = formula("(and (not (= x 0)) (> y 0))")
    assert conclusion("ARITH_MULT_SIGN", [], given, square) is make("=>", given, make(">", square, number(0)))
    for conditions in ("(and (not (= x 0)) (> y 0))", "(> y 0)", "(and (< x 1) (> y 0))", "(and (= x 0) (> y 0))"):
        with pytest.raises(WrongStep):
            conclusion("ARITH_MULT_SIGN", [], formula(conditions), product)


def test_a_product_against_its_tangent() -> None:
    """x y is at most its tangent plane in (2, 3) where x - 2 and y - 3 have not the same sign, and nowhere else."""
    plane = "(- (+ (* 3 x) (* 2 y)) 6)"
    claim = f"(= (<= (* x y) {plane}) (or (and (<= x 2) (>= y 3)) (and (>= x 2) (<= y 3))))"
    args = (X, Y, number(2), number(3))
    assert follows("ARITH_MULT_TANGENT", [], [*args, number(-1)], claim)
    for wrong in (claim.replace("6", "5"), claim.replace("(<= y 3)", "(>= y 3)")):
        with pytest.raises(WrongStep):
            follows("ARITH_MULT_TANGENT", [], [*args, number(-1)], wrong)
    with pytest.raises(WrongStep):
        follows("ARITH_MULT_TANGENT", [], [*args, number(1)], claim)


def test_multiples_have_one_direction() -> None:
    """Forms that are multiples of each other share a direction; whole values are whole in it."""
    one, factor, rest = direction(polynomial(figure("(+ (* 4 x) (+ (* (- 6) y) 1))")))
    other, turned, _ = direction(polynomial(figure("(- (* 3 y) (* 2 x))")))
    assert (Fraction(1), True) == (rest, one.integer)
    assert one == other
    assert {Fraction(-2)} == {factor / turned}
