"""The run of a defence breaks as few laws as possible, those of a device first, and its result says which ones and when."""

from __future__ import annotations

from safeloc.language.expr import Bool, NumVar, number
from safeloc.language.interpret import run as played
from safeloc.language.machine import ANY, Machine, Transition, modes
from safeloc.language.spec import Goal
from safeloc.language.system import TransitionSystem, lower
from safeloc.language.trace import Trace
from safeloc.language.units import COUNT
from safeloc.language.verdict import Proved
from safeloc.language.world import Law, World
from safeloc.proof.cores.clauses import ClauseId
from safeloc.proof.provers.found_run import FoundRun, shown_freely
from safeloc.proof.provers.limits import Limits
from safeloc.proof.provers.obligations import obligations
from safeloc.proof.provers.reachable_targets import targets_of
from safeloc.proof.provers.sparing_run import begins_lawfully, broken_laws, how_it_breaks, sparing_run

USUAL, WITHDRAWN = modes("USUAL", "WITHDRAWN")
LIMITS = Limits(depth=6, seconds=20.0)
WHEEL, RADAR, SPEED = (number(name, COUNT, 0, 9) for name in ("wheel", "radar", "speed"))
SEEN = number("seen", COUNT, 0, 2)
LAWS = {
    "the train is slow": Law(SPEED <= 4, owner="operator"),
    "the wheel is right": Law(WHEEL <= 4, owner="supplier"),
    "the radar is right": Law(RADAR <= 4, owner="supplier"),
}
WILD = {"wheel": 9, "radar": 9, "speed": 9}


def withdrawing(when: Bool, *, seen: Bool | None = None) -> TransitionSystem:
    """A machine that withdraws under a condition; it counts the steps with `seen`, at most two."""
    counting = [] if seen is None else [Transition("count", USUAL, USUAL, seen & (SEEN < 2), {SEEN: SEEN + 1}, rank=1)]
    machine = Machine(
        name="guarding",
        modes=(USUAL, WITHDRAWN),
        inputs=[WHEEL, RADAR, SPEED],
        state={SEEN: 0},
        outputs={},
        transitions=[
            Transition("withdraw", USUAL, WITHDRAWN, when),
            *counting,
            Transition("stay", (USUAL, WITHDRAWN), USUAL, rank=2),
        ],
        world=World(clauses=LAWS),
    )
    return lower(machine)


def goal_of(system: TransitionSystem) -> Goal:
    """To withdraw, whatever the world allows."""
    return next(one.free for one in targets_of(system) if one.name.endswith("withdraw"))


def wild(system: TransitionSystem, steps: int) -> Trace:
    """A run that breaks every law in every step."""
    return played(goal_of(system).plain, [WILD] * steps)


def spared(system: TransitionSystem, steps: int) -> Trace:
    """The run that is found in place of the wild one."""
    return sparing_run(goal_of(system), wild(system, steps), LIMITS)


def test_one_law_is_broken_in_one_step_and_all_else_is_at_rest() -> None:
    """Of a run that breaks three laws."""
    system = withdrawing(WHEEL > RADAR + 5)
    [step] = spared(system, 1).steps
    assert dict(step.inputs) == {"wheel": 6, "radar": 0, "speed": 0}
    assert how_it_breaks(system, spared(system, 1)) == "breaks one law: 'the wheel is right' in step 1"


def test_a_device_is_at_fault_before_the_train_is() -> None:
    """Where either could be, the law of the operator is kept; where only the train can be, it is broken."""
    either = withdrawing((WHEEL > 4) | (SPEED > 4))
    assert set(broken_laws(either, spared(either, 1))) == {ClauseId("guarding", "the wheel is right")}
    train = withdrawing(SPEED > 7)
    assert how_it_breaks(train, spared(train, 1)) == "breaks one law: 'the train is slow' in step 1"


def test_one_law_in_two_steps_comes_before_two_laws() -> None:
    """A fault that lasts is one fault."""
    system = withdrawing((SEEN.eq(2)) & (RADAR <= 4), seen=RADAR > 4)
    assert how_it_breaks(system, spared(system, 2)) == "breaks one law: 'the radar is right' in steps 1 to 2"


def test_two_laws_where_one_is_not_enough() -> None:
    """In one step, and the third is kept."""
    system = withdrawing((WHEEL > 4) & (RADAR > 4))
    told = "breaks 2 laws: 'the wheel is right' in step 1, 'the radar is right' in step 1"
    assert how_it_breaks(system, spared(system, 1)) == told


def test_a_run_may_take_more_steps_to_break_less() -> None:
    """The wheel alone has to be wrong for it, but it takes a step of counting before."""
    system = withdrawing((WHEEL > 4) & (SEEN.eq(1) | (RADAR > 4)), seen=RADAR.eq(4))
    found = spared(system, 1)
    assert len(found.steps) == 2
    assert how_it_breaks(system, found) == "breaks one law: 'the wheel is right' in step 2"


def test_the_run_at_hand_stays_where_none_breaks_fewer() -> None:
    """Three laws have to be broken at once; and no time finds nothing."""
    all_three = withdrawing((WHEEL > 4) & (RADAR > 4) & (SPEED > 4))
    at_hand = wild(all_three, 1)
    assert sparing_run(goal_of(all_three), at_hand, LIMITS) is at_hand
    told = (
        "breaks 3 laws: 'the train is slow' in step 1, 'the wheel is right' in step 1, 'the radar is right' in step 1"
    )
    assert how_it_breaks(all_three, at_hand) == told


def test_many_laws_and_steps_are_counted() -> None:
    """Three laws are named; steps that do not follow each other are counted."""
    system = withdrawing(WHEEL > 4)
    quiet = dict.fromkeys(WILD, 0)
    run = played(goal_of(system).plain, [WILD, quiet, {**quiet, "radar": 9}])
    told = "breaks 3 laws: 'the train is slow' in step 1, 'the wheel is right' in step 1, 'the radar is right' in 2 of 3 steps"
    assert how_it_breaks(system, run) == told
    assert how_it_breaks(system, played(goal_of(system).plain, [quiet])) == ""


def test_a_run_that_keeps_every_law_is_no_defence() -> None:
    """A search without the assumption may find one; it stays, and is told as a run under the assumption."""
    system = withdrawing(WHEEL > 2)
    at_hand = played(goal_of(system).plain, [{"wheel": 3, "radar": 4, "speed": 4}])
    assert sparing_run(goal_of(system), at_hand, LIMITS) is at_hand
    verdict, method = shown_freely(goal_of(system), FoundRun(at_hand, "bmc", "witness"), "not searched")
    assert isinstance(verdict, Proved) and verdict.witness is at_hand
    assert method == "witness under the assumption"


def test_a_run_that_does_not_reach_the_goal_is_never_the_answer() -> None:
    """What a search claims is replayed; a goal that is out of reach leaves the run at hand."""
    system = withdrawing((WHEEL > 4) & (WHEEL < 3))
    at_hand = wild(system, 2)
    assert sparing_run(goal_of(system), at_hand, LIMITS) is at_hand


def test_the_first_state_is_one_that_the_world_allows() -> None:
    """A run from another one says so, and a found one begins in an allowed state."""
    place: NumVar = number("place", COUNT, 0, 9)
    machine = Machine(
        name="placed",
        modes=(USUAL, WITHDRAWN),
        inputs=[WHEEL],
        state={SEEN: ANY},
        outputs={},
        transitions=[
            Transition("withdraw", USUAL, WITHDRAWN, WHEEL > 4),
            Transition("stay", (USUAL, WITHDRAWN), USUAL, rank=1),
        ],
        world=World(ghosts={place: ANY}, moves={place: place}, clauses={"the wheel is there": WHEEL <= place}),
        initially=place <= SEEN,
    )
    system = lower(machine)
    at_hand = played(goal_of(system).plain, [{"wheel": 9}, {"wheel": 9}], first={"place": 7, "seen": 2})
    told = "begins in a state that its world excludes and breaks one law: 'the wheel is there' in steps 1 to 2"
    assert how_it_breaks(system, at_hand) == told
    found = sparing_run(goal_of(system), at_hand, LIMITS)
    assert begins_lawfully(system, found)
    assert how_it_breaks(system, found) == "breaks one law: 'the wheel is there' in step 1"


def test_the_result_says_it() -> None:
    """In its method, with what is known while the assumption is kept."""
    system = withdrawing(WHEEL > RADAR + 5)
    found = {one.id: one.method for one in obligations(system, LIMITS)}
    told = "a defence: witness that breaks one law: 'the wheel is right' in step 1; proved impossible while the assumption is kept"
    assert found["guarding/obligation/transition guarding: withdraw"] == told
