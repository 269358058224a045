"""A certificate's text: what is read, in which normal form, and what is refused."""

from __future__ import annotations

import pytest

from safeloc.checker.dag import Dag, Rewriting
from safeloc.checker.terms import Translation
from safeloc.checker.text import Certificate, read
from safeloc.errors import InputError
from safeloc.language.expr import all_of, any_of, boolean, floor_div, ite, maximum, minimum, number
from safeloc.language.units import ONE

HEAD = "; safeloc-certificate/1\n; system: m\n(set-logic QF_LIA)\n(set-info :status unsat)\n"
X, Y, P, Q = number("x", ONE, -5, 5), number("t5", ONE, 0, 9), boolean("p"), boolean("and")
DECLARED = "(declare-const |x| Int)\n(declare-const |t5'| Int)\n(declare-const |p| Bool)\n(declare-const |and'| Bool)\n"


def told(body: str, dag: Dag | None = None) -> Certificate:
    """A text of these commands."""
    return read("a", HEAD + DECLARED + body, dag or Dag())


@pytest.mark.parametrize(
    ("term", "text"),
    [
        (X + Y <= 3, "(<= (+ |x| |t5'|) 3)"),
        ((X - Y).eq(-2), "(= (- |x| |t5'|) (- 2))"),
        (floor_div(X, 4) < X * 2, "(< (div |x| 4) (* |x| 2))"),
        (minimum(X, Y) <= maximum(X, Y), "(<= (ite (<= |x| |t5'|) |x| |t5'|) (ite (>= |x| |t5'|) |x| |t5'|))"),
        (ite(P, X, Y) <= 3, "(<= (ite |p| |x| |t5'|) 3)"),
        (all_of([P, all_of([Q, X <= 1])]), "(and (and |p| |and'|) (<= |x| 1) true)"),
        (any_of([P, any_of([Q, X <= 1])]), "(or |p| false (or |and'| (<= |x| 1)))"),
        (~P | Q, "(or (not (not (not |p|))) |and'|)"),
    ],
)
def test_both_translations_agree(term: object, text: str) -> None:
    """A declaration's term and the text of it are one node."""
    dag = Dag()
    certificate = told(f"(define-fun t9 () Bool {text})\n(assert t9)\n", dag)
    assert dag.conjuncts([Translation(dag)(term)]) == certificate.hypotheses  # type: ignore[arg-type]


@pytest.mark.parametrize(
    "body",
    [
        "(assert |y|)",
        "(assert t7)",
        "(assert (=> |p| |p|))",
        "(assert (<= |x| |x| |x|))",
        "(assert (not))",
        "(assert (<= |x| 1.5))",
        "(assert |p|) stray",
        "(assert |p|))",
        "((assert |p|)",
        "(declare-const |p| Bool)",
        "(declare-const |true| Bool)",
        "(declare-const |t5| Int)",
        "(declare-const |r| Real)",
        "(declare-fun |f| (Int) Int)",
        "(define-fun t1 ((|a| Int)) Int |a|)",
        "(define-fun |t1| () Bool |p|)",
        "(define-fun t1 () Bool |p|)\n(define-fun t1 () Bool |p|)",
        "(push 1)\n(assert |p|)\n(check-sat)\n(pop 1)",
        "(push 1)\n(assert (not |p|))\n(check-sat)",
        "(push 1)\n(assert (not |p|))\n(check-sat)\n(check-sat)\n(pop 1)",
        "(push 1)\n(assert (not |p|))\n(check-sat)\n(pop 1)\n(assert |p|)",
        "(push 2)\n(assert (not |p|))\n(check-sat)\n(pop 2)",
        "(set-option :global-declarations true)",
        "(reset-assertions)",
        '(echo "unsat")',
        "(assert |a\nb|)",
        "(assert |p|)\r",
    ],
)
def test_anything_else_is_refused(body: str) -> None:
    """A text that has not exactly the form of a certificate is refused."""
    with pytest.raises(InputError):
        told(body + "\n")


@pytest.mark.parametrize(
    "text",
    [
        "",
        "; other/1\n",
        HEAD.replace("certificate/1", "certificate/2"),
        HEAD.replace("; system: m\n", "; system: m\n; system: n\n"),
        HEAD.replace("(set-logic QF_LIA)\n", ""),
    ],
)
def test_a_head_that_is_not_ours(text: str) -> None:
    """Without our header, or with something in it twice, a text says nothing."""
    with pytest.raises(InputError):
        read("a", text, Dag())


def test_a_text_that_is_read() -> None:
    """Header, hypotheses part by part, goals one by one."""
    dag = Dag()
    goal = "(push 1)\n; why (push 1)\n(assert (not (<= |x| 3)))\n(check-sat)\n(pop 1)\n"
    found = read(
        "a",
        HEAD.replace("; system: m\n", "; system: m\n; relies on: b\n; relies on: c\n")
        + DECLARED
        + "(assert (and |p| |and'|))\n"
        + goal,
        dag,
    )
    write = Translation(dag)
    assert ({"system": "m"}, ("b", "c")) == (found.header, found.relies_on)
    assert frozenset([write(P), write(Q)]) == found.hypotheses
    assert (write(X <= 3),) == found.goals


def test_rewriting_keeps_the_normal_form() -> None:
    """Terms in the place of variables give what writing the result gives."""
    dag = Dag()
    write = Translation(dag)
    after = Rewriting(dag, {write(P): write(P & (X <= 1)), write(Q): dag.truth[False]})
    assert write((P & (X <= 1)) & (Y <= 2)) == after(write(all_of([P, Y <= 2, ~Q])))
    assert dag.truth[True] == after(write(~(P & Q)))
    assert write(Y) == after(write(ite(Q, X, Y)))


def test_terms_deeper_than_the_stack() -> None:
    """Depth is no limit."""
    dag, term = Dag(), X
    for _ in range(5000):
        term = maximum(term, Y) + 1  # type: ignore[assignment]
    node = Translation(dag)(term)
    assert Rewriting(dag, {})(node) == node
    assert 2 == len(dag.variables(node))
