"""Drawn runs: reached goals are confirmed, impossible ones are not found, and the same seed draws the same runs."""

from __future__ import annotations

from safeloc.language.expr import number
from safeloc.language.interpret import run
from safeloc.language.machine import ANY, Machine, Transition, modes
from safeloc.language.monitor import check
from safeloc.language.spec import Goal, observe, reachable
from safeloc.language.system import TransitionSystem, lower
from safeloc.language.units import COUNT
from safeloc.language.verdict import Held
from safeloc.language.world import World
from safeloc.proof.provers.drawn import drawn
from safeloc.proof.provers.reachable_targets import without_assumption

SLOW, FAST, BROKEN = modes("SLOW", "FAST", "BROKEN")
X = number("x", COUNT, 0, 1000)
N = number("n", COUNT, 0, 1000)
START = number("start", COUNT, 0, 9)
MACHINE = Machine(
    "drawn",
    (SLOW, FAST, BROKEN),
    [X],
    {N: 0},
    {},
    [
        Transition("break", (SLOW, FAST), BROKEN, X > 900),
        Transition("go", SLOW, FAST, X > 400, {N: X}, rank=1),
        Transition("rest", FAST, SLOW, X < N, rank=1),
    ],
    world=World(
        ghosts={START: ANY}, moves={START: START}, clauses={"assumption": X <= 900}, reads_machine="the test asks it"
    ),
    initially=START > 2,
)


def goals(system: TransitionSystem) -> dict[str, Goal]:
    """One goal for each mode."""
    return {one.label: observe(system, reachable(one.label, MACHINE.mode.eq(one))) for one in MACHINE.modes}


def test_what_runs_come_to_under_the_assumption_is_found_with_a_run_that_shows_it() -> None:
    """The runs are the interpreter's, and lawful; the fault is not found, since the assumption excludes it."""
    system = lower(MACHINE)
    wanted = goals(system)
    found = drawn(list(wanted.values()))
    assert {wanted["SLOW"], wanted["FAST"]} == set(found)
    for goal, trace in found.items():
        again = run(system, [step.inputs for step in trace.steps], first=trace.initial)
        assert again.steps == trace.steps
        assert trace.initial["start"] > 2
        assert all(step.inputs["x"] <= 900 for step in trace.steps)
        assert isinstance(check(trace, goal.prop), Held)


def test_without_the_assumption_the_fault_is_found() -> None:
    """A run that satisfies the assumption for a while finds it, or one that never does."""
    broken = without_assumption(goals(lower(MACHINE))["BROKEN"])
    [trace] = drawn([broken]).values()
    assert trace.steps[-1].inputs["x"] > 900


def test_the_same_seed_draws_the_same() -> None:
    """A repeated proof gets the same witnesses."""
    first, second = (
        {
            goal.prop.name: (run.initial, run.steps)
            for goal, run in drawn(list(goals(lower(MACHINE)).values()), 3).items()
        }
        for _ in range(2)
    )
    assert first == second


def test_nothing_is_drawn_for_nothing_and_where_no_run_begins() -> None:
    """Without goals there are no runs, nor for a machine without a first state."""
    assert drawn([]) == {}
    off, on = modes("OFF", "ON")
    doomed = lower(
        Machine(
            "doomed", (off, on), [X], {}, {}, [Transition("start", off, on)],
            world=World(ghosts={START: ANY}, moves={START: START}), initially=START > START,
        )
    )  # fmt: skip
    assert drawn([observe(doomed, reachable("on", doomed.machines[0].mode.eq(on)))]) == {}
