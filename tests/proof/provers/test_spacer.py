"""Spacer: it finds invariants without lemmas, which are translated back and confirmed by other solvers."""

from __future__ import annotations

from dataclasses import replace

import pytest

from safeloc.codegen.smtlib import Query
from safeloc.language.expr import TRUE, Bool, number
from safeloc.language.interpret import holds
from safeloc.language.machine import Machine, Transition, modes
from safeloc.language.units import COUNT
from safeloc.language.verdict import Unknown, require_proved
from safeloc.proof.provers import spacer as module
from safeloc.proof.provers.limits import Limits, clock_after, effort
from safeloc.proof.provers.recheck import Certificate, certify
from safeloc.proof.provers.spacer import spacer
from tests.proof.provers.small import FULL_TOGETHER, LEFT, LEVEL, RIGHT, TICK, counter, goal, pair

LIMITS = Limits(seconds=20.0)


def test_it_finds_the_invariant_that_induction_would_need() -> None:
    """The claim that k-induction cannot prove alone is proved, by an invariant in our own terms."""
    target = goal(pair(), FULL_TOGETHER)
    proved = require_proved(spacer(target, LIMITS))
    assert proved.invariant is not None
    mode = target.system.variable("mode")
    assert holds(proved.invariant, {mode: 0, LEFT: 4, RIGHT: 4})
    assert not holds(proved.invariant, {mode: 0, LEFT: 4, RIGHT: 10})


def test_a_violation_is_left_to_bounded_search() -> None:
    """A violation that Spacer claims is undecided until a run shows it."""
    verdict = spacer(goal(counter(), LEVEL <= 9), LIMITS)
    assert isinstance(verdict, Unknown)
    assert verdict.reason == "spacer claims a violation; bounded search has to show it"


def test_a_wrong_invariant_is_found_out(monkeypatch: pytest.MonkeyPatch) -> None:
    """The new queries refuse an invariant that does not imply the claim."""

    def too_weak(*_: object) -> Bool:
        return TRUE

    monkeypatch.setattr(module, "read_bool", too_weak)
    verdict = spacer(goal(pair(), FULL_TOGETHER), LIMITS)
    assert isinstance(verdict, Unknown)
    assert verdict.reason.startswith("spacer: its invariant fails 'pair claim spacer implies'")


def test_z3_alone_proves_nothing(monkeypatch: pytest.MonkeyPatch) -> None:
    """If cvc5 cannot confirm the invariant in time, the verdict is Unknown."""

    def doubtful(query: Query, *, seconds: float, relies_on: list[str]) -> Certificate:
        return replace(certify(query, seconds=seconds, relies_on=relies_on), undecided=tuple(query.goals))

    monkeypatch.setattr(module, "certify", doubtful)
    verdict = spacer(goal(counter(), LEVEL <= 10), LIMITS)
    assert isinstance(verdict, Unknown)
    assert verdict.reason == "proved by spacer, but cvc5 could not confirm it in time"


def test_an_unconditional_property_uses_no_assumption() -> None:
    """Facts that hold only under the assumption are not used for an unconditional property."""
    machine = counter(assumption=~TICK, lemmas={"rests": LEVEL.eq(0)})
    require_proved(spacer(goal(machine, LEVEL <= 3), LIMITS))
    assert isinstance(spacer(goal(machine, LEVEL <= 3, unconditional=True), LIMITS), Unknown)


@pytest.mark.parametrize("seconds", [0.2, 0.4])
def test_its_effort_is_limited_and_counted(seconds: float) -> None:
    """Spacer looks at one state after the other of a long count: it ends at its limit, whatever the clock says."""
    (on,) = modes("ON")
    count = number("count", COUNT, 0, 500)
    slow = Machine(
        "slow", (on,), [TICK], {count: 0}, {}, [Transition("count", on, on, TICK & (count < 490), {count: count + 1})]
    )
    target, before = goal(slow, count < 480), effort()
    with clock_after(1_000):
        verdict = spacer(target, Limits(seconds=seconds))
    assert isinstance(verdict, Unknown)
    assert verdict.reason == "spacer: max. resource limit exceeded"
    assert seconds <= effort() - before <= 1.5 * seconds
