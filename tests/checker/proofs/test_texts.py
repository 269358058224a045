"""Certificates as our own reader sees them."""

from __future__ import annotations

import pytest

from safeloc.checker.proofs.terms import FALSE, make, number, variable
from safeloc.checker.proofs.texts import read_goals
from safeloc.errors import InputError

TEXT = """; relies on other.smt2
; odd names
(set-logic QF_LIA)
(set-info :status unsat)
(declare-const |a;b (c| Int)
(define-fun t4 () Bool (<= (- 5) |a;b (c|))
(define-fun t5 () Int (ite t4 (div |a;b (c| 2) 0))
(assert t4)
(push 1)
; first goal
(assert (not (= t5 1)))
(check-sat)
(pop 1)
(push 1)
; second goal
(assert false)
(check-sat)
(pop 1)
"""
X = variable("a;b (c", "Int")


def test_each_check_is_a_goal() -> None:
    """Goals have what is asserted when they are asked, definitions written out, and the name before them."""
    first, second = read_goals(TEXT)
    low = make("<=", make("neg", number(5)), X)
    value = make("ite", low, make("div", X, number(2)), number(0))
    assert ("first goal", "QF_LIA", (low, make("not", make("=", value, number(1))))) == (
        first.name,
        first.logic,
        first.assertions,
    )
    assert ("second goal", (low, FALSE)) == (second.name, second.assertions)


@pytest.mark.parametrize(
    "text",
    [
        "(assert |x|)",
        "(declare-const |x| Int)(assert |x|)",
        "(declare-const |x| Real)",
        "(declare-const |x| Int)(declare-const x Bool)",
        "(declare-const |true| Bool)",
        "(declare-const and Bool)",
        "(declare-const 5 Int)",
        "(define-fun t () Bool (not t))",
        "(define-fun t () Int true)",
        "(define-fun t ((x Int)) Int x)",
        "(assert (+ 1 2))",
        "(assert (and true 1))",
        "(assert (and true))",
        "(assert (= 1 2 3))",
        "(assert (forall ((x Int)) true))",
        "(assert (let ((x true)) x))",
        "(pop 1)",
        "(push 2)",
        "(push 1)(declare-const |x| Int)(pop 1)",
        "(set-option :produce-proofs true)",
        "(assert true",
        "(assert true))",
        "assert",
        "(assert |x)",
    ],
)
def test_what_is_no_certificate_is_refused(text: str) -> None:
    """Text that the writer of certificates does not produce is an error, and is not skipped."""
    with pytest.raises(InputError, match="certificate"):
        read_goals(f"{text}(check-sat)")
