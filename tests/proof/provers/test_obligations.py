"""Free obligations: every example machine satisfies all, and each is violated by a machine with one fault."""

from __future__ import annotations

import pytest

from safeloc.language.expr import TRUE, Bool, Num, all_of, boolean, number, optional, product
from safeloc.language.interpret import run
from safeloc.language.machine import ANY, Machine, Transition, modes
from safeloc.language.system import lower
from safeloc.language.units import COUNT
from safeloc.language.verdict import Proved, Unknown, Verdict, Violated, word
from safeloc.language.world import World
from safeloc.proof.provers import assumption
from safeloc.proof.provers import obligations as module
from safeloc.proof.provers.limits import Limits
from safeloc.proof.provers.obligations import CHECKS, obligations
from safeloc.proof.results import Finding
from tests.declaring import declared
from tests.examples import EXAMPLES, Example
from tests.proof.provers.small import ASKED_FIRST, LEVEL, TICK, counter, system

LIMITS = Limits(depth=15, seconds=10.0)
ONE, TWO = modes("ONE", "TWO")
GO = boolean("go")


def _found(machine: Machine, limits: Limits = LIMITS) -> dict[str, Finding]:
    return {finding.id.split("/", 2)[2]: finding for finding in obligations(lower(machine), limits)}


def _checked(check: str, machine: Machine) -> dict[str, Verdict]:
    """What one check alone finds, in this process."""
    return {one.name: one.verdict for one in CHECKS[check](lower(machine), LIMITS)}


@pytest.mark.thorough(ordinary=1)
@pytest.mark.parametrize("example", EXAMPLES, ids=lambda example: example.name)
def test_every_example_keeps_its_obligations(example: Example) -> None:
    """All obligations of all examples hold; each mode and each transition has a witness."""
    findings = obligations(example.system, LIMITS, jobs=2)
    assert [finding.id for finding in findings if word(finding.result) != "proved"] == []
    names = {finding.id.split("/", 2)[2] for finding in findings}
    for machine in example.machines:
        assert {f"mode {machine.name} {mode.label}" for mode in machine.modes} <= names
        assert {f"transition {machine.name}: {row.name}" for row in machine.transitions} <= names


@pytest.mark.thorough
@pytest.mark.parametrize("example", EXAMPLES, ids=lambda example: example.name)
def test_witnesses_are_streams_that_run(example: Example) -> None:
    """Every witness, run again, ends in the mode or transition that it shows."""
    for finding in obligations(example.system, LIMITS):
        assert isinstance(finding.result, Proved)
        kind, _, transition = finding.id.split("/", 2)[2].partition(": ")
        if kind.startswith("transition "):
            witness = finding.result.witness
            assert witness is not None
            again = run(example.system, witness.stream(), first=witness.initial)
            assert transition in again.steps[-1].fired.values()


def test_a_range_that_is_left_comes_with_a_run() -> None:
    """The variable is named, and the run that leaves its range is shown."""
    found = _found(counter(stride=2))
    assert found["ranges"].statement == "1 of 2 state variables stay in their declared ranges"
    violated = found["range of level"].result
    assert isinstance(violated, Violated)
    assert violated.trace is not None
    assert violated.trace.steps[-1].state["level"] == 11
    assert "" == violated.reason  # the run shows it; a state that one step came from would be that of another run


def test_a_ghost_may_leave_its_range_only_where_the_assumption_lets_it() -> None:
    """Ranges of ghosts are checked under the assumption, those of the machine's own variables without it."""
    truth, moved = number("truth", COUNT, 0, 5), number("moved", COUNT, -1, 1)
    parts = {"name": "walk", "modes": modes("ONLY"), "inputs": [GO], "state": {}, "outputs": {}, "transitions": []}
    world = {"ghosts": {truth: 0}, "choices": [moved], "moves": {truth: truth + moved}}
    kept = declared(**parts, **world, clauses={"in range": (truth + moved >= 0) & (truth + moved <= 5)})
    left = declared(**parts, **world, clauses={"not below": truth + moved >= 0})
    assert word(_checked("ranges", kept)["ranges"]) == "proved"
    assert word(_checked("ranges", left)["range of truth"]) == "violated"


def _growing(most: int) -> Machine:
    left, right = number("left", COUNT, 0, most), number("right", COUNT, 0, most)
    return Machine(
        name="area",
        modes=(ONE, TWO),
        inputs=[left],
        state={right: 1},
        outputs={},
        transitions=[
            Transition("large", ONE, TWO, (product(left, right) > most)),
            Transition("take", ONE, ONE, set={right: left}, rank=1),
        ],
    )


def test_overflow_is_shown_by_a_run() -> None:
    """A product that leaves 64 bits is Violated with inputs that make it; one that cannot is proved by intervals."""
    small, large = _found(_growing(10**9)), _found(_growing(10**10))
    assert word(small["overflow"].result) == "proved"
    assert "1 products of two variables" in small["division"].method
    [(name, finding)] = [(name, one) for name, one in large.items() if name.startswith("overflow ")]
    assert name == "overflow 1"
    assert "left" in finding.statement
    assert isinstance(finding.result, Violated)
    assert finding.result.trace is not None


def test_overflow_is_excluded_by_z3_where_intervals_are_too_coarse() -> None:
    """Two terms that cancel each other leave the bounds of intervals, not those of 64 bits."""
    big = number("big", COUNT, 0, 2**62)
    machine = Machine(
        name="cancel",
        modes=(ONE, TWO),
        inputs=[big],
        state={},
        outputs={},
        transitions=[Transition("never", ONE, TWO, (big - big) + (big - big) + (big - big) + 1 + 2**62 > 0)],
    )
    found = _found(machine)
    assert word(found["overflow"].result) == "proved"
    assert f"by z3, re-checked by {ASKED_FIRST}" in found["overflow"].method


def test_overlapping_guards_are_shown_with_values() -> None:
    """Two rows of one rank that are enabled together are Violated, with the run and the values."""
    found = _found(counter(rise=(2,)))
    violated = found["overlap counter: rows 2 and 3"].result
    assert isinstance(violated, Violated)
    assert violated.reason.startswith("both are enabled when mode = LOW, tick = true, level = 2")
    assert violated.trace is not None
    assert len(violated.trace.steps) == 3


def guarded() -> Machine:
    """Of three transitions one fires, one is a defence and one is dead."""
    return Machine(
        name="guarded",
        modes=(ONE, TWO),
        inputs=[LEVEL],
        state={},
        outputs={},
        transitions=[
            Transition("defence", ONE, TWO, LEVEL > 8),
            Transition("dead", TWO, ONE, (LEVEL > 5) & (LEVEL < 3), rank=1),
            Transition("stay", ONE, ONE, rank=1),
        ],
        world=World(clauses={"assumption": LEVEL <= 8}, reads_machine="the test asks it"),
    )


def test_a_dead_transition_is_violated_and_a_defence_is_not() -> None:
    """A transition that no input causes is dead; one that only a broken assumption causes is a defence, with its
    witness.
    """
    found = _found(guarded())
    defence, dead = found["transition guarded: defence"], found["transition guarded: dead"]
    assert isinstance(defence.result, Proved)
    how = "a defence: witness that breaks one law: 'assumption' in step 1"
    assert defence.method == f"{how}; proved impossible while the assumption is kept"
    assert isinstance(dead.result, Violated)
    assert dead.result.reason == "never occurs, whatever the inputs: dead; remove it or mend its guard"


def test_what_is_too_deep_is_unknown() -> None:
    """A mode beyond the depth limit is undecided, not dead."""
    ticks = number("ticks", COUNT, 0, 900)
    deep = Machine(
        name="deep",
        modes=(ONE, TWO),
        inputs=[LEVEL],
        state={ticks: 0},
        outputs={},
        transitions=[
            Transition("full", ONE, TWO, ticks > 800),
            Transition("count", ONE, ONE, ticks <= 800, {ticks: ticks + 1}),
        ],
    )
    verdict = _found(deep, Limits(depth=3, seconds=0.5))["mode deep TWO"].result
    assert isinstance(verdict, Unknown)
    assert verdict.depth == 3
    assert "Give a recording that goes there (`recordings`), or search longer runs with --depth" in verdict.reason


def test_an_assumption_that_cannot_be_kept_is_violated() -> None:
    """Proofs under it would be empty, and the finding says so."""
    verdict = _found(counter(assumption=TICK & (LEVEL < 3)))["assumption"].result
    assert isinstance(verdict, Violated)
    why = "no run satisfies the assumption: every proof under it would be empty. The clause"
    assert verdict.reason == f"{why} 'counter: assumption' excludes every run by itself, within 4 steps"


@pytest.mark.thorough
def test_the_assumption_can_be_kept_in_motion() -> None:
    """The witness moves every input that the assumption leaves free, and the others are named."""
    found = _found(counter())["assumption"]
    assert found.method == "one run in which all inputs and ghosts change"
    assert isinstance(found.result, Proved)
    assert found.result.witness is not None
    assert {step.inputs["tick"] for step in found.result.witness.steps} == {True, False}
    still = _found(counter(assumption=~TICK))["assumption"].result
    assert isinstance(still, Unknown)
    assert still.reason == "found only runs in which no input and no ghost ever changes"


def test_what_moves_in_a_known_run_is_not_asked_for(monkeypatch: pytest.MonkeyPatch) -> None:
    """The number of questions does not grow with the inputs; the only input that must stand still is still the only one
    named.
    """
    asked = list[object]()
    checked = assumption.ask
    monkeypatch.setattr(assumption, "ask", lambda *given: asked.append(given) or checked(*given))
    inputs = [boolean(f"input_{place}") for place in range(12)]

    def moves(law: Bool) -> str:
        asked.clear()
        machine = Machine(
            "mover",
            (ONE, TWO),
            inputs,
            {},
            {},
            [],
            world=World(clauses={"assumption": law}, reads_machine="the test asks it"),
        )
        return assumption._moves(lower(machine), LIMITS, ()).method

    assert moves(TRUE) == "one run in which all inputs and ghosts change"
    assert len(asked) == 2  # for any run, and for one in which all change
    assert moves(~inputs[5]) == "one run in which all inputs and ghosts change but input_5"
    exclusive = all_of(~(one & other) for one in inputs[:2] for other in inputs[2:4])
    assert moves(exclusive & ~inputs[0] & ~inputs[11]).endswith("change but input_0, input_11")


def test_reading_an_absent_input_is_violated() -> None:
    """A guard that reads the value without testing its presence is found, with the values that show it."""
    reading = optional("reading", COUNT, 0, 9)
    seen = number("seen", COUNT, 0, 9)

    def machine(guard: Bool) -> Machine:
        rows = [Transition("take", ONE, TWO, guard, {seen: reading.value})]
        return Machine("reader", (ONE, TWO), [reading], {seen: ANY}, {}, rows)

    assert word(_checked("absence", machine(reading.present & (reading.value > 3)))["absence"]) == "proved"
    violated = _checked("absence", machine(reading.value > 3))["absence"]
    assert isinstance(violated, Violated)
    assert (
        "read although absent: reading by mode in a run of 1 steps, the last with reading.present = False"
        in violated.reason
    )


def test_a_law_that_reads_an_absent_input_is_violated() -> None:
    """It would say of a silent sensor that it measures the stored number, 0; so do moves of ghosts."""
    reading, speed = optional("reading", COUNT, 0, 9), number("speed", COUNT, 0, 9)

    def machine(law: Bool, move: Num = speed) -> Machine:
        world = World({speed: ANY}, moves={speed: move}, clauses={"it measures": law})
        return Machine(
            "reader", (ONE, TWO), [reading], {}, {}, [Transition("take", ONE, TWO, reading.present)], world=world
        )

    measures = reading.value.eq(speed)
    assert word(_checked("absence", machine(reading.present.implies(measures)))["absence"]) == "proved"
    violated = _checked("absence", machine(measures))["absence"]
    assert isinstance(violated, Violated)
    assert "read although absent: reading by the law 'it measures' in a run of 1 steps" in violated.reason
    assert violated.reason.endswith("A law says nothing of a silent sensor: reading.present.implies(...)")
    moved = _checked("absence", machine(reading.present.implies(measures), reading.value))["absence"]
    assert isinstance(moved, Violated) and "reading by the move of speed" in moved.reason


def hangs(*_: object) -> object:
    """Never return."""
    while True:
        pass


@pytest.fixture
def impatient(monkeypatch: pytest.MonkeyPatch) -> None:
    """Let the clock end every check after two seconds."""
    monkeypatch.setattr(module, "SEARCHES", 0)
    monkeypatch.setattr(module, "GRACE_SECONDS", 2.0)


@pytest.mark.usefixtures("impatient")
def test_a_check_that_hangs_is_ended(monkeypatch: pytest.MonkeyPatch) -> None:
    """The clock ends one check; the finding says so and the others are there."""
    monkeypatch.setattr(module, "CHECKS", {**CHECKS, "absence": hangs})
    found = _found(counter())
    assert word(found["absence"].result) == "unknown"
    assert word(found["ranges"].result) == "proved"


@pytest.mark.usefixtures("impatient")
def test_known_runs_that_hang_are_ended(monkeypatch: pytest.MonkeyPatch) -> None:
    """Then modes and transitions are undecided together: nothing is searched, and nothing is told to hold."""
    monkeypatch.setattr(module, "in_known_runs", hangs)
    found = _found(counter())
    assert word(found["reachable"].result) == "unknown"
    assert word(found["ranges"].result) == "proved"
    assert not any(name.startswith(("mode ", "transition ")) for name in found)


@pytest.mark.usefixtures("impatient")
def test_a_search_that_hangs_leaves_what_known_runs_show(monkeypatch: pytest.MonkeyPatch) -> None:
    """Of the modes and transitions that no known run shows, one finding says that the search was ended."""
    whole = _found(guarded())
    monkeypatch.setattr(module, "beyond_known_runs", hangs)
    found = _found(guarded())
    assert [name for name in found if word(found[name].result) == "unknown"] == ["reachable"]
    searched = {"mode guarded TWO", "transition guarded: defence", "transition guarded: dead"}
    assert searched == {*whole} - {*found}


def test_modes_and_transitions_are_told_in_their_order() -> None:
    """Those that a search finds stand between those that known runs show."""
    names = [name for name in _found(guarded()) if name.startswith(("mode ", "transition "))]
    rows = [f"transition guarded: {name}" for name in ("defence", "dead", "stay")]
    assert ["mode guarded ONE", "mode guarded TWO", *rows] == names


def test_findings_are_told_as_they_come() -> None:
    """Each finding is announced once, however many processes there are."""
    told: list[Finding] = []
    findings = obligations(system(counter()), LIMITS, jobs=2, on_finding=told.append)
    assert sorted(finding.id for finding in told) == sorted(finding.id for finding in findings)
