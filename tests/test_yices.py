"""yices decides the goals of a certificate: together, then alone; what it cannot decide is unknown, and never confirmed."""

from __future__ import annotations

import re
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

from safeloc import yices
from safeloc.codegen.smtlib import Query, to_smtlib
from safeloc.language.expr import NumVar
from safeloc.language.units import ONE

needs_yices = pytest.mark.skipif(yices.program() is None, reason="yices is not installed")
X = NumVar("x", ONE, 0, 9)
HEAD = "(set-logic QF_NIA)\n(declare-const a Int)\n(declare-const b Int)"
FACTORS = "(assert (and (> a 1) (> b 1) (= (* a b) 1000000016000000063)))"
"""A product of two primes: no solver finds them in seconds."""


def text_of(*goals: str) -> str:
    """A certificate with these goals, each written as what is asserted."""
    return "".join([HEAD, *(f"\n(push 1)\n{goal}\n(check-sat)\n(pop 1)" for goal in goals), "\n"])


FALSE, TRUE = "(assert (< a a))", "(assert (= a a))"


@needs_yices
def test_it_says_its_version() -> None:
    """As results name it."""
    assert re.fullmatch(r"\d+(\.\d+)+", str(yices.version()))


@pytest.fixture
def elsewhere(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Path]:
    """A folder that alone is searched for the program."""
    monkeypatch.setattr(sys, "executable", str(tmp_path / "python"))
    monkeypatch.setenv("PATH", "/nowhere")
    monkeypatch.setattr(yices, "LOOK_S", 2.0)
    yices._installed.cache_clear()
    yield tmp_path
    yices._installed.cache_clear()


@pytest.mark.parametrize(
    "content",
    [
        None,
        "#!/bin/sh\nexit 1\n",
        "#!/bin/sh\necho Yices 2.6.5; exit 1\n",
        "#!/bin/sh\necho hello\n",
        "#!/nowhere/sh\n",
        "#!/bin/sh\nexec /bin/sleep 60\n",
    ],
)
def test_a_program_that_does_not_run_counts_as_none(elsewhere: Path, content: str | None) -> None:
    """It is optional: without one that says its version, all is left to cvc5."""
    if content is not None:
        (elsewhere / "yices-smt2").write_text(content)
        (elsewhere / "yices-smt2").chmod(0o755)
    assert yices.program() is None
    assert yices.version() is None


def test_a_program_beside_python_is_found(elsewhere: Path) -> None:
    """By its path and its version."""
    path = elsewhere / "yices-smt2"
    path.write_text("#!/bin/sh\necho Yices 2.9.1\n")
    path.chmod(0o755)
    assert yices.program() == str(path)
    assert yices.version() == "2.9.1"


@needs_yices
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


@needs_yices
def test_a_certificate_is_read() -> None:
    """Hypotheses are asserted, and each goal is negated."""
    assert yices.answers(to_smtlib(Query("q", [X > 3], {"a": X > 2, "b": X > 4})), 5.0, 5.0) == ["unsat", "sat"]
    assert yices.answers(to_smtlib(Query("q", [X > 3], {"a": X > 2})), 5.0, 5.0) == ["unsat"]


@pytest.mark.thorough
@needs_yices
def test_a_hard_goal_is_unknown() -> None:
    """Alone or among others, and others are decided all the same."""
    assert yices.answers(text_of(FACTORS), 1.0, 1.0) == ["unknown"]
    assert yices.answers(text_of(FALSE, FACTORS, FALSE), 1.0, 1.0) == ["unsat", "unknown", "unsat"]


@needs_yices
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


@needs_yices
def test_more_answers_than_goals_confirm_nothing() -> None:
    """A text with a question outside of its goals is none that we write."""
    text = text_of(FALSE, FALSE).replace("\n(push 1)", "\n(check-sat)\n(push 1)", 1)
    assert yices.answers(text, 5.0, 5.0) == ["3 answers to 2 goals"] * 2
