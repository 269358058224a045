"""Runs that engines claim: replayed for one goal, and for many at once; a claim that the interpreter does not confirm is an error."""

from __future__ import annotations

import pytest

from safeloc.errors import EngineError
from safeloc.language.expr import number
from safeloc.language.machine import Machine, Transition, modes
from safeloc.language.spec import Goal, Watch, always, observe, once, watch
from safeloc.language.system import lower
from safeloc.language.units import COUNT
from safeloc.language.world import World
from safeloc.proof.provers.replayed_evidence import confirmed, confirmed_together

(ONLY,) = modes("ONLY")
X = number("x", COUNT, 0, 9)
SUM = number("sum", COUNT, 0, 1_000)
SYSTEM = lower(
    Machine(
        "adding",
        (ONLY,),
        [X],
        {SUM: 0},
        {},
        [Transition("add", ONLY, ONLY, X > 0, {SUM: SUM + X})],
        world=World(clauses={"small": X <= 5}),
    )
)
STREAM = [{"x": 1}, {"x": 3}, {"x": 0}, {"x": 5}]


@pytest.fixture
def watched() -> Watch:
    """Two goals over state and one with an observer: they fail in the first state, after two steps, and after four."""
    terms = {"none yet": SUM > 0, "below four": SUM < 4, "no five before": ~once(X.eq(5))}
    return watch(SYSTEM, [observe(SYSTEM, always(name, term)) for name, term in terms.items()])


def test_one_replay_gives_each_goal_the_run_that_breaks_it(watched: Watch) -> None:
    """The runs are those of a replay for each goal, each as short as can be."""
    together = confirmed_together(watched, watched.goals, {}, STREAM, "a test")
    assert {goal: confirmed(goal, {}, STREAM, "a test") for goal in watched.goals} == together
    assert [0, 2, 4] == [len(trace.steps) for trace in together.values()]


def test_a_goal_that_the_run_keeps_is_an_error(watched: Watch) -> None:
    """Whatever the other goals say; and so is a stream that breaks the assumption before it breaks the goal."""
    kept: list[Goal] = [watched.goals[1], watched.goals[2]]
    with pytest.raises(EngineError, match=r"a test: its stream for 'no five before' does not break the property"):
        confirmed_together(watched, kept, {}, STREAM[:3], "a test")
    with pytest.raises(EngineError, match=r"'below four' does not break"):
        confirmed_together(watched, kept, {}, [{"x": 9}, *STREAM], "a test")


def test_a_stream_that_cannot_be_read_is_an_error(watched: Watch) -> None:
    """A value beyond its range is no input, whoever says so."""
    for stream in ([{"x": 10}], [{}]):
        with pytest.raises(EngineError, match=r"a test: its stream for .* is not admissible"):
            confirmed_together(watched, watched.goals, {}, stream, "a test")
