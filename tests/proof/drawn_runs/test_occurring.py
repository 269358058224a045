"""Cases counted in driven runs: a case that never occurred was not tested, and a missing first state is reported."""

from __future__ import annotations

import pytest

from safeloc.language.composition import compose
from safeloc.language.expr import before, boolean, number
from safeloc.language.interpret import run
from safeloc.language.machine import ANY, Machine, Transition, modes
from safeloc.language.monitor import NEVER
from safeloc.language.spec import Property, always, once, previous, within
from safeloc.language.system import TransitionSystem, lower
from safeloc.language.trace import Trace
from safeloc.language.units import COUNT
from safeloc.language.verdict import Held, Result, Unknown, Vacuous
from safeloc.language.world import World
from safeloc.proof.drawn_runs.driver import Driver
from safeloc.proof.drawn_runs.lawful import NoFirstStateError
from safeloc.proof.testing import run_tests

(ON,) = modes("ON")
P, N = boolean("p"), number("n", COUNT, 0, 50)
ROWS = [Transition("count", ON, ON, P & (N < 50), {N: N + 1}), Transition("rest", ON, ON)]
COUNTER = Machine(
    "counter",
    (ON,),
    [P],
    {N: 0},
    {},
    ROWS,
    world=World(clauses={"assumption": ~P | (N < 5)}, reads_machine="the test asks it"),
)
SYSTEM = lower(COUNTER)


def outcome_of(prop: Property, corpus: list[Trace] | None = None, system: TransitionSystem = SYSTEM) -> Result:
    """The result of property tests for one property."""
    (finding,) = run_tests(system, [prop], examples=10, steps=10, seed=0, corpus=corpus or [])
    return finding.result


SECOND = [{"p": True}, {"p": True}, {"p": False}]


@pytest.mark.parametrize(
    ("prop", "expected"),
    [
        (always("state", N.eq(0).implies(N <= 9)), 1),
        (always("step", N.eq(0).implies(P | ~P)), 0),
        (always("after", N.eq(2).implies(N <= 9)), 2),
        (always("before", before(N).eq(2).implies(N <= 9)), 1),
        (always("input", P.implies(N >= 1)), 2),
        (always("fired", COUNTER.fired("rest").implies(~P)), 1),
        (always("past", previous(P).implies(N >= 1)), 2),
        (always("ever", once(N.eq(1)).implies(N >= 1)), 3),
        (within("trigger", 3, N.eq(2), ~P), 2),
    ],
    ids=lambda value: value.name if isinstance(value, Property) else str(value),
)
def test_how_often_a_case_occurred(prop: Property, expected: int) -> None:
    """State, values before, inputs, fired transitions, past operators: each counts in the steps in which it holds."""
    driver = Driver(SYSTEM, [prop])
    for number_, record in enumerate(SECOND):
        assert number_ == driver.statistics.steps
        driver._step((record["p"],))
    assert expected == driver.statistics.occurred[prop, 0]


def test_what_never_occurred_was_not_tested() -> None:
    """The verdict is vacuous, with the case and the number of steps; a known run that reaches the case makes it a test."""
    deep = always("deep", N.eq(30).implies(N > 29), unconditional=True)
    result = outcome_of(deep)
    assert isinstance(result, Vacuous)
    assert result.reason.startswith("the case (n = 30 count) never occurred in ")
    assert result.reason.endswith("steps: nothing was tested of it")
    assert isinstance(outcome_of(deep, [run(SYSTEM, [{"p": True}] * 30)]), Held)


def test_a_case_counts_only_while_the_property_is_required() -> None:
    """After a breach of the assumption, no case counts for a property that relies on it."""
    corpus = [run(SYSTEM, [{"p": True}] * 7)]
    result = outcome_of(always("relies", N.eq(7).implies(N > 6)), corpus)
    assert isinstance(result, Vacuous)
    assert isinstance(outcome_of(always("free", N.eq(7).implies(N > 6), unconditional=True), corpus), Held)


def test_a_name_that_a_user_takes_is_no_matter() -> None:
    """A property may have the name of a case's observer: nothing is mixed up."""
    props = [within("case 1", 3, P, ~P | P), always("case 2", previous(P).implies(N >= 1))]
    found = run_tests(SYSTEM, props, examples=10, steps=10, seed=0)
    assert [True, True] == [isinstance(one.result, Held) for one in found]


def test_what_a_machine_keeps_by_itself_is_noted() -> None:
    """For an inherited property, a case that the composition does not reach gives a note, not a verdict."""
    whole = compose("whole", [COUNTER], {})
    prop = whole.inherited(COUNTER, always("deep", N.eq(30).implies(N > 29), unconditional=True))
    (finding,) = run_tests(whole.system, [prop], examples=3, steps=5, seed=0)
    assert isinstance(finding.result, Held)
    assert "the case (counter.n = 30 count)" == finding.result.notes[NEVER]


A, B = number("a", COUNT, 0, 10**7), number("b", COUNT, 0, 10**7)
HARD = Machine(
    "hard", (ON,), [P], {A: ANY, B: ANY}, {}, [Transition("rest", ON, ON)], initially=(A < B) & (B < A), doc="no start"
)


def test_no_first_state_is_undecided() -> None:
    """Without a first state every property is undecided with that reason, and the tests go on."""
    props = [always("one", A <= B), within("two", 2, P, ~P)]
    found = run_tests(lower(HARD), props, examples=3, steps=5, seed=0)
    assert ["hard/test/one", "hard/test/two"] == [one.id for one in found]
    for one in found:
        assert isinstance(one.result, Unknown)
        assert "no first state found that satisfies `initially`" in one.result.reason
    with pytest.raises(NoFirstStateError, match="no first state found"):
        Driver(lower(HARD), props)


def test_a_known_run_has_a_first_state() -> None:
    """If no first state is found but a run is known, runs begin like the known one."""
    lucky = Machine(
        "lucky",
        (ON,),
        [P],
        {A: ANY, B: ANY},
        {},
        HARD.transitions,
        initially=(A * 3 + B * 7).eq(7_654_321) & (A > B * 2),
    )
    system = lower(lucky)
    trace = Trace(system, {"mode": 0, "a": 2_551_438, "b": 1}, ())
    assert 2_551_438 * 3 + 7 == 7_654_321
    driver = Driver(system, [always("one", A > B)], [trace])
    driver.reset()
    assert driver.state()[A] > driver.state()[B]
