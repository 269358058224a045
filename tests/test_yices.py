"""yices decides the goals of a certificate: together, then alone; what it cannot decide is unknown, and never confirmed."""

from __future__ import annotations

import re
import sys
import time

import pytest

from safeloc import yices
from safeloc.codegen.smtlib import Query, to_smtlib
from safeloc.language.expr import NumVar
from safeloc.language.units import ONE

X = NumVar("x", ONE, 0, 9)
HEAD = "(set-logic QF_NIA)\n(declare-const a Int)\n(declare-const b Int)"
FACTORS = "(assert (and (> a 1) (> b 1) (= (* a b) 1000000016000000063)))"
"""A product of two primes: no solver finds them in seconds."""


def text_of(*goals: str) -> str:
    """A certificate with these goals, each written as what is asserted."""
    return "".join([HEAD, *(f"\n(push 1)\n{goal}\n(check-sat)\n(pop 1)" for goal in goals), "\n"])


FALSE, TRUE = "(assert (< a a))", "(assert (= a a))"


def test_it_is_installed_beside_python() -> None:
    """The tests have it, and it says its version."""
    assert yices.program()
    assert re.fullmatch(r"\d+\.\d+.*", str(yices.version()))


def test_without_it_there_is_no_version(monkeypatch: pytest.MonkeyPatch) -> None:
    """It is optional."""
    monkeypatch.setattr(sys, "executable", "/nowhere/python")
    monkeypatch.setenv("PATH", "/nowhere")
    yices._program.cache_clear()
    try:
        assert yices.program() is None
        assert yices.version() is None
    finally:
        yices._program.cache_clear()


@pytest.mark.parametrize(
    ("goals", "expected"),
    [
        ([FALSE], ["unsat"]),
        ([TRUE], ["sat"]),
        ([FALSE, TRUE, FALSE], ["unsat", "sat", "unsat"]),
        ([], []),
    ],
)
def test_each_goal_has_its_own_answer(goals: list[str], expected: list[str]) -> None:
    """One goal does not decide another."""
    assert yices.answers(text_of(*goals), 5.0, 5.0) == expected


def test_a_certificate_is_read() -> None:
    """Hypotheses are asserted, and each goal is negated."""
    assert yices.answers(to_smtlib(Query("q", [X > 3], {"a": X > 2, "b": X > 4})), 5.0, 5.0) == ["unsat", "sat"]
    assert yices.answers(to_smtlib(Query("q", [X > 3], {"a": X > 2})), 5.0, 5.0) == ["unsat"]


def test_a_hard_goal_is_unknown_and_ends_in_time() -> None:
    """Alone or among others, and others are decided all the same."""
    began = time.process_time()
    assert yices.answers(text_of(FACTORS), 1.0, 1.0) == ["unknown"]
    assert yices.answers(text_of(FALSE, FACTORS, FALSE), 1.0, 1.0) == ["unsat", "unknown", "unsat"]
    assert time.process_time() - began < 1.0  # the work is done by another process


@pytest.mark.parametrize(
    "broken",
    [
        text_of(FALSE).replace("Int)", "Itn)"),
        text_of(FALSE, FALSE).replace("QF_NIA", "no logic"),
        text_of("(assert (< a nobody))"),
        text_of(FALSE)[:40] + text_of(FALSE)[80:],
    ],
)
def test_a_text_that_it_cannot_read_confirms_nothing(broken: str) -> None:
    """Its message takes the place of the answers."""
    assert "unsat" not in yices.answers(broken, 5.0, 5.0)


def test_more_answers_than_goals_confirm_nothing() -> None:
    """A text with a question outside of its goals is none that we write."""
    text = text_of(FALSE, FALSE).replace("\n(push 1)", "\n(check-sat)\n(push 1)", 1)
    assert yices.answers(text, 5.0, 5.0) == ["3 answers to 2 goals"] * 2
