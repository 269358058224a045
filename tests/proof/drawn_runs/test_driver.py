"""Driven runs: their statistics, the steps in which a property is required, and the continuation of known runs."""

from __future__ import annotations

from collections.abc import Sequence

import pytest

from safeloc.language.expr import boolean, number
from safeloc.language.interpret import run
from safeloc.language.machine import Machine, Transition, modes
from safeloc.language.spec import always, within
from safeloc.language.system import TransitionSystem, lower
from safeloc.language.units import COUNT
from safeloc.language.verdict import word
from safeloc.language.world import World
from safeloc.proof.drawn_runs import driver as driver_module
from safeloc.proof.drawn_runs.driver import Driver
from safeloc.proof.testing import run_tests
from tests.examples import EXAMPLES, Example

(ON,) = modes("ON")
P, N = boolean("p"), number("n", COUNT, 0, 50)


def _counter(limit: int = 50) -> TransitionSystem:
    """Counts the steps in which p was true; the assumption is that it never passes the limit."""
    moves = [Transition("count", ON, ON, P & (N < 50), {N: N + 1}), Transition("rest", ON, ON)]
    return lower(
        Machine(
            "counter",
            (ON,),
            [P],
            {N: 0},
            {},
            moves,
            world=World(clauses={"assumption": ~P | (N < limit)}, reads_machine="the test asks it"),
        )
    )


def _pressed(times: int) -> list[dict[str, bool]]:
    return [{"p": True}] * times


@pytest.mark.parametrize("example", EXAMPLES, ids=lambda example: example.name)
def test_a_plausible_run_keeps_the_assumption_and_is_what_the_interpreter_does(example: Example) -> None:
    """After any stretch the recorded stream, run by the interpreter, ends in the driver's own state."""
    driver = Driver(example.system, [example.holds])
    for seed, kind in enumerate(("steady", "ramp", "ends", "standstill", "reversal", "random")):
        driver.drive(kind, 10, seed, lean=seed)
    assert driver.kept
    assert driver.broken is None
    assert driver.statistics.steps == len(driver.stream) == driver.statistics.lawful == driver.statistics.deepest
    trace = run(example.system, driver.stream, first=driver.first)
    shown = {var.name: value for var, value in driver.state().items()}
    assert trace.steps[-1].state == {name: shown[name] for name in trace.steps[-1].state}


def test_a_broken_assumption_ends_what_relies_on_it() -> None:
    """After a fault only unconditional properties are required; before it, all are."""
    relies = always("relies", N <= 3)
    stands = always("stands", N <= 3, unconditional=True)
    for prop, broken in ((relies, False), (stands, True)):
        driver = Driver(_counter(limit=3), [prop])
        for seed in range(10):
            driver.drive("random", 20, seed, faulty=True)
        assert not driver.kept
        assert broken == (driver.broken is prop)


def test_what_a_property_is_given_counts_for_it_alone() -> None:
    """A run that breaks the further assumption of one property still has to satisfy the others."""
    bound, free = always("bound", N <= 3, further_assumption=N < 2), always("free", N <= 3)
    for props, culprit in (([bound], None), ([bound, free], free)):
        driver = Driver(_counter(), props, [run(_counter(), _pressed(5))])
        driver.follow(0)
        assert driver.broken is culprit


def test_a_known_run_is_gone_on_with() -> None:
    """`follow` starts anywhere along a run, with the observers of the properties in the right state."""
    late = within("answered", 6, P, ~P)
    driver = Driver(_counter(), [late], [run(_counter(), _pressed(6))])
    driver.follow(0, share=0.5)
    assert 3 == len(driver.stream)
    assert 3 == driver.state()[N]
    driver.follow(0)
    assert driver.broken is None
    while driver.broken is None and len(driver.stream) < 200:
        driver.drive("steady", 10, seed=len(driver.stream))
    trace = driver.trace()
    assert 7 <= len(trace.steps)
    assert all(step.inputs["p"] for step in trace.steps[-7:])


def test_a_known_run_that_breaks_a_property_says_so() -> None:
    """A violation along a known run is found in the step in which it happens."""
    never_two = always("at most one", N <= 1)
    driver = Driver(_counter(), [never_two], [run(_counter(), _pressed(9))])
    driver.follow(0)
    assert driver.broken is never_two
    assert 2 == len(driver.stream)
    assert 2 == len(driver.trace().steps)


def test_what_a_known_run_breaks_is_found_without_searching() -> None:
    """Following each known run once finds its violation, wherever a search would begin; other properties are searched
    on.
    """
    corpus = [run(_counter(), _pressed(times)) for times in (3, 45, 5, 49)]
    deep, holds = always("at most forty", N <= 40), always("at most fifty", N <= 50)
    driver = Driver(_counter(), [deep, holds], corpus)
    assert 1 == driver.breaking
    assert Driver(_counter(), [holds], corpus).breaking is None
    found = run_tests(_counter(), [deep, holds], examples=1, steps=1, seed=0, corpus=corpus)
    assert ["violated", "held"] == [word(one.result) for one in found]


def test_a_known_run_that_begins_another_one_is_not_made_again() -> None:
    """Its state, and what it breaks, are those that it has by itself; steps count once."""
    never_six = always("at most five", N <= 5)
    lengths = (9, 3, 6, 0, 7)
    driver = Driver(_counter(), [never_six], [run(_counter(), _pressed(times)) for times in lengths])
    assert driver.statistics.known == 6
    for which, times in enumerate(lengths):
        alone = Driver(_counter(), [never_six], [run(_counter(), _pressed(times))])
        driver.follow(which)
        alone.follow(0)
        assert (driver.stream, driver.broken) == (alone.stream, alone.broken)
        assert list(driver.state().values()) == list(alone.state().values())
    other = [run(_counter(), [*_pressed(3), {"p": False}]), run(_counter(), _pressed(4))]
    assert Driver(_counter(), [never_six], other).statistics.known == 8


def test_a_first_state_that_breaks_a_property_says_so() -> None:
    """A property that is false before any step is broken by the empty run."""
    driver = Driver(_counter(), [always("already one", N >= 1)])
    assert driver.broken is not None
    assert () == driver.trace().steps


def test_edges_tell_how_near_a_run_is() -> None:
    """The edge of a numeric property is its distance to failing; a logical property has none."""
    driver = Driver(_counter(), [always("few", N <= 40), always("logical", P | ~P)], [run(_counter(), _pressed(8))])
    driver.follow(0)
    assert {"few": -32.0} == driver.edges()


CHOICES = [("steady", 7, 1, False), ("steady", 5, 2, False), ("random", 4, 3, True), ("steady", 6, 4, False)]


def _follow(driver: Driver, choices: Sequence[tuple[str, int, int, bool]], start: int = 0) -> list[object]:
    """Drive along the choices; return what can be seen of the run."""
    if start < 0:
        driver.reset()
    else:
        driver.follow(start, 0.5)
    for kind, length, seed, faulty in choices:
        driver.drive(kind, length, seed, faulty=faulty)
    state = {var.name: value for var, value in driver.state().items()}
    return [driver.stream, driver.steps, state, driver.edges(), driver.kept, driver.broken]


@pytest.mark.parametrize("most", [driver_module.MOST_ROWS, 9])
def test_a_stretch_is_made_once(most: int, monkeypatch: pytest.MonkeyPatch) -> None:
    """From the same place it leads where it led before, whatever was driven meanwhile, and whatever was forgotten."""
    monkeypatch.setattr(driver_module, "MOST_ROWS", most)
    known = [run(_counter(), _pressed(6)), run(_counter(), _pressed(3))]
    props = [always("few", N <= 40), always("logical", P | ~P)]
    remembering = Driver(_counter(), props, known)
    for start in (-1, 0, 1, 0, -1):
        for choices in (CHOICES, CHOICES[:2], [*CHOICES[:2], CHOICES[3]], CHOICES):
            assert _follow(remembering, choices, start) == _follow(Driver(_counter(), props, known), choices, start)


def test_a_stretch_that_is_remembered_is_not_counted_again() -> None:
    """Steps are those that were made."""
    driver = Driver(_counter(), [always("few", N <= 50)])
    _follow(driver, CHOICES, -1)
    once = driver.statistics.steps
    assert once == sum(length for _, length, _, _ in CHOICES)
    _follow(driver, CHOICES[:3], -1)
    assert driver.statistics.steps == once
    _follow(driver, [*CHOICES[:3], CHOICES[0]], -1)
    assert driver.statistics.steps == once + CHOICES[0][1]


def test_a_remembered_stretch_that_breaks_a_property_breaks_it_again() -> None:
    """As when it is replayed to show the failure."""
    driver = Driver(_counter(), [always("few", N <= 3)])
    first, second = (_follow(driver, [("random", 25, 3, False)], -1) for _ in range(2))
    assert first == second
    assert driver.broken is driver.properties[0]
    assert driver.trace().steps


def test_statistics_for_a_report() -> None:
    """Notes name the transitions that fired and those that never did; the rate includes drawing and repair."""
    driver = Driver(_counter(), [always("few", N <= 50)])
    for seed in range(4):
        driver.drive("steady", 25, seed)
    notes = driver.statistics.notes(["count", "rest", "no such"])
    assert "100" == notes["steps"] == notes["steps that keep the assumption"]
    assert "0" == notes["steps given up"]
    assert "no such" == notes["never fired"]
    assert 0 < int(notes["steps per second, drawing and repair included"]) < 1_000_000
