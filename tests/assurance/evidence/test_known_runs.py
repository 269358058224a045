"""A breach that a bounded search does not come to is found from a known run that comes near it."""

from __future__ import annotations

from safeloc.assurance.evidence.effects import effect
from safeloc.assurance.evidence.known_runs import run_that_goes_on
from safeloc.language.expr import boolean, ite, number
from safeloc.language.machine import Machine, Transition, modes
from safeloc.language.spec import always, observe, within
from safeloc.language.system import lower
from safeloc.language.units import COUNT
from safeloc.language.world import World
from safeloc.proof.cores.clauses import ClauseId, without
from safeloc.proof.provers.limits import Limits
from safeloc.proof.provers.recorded_witnesses import Recording
from safeloc.target import Target

UP, DOWN = modes("UP", "DOWN")
GO, STOP = boolean("go"), boolean("stop")
COUNTED = number("counted", COUNT, 0, 99)
WENT = number("went", COUNT, 0, 99)


def _machine(most: int) -> Machine:
    """One that counts the cycles in which it goes; by the law of its world that is never long."""
    law = {"it never goes for long": GO.implies(WENT < most)}
    world = World({WENT: 0}, moves={WENT: ite(GO & (WENT < 99), WENT + 1, WENT)}, clauses=law)
    rows = [
        Transition("count", UP, UP, GO & ~STOP & (COUNTED < 99), {COUNTED: COUNTED + 1}),
        Transition("give up", UP, DOWN, STOP),
    ]
    return Machine("counter", (UP, DOWN), [GO, STOP], {COUNTED: 0}, {"counted": COUNTED}, rows, world=world)


MACHINE = _machine(12)
SYSTEM = lower(MACHINE)
FEW = always("few", COUNTED < 30)
BROKEN = ClauseId("counter", "it never goes for long")
LIMITS = Limits(depth=5, seconds=5)
GOING, RESTING = {"go": True, "stop": False}, {"go": False, "stop": False}


def test_a_run_goes_on_from_a_known_one() -> None:
    """It begins like the known one, and takes the fewest steps after it."""
    goal = observe(without(SYSTEM, [BROKEN]), FEW)
    found = run_that_goes_on(goal, [Recording({}, [GOING] * 27)], LIMITS)
    assert found is not None and 30 == len(found.steps)
    assert 30 == found.steps[-1].state["counted"]
    assert None is run_that_goes_on(goal, [Recording({}, [GOING] * 20)], LIMITS)
    assert None is run_that_goes_on(goal, [], LIMITS)


def test_a_known_run_counts_as_far_as_it_is_lawful() -> None:
    """With the law unbroken nothing goes on from where the law was broken."""
    assert None is run_that_goes_on(observe(SYSTEM, FEW), [Recording({}, [GOING] * 29)], LIMITS)


def test_what_the_claim_waits_for_has_begun_in_the_known_run() -> None:
    """The observer of `within` counts on from the known run."""
    soon = within("given up soon", 28, COUNTED.eq(1), MACHINE.mode.eq(DOWN))
    goal = observe(SYSTEM, soon)
    found = run_that_goes_on(goal, [Recording({}, [GOING, *[RESTING] * 26])], LIMITS)
    assert found is not None and 29 == len(found.steps)


def test_an_undecided_claim_is_decided_by_the_run_of_another() -> None:
    """The run that breaks one claim is where the next search begins."""
    few, more = always("few", COUNTED < 4), always("more", COUNTED < 9)
    machine = _machine(3)
    target = Target("counter", (machine,), lower(machine), (few, more))
    one = effect(target, (BROKEN,), ("few", "more"), LIMITS)
    assert ({"few": 4, "more": 9}, ()) == (one.lost, one.open_)
