"""Cases of properties: found, excluded or left open; a case that never occurs makes a proof vacuous."""

from __future__ import annotations

from collections.abc import Callable

import pytest

from safeloc.language.antecedents import cases, occurs_alone
from safeloc.language.composition import compose
from safeloc.language.expr import TRUE, Bool, Num, as_num, boolean, ite, minimum, number
from safeloc.language.machine import ANY, Machine, Transition, modes
from safeloc.language.spec import Property, always, earlier_num, never, reachable, within
from safeloc.language.system import TransitionSystem, lower
from safeloc.language.units import COUNT
from safeloc.language.verdict import Proved, Unknown, Vacuous, word
from safeloc.language.world import World
from safeloc.proof.provers.antecedents import RANDOM, SHIPPED, Never, Open, Seen, found, remember, search
from safeloc.proof.provers.limits import Limits
from safeloc.proof.provers.obligations import obligations
from safeloc.proof.provers.portfolio import prove
from safeloc.proof.provers.recorded_witnesses import Recording
from safeloc.proof.results import Finding
from safeloc.proof.testing import run_tests

A, B, C = modes("A", "B", "C")
X, N = number("x", COUNT, 0, 10), number("n", COUNT, 0, 1000)
MORE = minimum(N + 1, 1000)


def gate(assumption: Bool | None = None) -> Machine:
    """Goes between A and B, and never to C; counts its steps."""
    rows = [
        Transition("go", A, B, X > 5, {N: MORE}),
        Transition("back", B, A, X < 3, {N: MORE}),
        Transition("count", (A, B), A, TRUE, {N: MORE}, rank=1),
    ]
    return Machine(
        "gate",
        (A, B, C),
        [X],
        {N: 0},
        {},
        rows,
        world=World(clauses={} if assumption is None else {"asked": assumption}, reads_machine="the test asks it"),
    )


GATE = gate()
IN_A, IN_B, IN_C = (GATE.mode.eq(mode) for mode in (A, B, C))


def proved(prop: Property, system: TransitionSystem | None = None) -> Finding:
    """The verdict on one property."""
    (finding,) = prove(lower(GATE) if system is None else system, [prop], Limits(seconds=20))
    return finding


@pytest.mark.thorough(ordinary=2)
@pytest.mark.parametrize(
    ("prop", "words"),
    [
        (always("implies", IN_C.implies(N.eq(3))), "the case (mode = C)"),
        (within("within", 3, IN_C, N.eq(3)), "its trigger (mode = C)"),
        (always("part", IN_B.implies(N >= 1) & IN_C.implies(N.eq(3))), "the case (mode = C)"),
        (always("either", GATE.mode.ne(C) | N.eq(3)), "the case (mode = C)"),
        (always("contradiction", (IN_A & IN_B).implies(N.eq(3)), unconditional=True), "the case"),
        (always("trigger of the first state only", (IN_A & N.eq(0)).implies(X.eq(X))), "the case"),
    ],
    ids=lambda value: value.name if isinstance(value, Property) else "",
)
def test_what_never_occurs_is_vacuous(prop: Property, words: str) -> None:
    """A proof that requires nothing is Vacuous, and the case is named."""
    finding = proved(prop)
    assert isinstance(finding.result, Vacuous)
    assert finding.result.reason.startswith(words)
    assert "never occurs (proved by" in finding.result.reason


@pytest.mark.thorough(ordinary=3)
@pytest.mark.parametrize(
    "prop",
    [
        always("occurs", IN_B.implies(N >= 1)),
        always("first state", (IN_A & N.eq(0)).implies(GATE.mode.ne(B))),
        never("none", IN_C),
        always("choice", GATE.mode.one_of(A, B)),
        always("both ways", IN_C.iff(N < 0)),
        within("answered", 5, IN_B, IN_A),
        reachable("comes", IN_B),
    ],
    ids=lambda prop: prop.name,
)
def test_what_occurs_stays_proved(prop: Property) -> None:
    """A case that occurs leaves the proof as it is, and so does a property without cases."""
    assert "proved" == word(proved(prop).result)


def test_what_the_assumption_forbids_is_vacuous_under_it_only() -> None:
    """A case is searched under the assumption that the property relies on."""
    system = lower(gate(assumption=X <= 5))
    mode = system.machines[0].mode
    relies, free = (
        always(name, mode.eq(B).implies(N >= 1), unconditional=unconditional)
        for name, unconditional in (("relies", False), ("free", True))
    )
    assert ["vacuous", "proved"] == [word(one.result) for one in prove(system, [relies, free], Limits(seconds=20))]


def test_what_is_given_counts() -> None:
    """The further assumption of a property may exclude its own case."""
    given = always("given", IN_B.implies(N >= 1), further_assumption=X <= 5)
    assert ["vacuous", "proved"] == [
        word(one.result) for one in prove(lower(GATE), [given, always("not", IN_B.implies(N >= 1))], Limits(seconds=20))
    ]


def test_a_recording_shows_what_a_search_does_not() -> None:
    """A case 60 steps deep, farther than random runs go, is found in a recording; without one it is reported as neither found nor excluded."""
    prop = always("deep", N.eq(60).implies(GATE.mode.ne(C)))
    quick = Limits(depth=5, seconds=0.3)
    recording = Recording({}, [{"x": 4}] * 61)
    (open_,) = search(lower(GATE), cases(prop), quick)
    assert isinstance(open_, Open)
    (seen,) = search(lower(GATE), cases(prop), quick, [recording])
    assert Seen("in recordings") == seen
    (too_short,) = search(lower(GATE), cases(prop), quick, [Recording({}, [{"x": 4}] * 59)])
    assert isinstance(too_short, Open)


def test_a_shipped_witness_shows_a_case() -> None:
    """Its run is the evidence; a run that does not come so far shows nothing, nor does one of another system."""
    prop = always("deep", N.eq(60).implies(GATE.mode.ne(C)))
    quick, gate_ = Limits(depth=5, seconds=0.1), lower(GATE)
    far, near = Recording({}, [{"x": 4}] * 61), Recording({}, [{"x": 4}] * 59)
    (seen,) = search(gate_, cases(prop), quick, witnesses={"gate": [near, far]})
    assert isinstance(seen, Seen)
    assert SHIPPED == seen.where
    remember(gate_, [prop], quick, 0, [seen])
    (_, shown) = found(gate_, [prop]).obligation()
    assert shown.method == "a run of 60 steps, in a shipped witness"
    assert isinstance(shown.verdict, Proved)
    assert "witness" == shown.verdict.engine
    assert shown.verdict.witness is not None
    assert 60 == shown.verdict.witness.steps[-1].state["n"]
    for useless in ({"gate": [near]}, {"gates": [far]}, {"gate": [Recording({}, [{"y": 4}] * 61)]}):
        (open_,) = search(lower(GATE), cases(prop), quick, witnesses=useless)
        assert isinstance(open_, Open)


def test_a_random_run_shows_a_case() -> None:
    """A case that no bounded search of so few steps comes to is found in random runs, with the run."""
    prop = always("deep", N.eq(20).implies(GATE.mode.ne(C)))
    (seen,) = search(lower(GATE), cases(prop), Limits(depth=5, seconds=5))
    assert isinstance(seen, Seen)
    assert RANDOM == seen.where
    assert seen.run is not None
    assert len(seen.run.stream) >= 20
    gate_ = lower(GATE)
    remember(gate_, [prop], Limits(), 0, [seen])
    (_, shown) = found(gate_, [prop]).obligation()
    assert isinstance(shown.verdict, Proved)
    assert "drawn" == shown.verdict.engine
    assert shown.verdict.witness is not None
    assert 20 == shown.verdict.witness.steps[-1].state["n"]


def test_a_recording_counts_as_far_as_it_keeps_what_is_relied_on() -> None:
    """After a step that breaks the assumption only cases of unconditional properties count."""
    system = lower(gate(assumption=X <= 8))
    mode = system.machines[0].mode
    props = [
        always(str(free), mode.eq(B).implies(N >= 1) & N.eq(2).implies(N > 1), unconditional=free) for free in (0, 1)
    ]
    recording = Recording({}, [{"x": 9}, {"x": 4}])
    asked = [one for prop in props for one in cases(prop)]
    relies = search(system, asked[:2], Limits(depth=0, seconds=5), [recording])
    free = search(system, asked[2:], Limits(depth=0, seconds=5), [recording])
    assert Seen("in recordings") not in relies
    assert [Seen("in recordings")] * 2 == free


def obligation(findings: list[Finding]) -> Finding | None:
    """The obligation about cases, if there is one."""
    return next((one for one in findings if one.id == "gate/obligation/antecedents"), None)


@pytest.mark.thorough
def test_all_cases_are_one_obligation() -> None:
    """Proved if all occur, vacuous with those that never do, undecided with those neither found nor excluded."""
    good, bad = always("good", IN_B.implies(N >= 1)), always("bad", IN_C.implies(N >= 1))
    open_ = always("open", N.eq(500).implies(GATE.mode.ne(C)))
    for props, verdict, seconds in (([good], Proved, 10), ([good, bad], Vacuous, 10), ([good, bad, open_], Unknown, 1)):
        system = lower(GATE)
        finding = obligation(obligations(system, Limits(depth=4, seconds=seconds), properties=props))
        assert finding is not None
        assert isinstance(finding.result, verdict)
        assert finding.method.startswith(f"1 of {len(props)} cases occur")
    assert "'open': the case (n = 500 count) is neither found nor excluded" in repr(finding.result)
    assert obligation(obligations(lower(GATE), Limits(depth=2, seconds=10), properties=[never("none", IN_C)])) is None


def test_witnesses_are_handed_on() -> None:
    """The runs of a search are stored, for property tests to begin with."""
    system, prop = lower(GATE), always("occurs", IN_B.implies(N >= 1))
    assert [] == found(system, [prop]).runs()
    prove(system, [prop], Limits(seconds=20))
    (run,) = found(system, [prop]).runs()
    assert B.value == run.steps[-1].state["mode"]


def test_properties_of_one_name_are_told_apart() -> None:
    """Cases are stored by property, not by name."""
    system = lower(GATE)
    one, other = always("it", IN_B.implies(N >= 1)), always("it", IN_C.implies(N >= 1))
    outcomes = search(system, [*cases(one), *cases(other)], Limits(seconds=10))
    assert [Seen, Never] == [type(outcome) for outcome in outcomes]


def test_of_a_machine_by_itself() -> None:
    """The composition does not reach an inherited property's case in time; the machine alone does, and the finding says
    so.
    """
    first, second = _teller(), _hearer()
    whole = compose("both", [first, second], {HEARD: first.output("told")})
    own = always("own", second.mode.eq(HIGH).implies(second.mode.ne(LOW)), unconditional=True)
    prop = whole.inherited(second, own)
    (outcome,) = search(whole.system, cases(prop), Limits(depth=4, seconds=20))
    assert isinstance(outcome, Seen)
    assert "of hearer by itself, none of the whole" == outcome.where


def test_a_machine_by_itself_has_no_value_before_of_its_inputs() -> None:
    """What the one keeps is an input of the other, which by itself has no value of it before the step: the case is one of the whole."""
    first, second = _teller(), _hearer()
    whole = compose("both", [first, second], {HEARD: first.output("told")})
    earlier, high = earlier_num(whole.of(first).num(TELLS)), whole.of(second).bool(second.mode.eq(HIGH))
    assert occurs_alone(whole.system, always("steady", (high & (earlier < 50)).implies(earlier >= 49)), 0) is None


@pytest.mark.thorough(ordinary=2)
@pytest.mark.parametrize(
    ("claim", "told"),
    [
        (lambda low, heard: ite(low, heard >= 50, heard < 20), "proved"),
        (lambda low, heard: ite(low, heard >= 50, TURNS.eq(3)), "vacuous"),
        (lambda low, heard: low | (heard < 50), "proved"),
        (lambda low, heard: low | TURNS.eq(3), "vacuous"),
        (lambda low, heard: ite(low, heard >= 50, TURNS.eq(3)) & low.implies(heard >= 50), "vacuous"),
    ],
    ids=[
        "a plain claim of a choice",
        "an implication",
        "a plain claim of a disjunction",
        "none settled",
        "another case",
    ],
)
def test_what_a_wired_constant_decides_is_no_part(claim: Callable[[Bool, Num], Bool], told: str) -> None:
    """The listener is always LOW and its input 60: the property says only the rest about the composition."""
    first, second = _teller(), _never_high()
    whole = compose("both", [first, second], {HEARD: as_num(60, COUNT)})
    prop = whole.inherited(second, always("own", claim(second.mode.eq(LOW), HEARD)))
    assert told == word(proved(prop, whole.system).result)


(ON,), (LOW, HIGH) = (ON,), (LOW, HIGH) = modes("ON"), modes("LOW", "HIGH")
HEARD, TELLS, COUNTS = number("heard", COUNT, 0, 100), number("tells", COUNT, 0, 100), boolean("counts")


def _teller() -> Machine:
    rows = [Transition("count", ON, ON, COUNTS & (TELLS < 100), {TELLS: TELLS + 1})]
    return Machine("teller", (ON,), [COUNTS], {TELLS: 0}, {"told": TELLS}, rows)


def _hearer() -> Machine:
    return Machine("hearer", (LOW, HIGH), [HEARD], {}, {}, [Transition("much", LOW, HIGH, HEARD >= 50)])


TURNS = number("turns", COUNT, 0, 3)


def _never_high() -> Machine:
    """HIGH if `turns` is 1, while it alternates between 0 and 2: excluded by reachable states, not by one step."""
    turn = ite(TURNS >= 2, TURNS - 2, TURNS + 2)
    rows = [Transition("up", LOW, HIGH, TURNS.eq(1)), Transition("turn", LOW, LOW, TRUE, {TURNS: turn}, rank=1)]
    return Machine("hearer", (LOW, HIGH), [HEARD], {TURNS: 0}, {}, rows)


def test_a_few_steps_beside_a_recording() -> None:
    """A case too deep for the search, and not in the recording, is found a few steps from a state of the recording."""
    prop = always("beside", DEEP_CASE.implies(N > 39))
    recording = Recording({}, [{"x": 4}] * 45)
    (seen,) = search(lower(DEEP), cases(prop), Limits(depth=3, seconds=10), [recording])
    assert isinstance(seen, Seen)
    assert "a few steps beside a recording" == seen.where
    assert seen.run is not None
    assert 41 <= len(seen.run.stream) <= 44


LATE = boolean("late")
DEEP = Machine(
    "deep",
    (A, B, C),
    [X],
    {N: 0, LATE: False},
    {},
    [
        Transition("go", A, B, LATE & (X > 5), {N: MORE}),
        Transition("count", (A, B), A, TRUE, {N: MORE, LATE: N >= 40}, rank=1),
    ],
)
DEEP_CASE = DEEP.mode.eq(B) & (N >= 40)


def test_a_run_from_a_first_state_that_the_environment_excludes() -> None:
    """The case of an unconditional property is found from there; property tests follow the run for that property only."""
    (only,) = modes("ONLY")
    place, truth = number("place", COUNT, 0, 9), number("truth", COUNT, 0, 9)
    known_at_first = {"state": {place: ANY}, "world": World(ghosts={truth: 0}, moves={truth: truth})}
    rows = [Transition("still", only, only, X > 5)]
    made = Machine("still", (only,), [X], outputs={}, transitions=rows, initially=place.eq(truth), **known_at_first)
    system, prop = lower(made), always("free", place.eq(5).implies(place >= 1), unconditional=True)
    prove(system, [prop], Limits(seconds=20))
    (known,) = found(system, [prop]).runs()
    assert 5 == known.initial["place"]
    lawful = always("lawful", place.eq(0))
    findings = run_tests(system, [prop, lawful], examples=9, steps=3, seed=1, corpus=[known])
    assert ["held", "held"] == [word(finding.result) for finding in findings]
    (alone,) = run_tests(system, [prop], examples=9, steps=3, seed=1)
    assert "vacuous" == word(alone.result)
