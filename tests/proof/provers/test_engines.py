"""Every engine on every example machine: a true property is never violated, a false one never proved."""

import pytest

from safeloc.language.spec import observe
from safeloc.language.verdict import Proved, Unknown, Violated, require_proved
from safeloc.proof.provers.bmc import bmc
from safeloc.proof.provers.kinduction import kinduction
from safeloc.proof.provers.limits import Limits
from safeloc.proof.provers.spacer import spacer
from tests.examples import EXAMPLES, Example
from tests.proof.provers.small import ASKED_FIRST

EVERY = pytest.mark.parametrize("example", EXAMPLES, ids=lambda example: example.name)
LIMITS = Limits(depth=12, seconds=20.0)


@EVERY
def test_kinduction_proves_what_holds(example: Example) -> None:
    """The true property is proved for streams of any length, and cvc5 confirms every certificate."""
    proved = require_proved(kinduction(observe(example.system, example.holds), LIMITS))
    assert proved.engine == f"{proved.depth}-induction"
    assert proved.rechecked == (ASKED_FIRST,)
    assert all("(check-sat)" in text for text in proved.certificates.values())


@EVERY
def test_kinduction_does_not_prove_what_fails(example: Example) -> None:
    """The false property stays undecided: induction finds no runs."""
    verdict = kinduction(observe(example.system, example.fails), LIMITS)
    assert isinstance(verdict, Unknown)
    assert verdict.depth < example.fails_depth


@EVERY
def test_bmc_finds_the_shortest_violation(example: Example) -> None:
    """The trace has as many steps as the example declares, and no shorter one exists."""
    goal = observe(example.system, example.fails)
    verdict = bmc(goal, LIMITS)
    assert isinstance(verdict, Violated)
    assert verdict.trace is not None
    assert len(verdict.trace.steps) == example.fails_depth
    shorter = bmc(goal, Limits(depth=example.fails_depth - 1, seconds=20.0))
    assert isinstance(shorter, Unknown)
    assert shorter.depth == example.fails_depth - 1


@EVERY
def test_bmc_never_proves(example: Example) -> None:
    """Bounded search of a true property ends undecided, at its depth limit."""
    verdict = bmc(observe(example.system, example.holds), Limits(depth=4, seconds=20.0))
    assert isinstance(verdict, Unknown)
    assert (verdict.reason, verdict.depth) == ("depth limit of 4 steps", 4)


@EVERY
def test_spacer_proves_what_holds(example: Example) -> None:
    """Spacer's own invariant is inductive and cvc5 confirms the three queries about it."""
    proved = require_proved(spacer(observe(example.system, example.holds), LIMITS))
    assert proved.invariant is not None
    own = [file for file in proved.certificates if "-spacer-" in file]
    assert len(own) == 3


@pytest.mark.thorough(ordinary=4)
@EVERY
def test_spacer_does_not_prove_what_fails(example: Example) -> None:
    """A violation that Spacer claims is left to bounded search, which can show it."""
    verdict = spacer(observe(example.system, example.fails), Limits(seconds=1.0))
    assert not isinstance(verdict, Proved)
