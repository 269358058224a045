"""Counterexamples lose the steps and inputs that they do not need, and stay counterexamples."""

from __future__ import annotations

import pytest

from safeloc.errors import EngineError
from safeloc.language.expr import boolean, number, optional
from safeloc.language.machine import Machine, Transition, modes
from safeloc.language.spec import Goal, always, observe
from safeloc.language.system import lower
from safeloc.language.units import COUNT, MM
from safeloc.language.world import World
from safeloc.proof.provers.replayed_evidence import replayed
from safeloc.proof.provers.shorten import shortened

(ON,) = modes("ON")
PRESS, NOISE, N = boolean("press"), number("noise_mm", MM, -9, 9), number("n", COUNT, 0, 90)
EXTRA = optional("extra_mm", MM, 5, 9)


def _goal(least: int) -> Goal:
    """Broken by `least` presses; the noise must never be 9."""
    moves = [Transition("count", ON, ON, PRESS & (N < 90), {N: N + 1}), Transition("rest", ON, ON)]
    machine = Machine(
        "presses",
        (ON,),
        [PRESS, NOISE, EXTRA],
        {N: 0},
        {},
        moves,
        world=World(clauses={"assumption": NOISE < 9}, reads_machine="the test asks it"),
    )
    return observe(lower(machine), always("few", N < least))


def _stream(steps: int, noise: int = 4) -> list[dict[str, int | bool]]:
    row = {"noise_mm": noise, "extra_mm": 7, EXTRA.present.name: True}
    return [{"press": n % 5 == 0, **row} for n in range(steps)]


def test_only_what_breaks_it_is_left() -> None:
    """Of 200 steps the 7 presses remain; the other inputs are at rest or absent."""
    goal = _goal(7)
    trace = shortened(goal, {}, _stream(200))
    assert 7 == len(trace.steps)
    assert [{"press": True, "noise_mm": 0}] * 7 == trace.stream()
    assert replayed(goal, trace.initial, trace.stream()) is not None


def test_the_assumption_stays_kept() -> None:
    """A stream that breaks the assumption is no counterexample and is refused."""
    with pytest.raises(EngineError, match=r"^a run found for 'few' does not break it in the interpreter\.$"):
        shortened(_goal(7), {}, _stream(200, noise=9))


def test_a_harmless_stream_is_refused() -> None:
    """A stream that does not break the property is not called a counterexample."""
    with pytest.raises(EngineError, match="does not break it"):
        shortened(_goal(60), {}, _stream(20))


def test_without_time_the_run_is_only_cut() -> None:
    """With no time left the run up to the violation is returned as it is."""
    trace = shortened(_goal(7), {}, _stream(200), seconds=0)
    assert 31 == len(trace.steps)
