"""Runs along the way of another one: the same transitions and flags, other numbers; no run where there is none."""

from __future__ import annotations

from safeloc.language.expr import boolean, number
from safeloc.language.machine import Machine, Transition, modes
from safeloc.language.spec import Goal, always, observe
from safeloc.language.system import lower
from safeloc.language.trace import Trace
from safeloc.language.units import MM
from safeloc.language.verdict import Violated
from safeloc.language.world import Law, World
from safeloc.proof.provers.along import along
from safeloc.proof.provers.bmc import bmc
from safeloc.proof.provers.limits import Limits

LIMITS = Limits(seconds=5)
IDLE, GOING = modes("IDLE", "GOING")
STEP, GO, PLACE = number("distance_mm", MM, 0, 100), boolean("go"), number("place_mm", MM, 0, 10_000)


def goal(longest: int, most: int = 25, extra: bool = False) -> Goal:
    """A walk of steps, none longer than `longest`, should stay within `most`."""
    machine = Machine(
        name="walk",
        modes=(IDLE, GOING),
        inputs=[STEP, GO, *([boolean("further")] if extra else [])],
        state={PLACE: 0},
        outputs={"place_mm": PLACE},
        transitions=[
            Transition("go", (IDLE, GOING), GOING, GO & (PLACE < 9_000), {PLACE: PLACE + STEP}),
            Transition("stand", (IDLE, GOING), IDLE, rank=1),
        ],
        world=World(clauses={"steps": Law(longest >= STEP, "No step is longer.")}),
    )
    return observe(lower(machine), always("near", most >= PLACE))


def way(of: Goal) -> Trace:
    found = bmc(of, LIMITS)
    assert isinstance(found, Violated)
    assert found.trace is not None
    return found.trace


def test_a_run_along_the_way_has_its_transitions_and_other_numbers() -> None:
    given = way(goal(10))
    assert len(given.steps) == 3
    found = along(goal(9), given, LIMITS)
    assert found is not None
    assert [one.fired for one in found.steps] == [one.fired for one in given.steps]
    assert all(one.inputs["distance_mm"] <= 9 for one in found.steps)
    assert found.steps[-1].state["place_mm"] > 25


def test_where_steps_are_too_short_for_the_way_there_is_none() -> None:
    """Four steps of 8 mm would break the claim; along three there is no run."""
    assert along(goal(8), way(goal(10)), LIMITS) is None
    assert len(way(goal(8)).steps) == 4


def test_a_way_of_a_machine_with_other_inputs_is_no_way() -> None:
    assert along(goal(10, extra=True), way(goal(10)), LIMITS) is None
