"""Random runs beside recordings: they go on from a recording, obey the assumption, and are the interpreter's."""

from __future__ import annotations

from dataclasses import replace

import pytest

from safeloc.errors import EngineError
from safeloc.language.expr import Bool, number
from safeloc.language.interpret import run
from safeloc.language.machine import ANY, Machine, Transition, modes
from safeloc.language.spec import Goal, observe, reachable
from safeloc.language.system import TransitionSystem, lower
from safeloc.language.units import COUNT
from safeloc.language.world import World
from safeloc.proof.provers import beside as module
from safeloc.proof.provers.beside import beside
from safeloc.proof.provers.drawn import drawn
from safeloc.proof.provers.reachable_targets import without_assumption
from safeloc.proof.provers.recorded_witnesses import Recording

DOOR, VAULT, INSIDE, ALARM = modes("DOOR", "VAULT", "INSIDE", "ALARM")
KEY, HAND = number("key", COUNT, 0, 1_000_000), number("hand", COUNT, 0, 9)
START, SUM = number("start", COUNT, 0, 9), number("sum", COUNT, 0, 1_000_000)
MACHINE = Machine(
    "vault",
    (DOOR, VAULT, INSIDE, ALARM),
    [KEY, HAND],
    {SUM: 0},
    {},
    [
        Transition("open", DOOR, VAULT, KEY.eq(123_457), {SUM: KEY}),
        Transition("turn", VAULT, INSIDE, KEY.eq(765_431) & (HAND < 5), {SUM: KEY}),
        Transition("grab", INSIDE, ALARM, HAND > 8),
    ],
    world=World(
        ghosts={START: ANY}, moves={START: START}, clauses={"a calm hand": HAND <= 7}, reads_machine="the test asks it"
    ),
    initially=START > 2,
)
SYSTEM = lower(MACHINE)
RECORDED = Recording({"start": 4}, [{"key": 123_457, "hand": 6}] * 3 + [{"key": 765_431, "hand": 7}] * 3)


def _goal(system: TransitionSystem, name: str, term: Bool) -> Goal:
    return observe(system, reachable(name, term))


def test_what_a_recording_comes_near_to_is_found() -> None:
    """A changed input leads from a recorded mode to the next one; random runs from the first state find neither key."""
    inside = _goal(SYSTEM, "inside", MACHINE.mode.eq(INSIDE))
    assert drawn([inside]) == {}
    trace = beside([inside], [RECORDED])[inside]
    again = run(SYSTEM, [step.inputs for step in trace.steps], first=trace.initial)
    assert again.steps == trace.steps
    assert trace.initial["start"] == 4
    assert all(step.inputs["hand"] <= 7 for step in trace.steps)
    assert trace.steps[-1].state["mode"] == 2


def test_what_the_assumption_excludes_is_found_only_without_it() -> None:
    """The run breaks the assumption only if the goal does not rely on it."""
    alarm = _goal(SYSTEM, "alarm", MACHINE.mode.eq(ALARM))
    assert beside([alarm], [RECORDED]) == {}
    free = without_assumption(alarm)
    trace = beside([free], [RECORDED])[free]
    assert trace.steps[-1].inputs["hand"] == 9


def test_the_same_seed_gives_the_same_runs() -> None:
    """A repeated proof gets the same witnesses."""
    first, second = (beside([_goal(SYSTEM, "inside", MACHINE.mode.eq(INSIDE))], [RECORDED], 5) for _ in range(2))
    assert [one.steps for one in first.values()] == [one.steps for one in second.values()]


def test_nothing_begins_beside_nothing() -> None:
    """Without goals, without recordings, and with a recording that cannot begin there are no runs."""
    inside = _goal(SYSTEM, "inside", MACHINE.mode.eq(INSIDE))
    assert beside([], [RECORDED]) == {}
    assert beside([inside], []) == {}
    assert beside([inside], [replace(RECORDED, steps=[])]) == {}
    assert beside([inside], [replace(RECORDED, steps=[{"key": -1, "hand": 0}])]) == {}


def test_wrong_code_is_noticed(monkeypatch: pytest.MonkeyPatch) -> None:
    """A run that the interpreter does not confirm is an error, not a witness."""
    inside = _goal(SYSTEM, "inside", MACHINE.mode.eq(INSIDE))
    right = module.compiled_terms

    def wrong(reads: tuple[object, ...], terms: list[object]) -> object:
        return (lambda row: [False]) if len(terms) == 1 else right(reads, terms)  # type: ignore[arg-type]

    monkeypatch.setattr(module, "compiled_terms", wrong)
    with pytest.raises(EngineError, match="does not reach 'inside' in the interpreter"):
        beside([inside], [RECORDED])


def test_states_of_generated_code_are_compared() -> None:
    """A recorded state that the interpreter does not come to is an error."""
    course = module._Course([], [[1]], {}, iter(()), after=[{KEY: 0}])
    with pytest.raises(EngineError, match="come to different states in step 0"):
        course.until(0)
    ended = module._Course([], [[0], [1]], {}, iter(()), after=[{KEY: 0}])
    with pytest.raises(EngineError, match="come to different states in step 1"):
        ended.until(1)
