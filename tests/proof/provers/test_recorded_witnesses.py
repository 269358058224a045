"""Recorded runs as witnesses: they count up to the first step that breaks the assumption, and no further."""

from __future__ import annotations

import pytest

from safeloc.errors import EngineError
from safeloc.language.composition import compose
from safeloc.language.expr import number
from safeloc.language.machine import ANY, Machine, Transition, modes
from safeloc.language.spec import Goal, observe, reachable
from safeloc.language.system import TransitionSystem, lower
from safeloc.language.units import COUNT
from safeloc.language.verdict import Proved, word
from safeloc.language.world import World
from safeloc.proof.provers import recorded_witnesses
from safeloc.proof.provers.limits import Limits
from safeloc.proof.provers.obligations import obligations
from safeloc.proof.provers.portfolio import prove
from safeloc.proof.provers.reached import reached
from safeloc.proof.provers.recorded_witnesses import Recording, lasting, shown
from safeloc.proof.results import Finding

IDLE, FULL = modes("IDLE", "FULL")
X, N, START = number("x", COUNT, 0, 9), number("n", COUNT, 0, 100), number("start", COUNT, 0, 5)
DEEP = 40
COUNTER = Machine(
    "deep",
    (IDLE, FULL),
    [X],
    {N: 0},
    {},
    [
        Transition("full", IDLE, FULL, N >= DEEP, {N: 0}),
        Transition("count", IDLE, IDLE, X > 5, {N: N + 1}, rank=1),
        Transition("start anew", IDLE, IDLE, X <= 5, {N: 0}, rank=2),
        Transition("stay full", FULL, FULL),
    ],
    world=World(
        ghosts={START: ANY}, moves={START: START}, clauses={"assumption": X < 9}, reads_machine="the test asks it"
    ),
    initially=START > 2,
)


def system() -> TransitionSystem:
    """The machine, lowered."""
    return lower(COUNTER)


def full(made: TransitionSystem) -> Goal:
    """The goal of mode FULL, which is deeper than a short search reaches."""
    return observe(made, reachable("full", COUNTER.mode.eq(FULL)))


def recording(*values: int, start: int = 3) -> Recording:
    """A run with these inputs, and a remark."""
    return Recording({"start": start, "not a variable": 1}, [{"x": value, "truth_mm": 7} for value in values])


def test_the_shortest_recorded_run_counts() -> None:
    """Of two recordings the shorter one is the witness, cut off where the goal is reached."""
    long, short = recording(1, *[8] * 60), recording(*[7] * 50)
    [run] = shown([full(system())], [long, short]).values()
    assert DEEP + 1 == len(run.steps)
    assert run.steps[-1].fired == {"fired": "full"}


def test_generated_code_that_reaches_a_goal_too_soon_is_an_error(monkeypatch: pytest.MonkeyPatch) -> None:
    """The interpreter makes the step that reaches a goal."""
    right = recorded_witnesses.compiled_terms
    always_reached = lambda reads, terms: (lambda _: [False]) if len(terms) == 1 else right(reads, terms)  # noqa: E731
    monkeypatch.setattr(recorded_witnesses, "compiled_terms", always_reached)
    with pytest.raises(
        EngineError, match="the interpreter does not reach 'full' in the step in which generated code does"
    ):
        shown([full(system())], [recording(8)])


def test_what_breaks_the_assumption_ends_a_recording() -> None:
    """A step that breaks the assumption or is out of range does not count, nor does any later one."""
    for wrong in (9, 11):
        assert {} == shown([full(system())], [recording(wrong, *[8] * 60)])
        assert lasting(system(), [recording(*[8] * 10, wrong, *[8] * 60)], 11) is None


def test_a_first_state_that_cannot_be_is_no_recording() -> None:
    """If `initially` excludes the first state, the recording shows nothing and lasts for no step."""
    wrong = recording(*[8] * 60, start=1)
    assert {} == shown([full(system())], [wrong])
    assert lasting(system(), [wrong], 5) is None


def test_how_long_a_recording_lasts() -> None:
    """The result has as many steps as asked for, from the first recording that has them."""
    run = lasting(system(), [recording(1, 2), recording(*[8] * 60)], 20)
    assert run is not None
    assert 20 == len(run.steps)


def test_no_goals() -> None:
    """Without goals nothing is shown."""
    assert {} == shown([], [recording(8)])


@pytest.mark.thorough
def test_a_deep_mode_is_witnessed_by_a_recording() -> None:
    """A mode beyond a search of ten steps is reached with the recording, and undecided without it."""
    made, limits = system(), Limits(depth=10, seconds=10)
    with_it = _named(obligations(made, limits, recordings=[recording(*[8] * 60)]))
    assert isinstance(with_it["mode deep FULL"].result, Proved)
    assert "a recorded run under the assumption" == with_it["mode deep FULL"].method
    assert "a recorded run under the assumption" == with_it["transition deep: count"].method
    without_it = _named(obligations(made, limits))
    assert "a drawn run under the assumption" == without_it["transition deep: count"].method
    assert "unknown" == word(without_it["mode deep FULL"].result)


def _named(findings: list[Finding]) -> dict[str, Finding]:
    return {finding.id.split("/", 2)[2]: finding for finding in findings}


def test_a_reachable_property_beyond_the_search_is_shown_by_a_recording() -> None:
    """A short search does not come to it; a recording that breaks the assumption first does not count."""
    made, prop = system(), reachable("full", COUNTER.mode.eq(FULL))
    limits = Limits(depth=5, seconds=1)

    def verdict(*recordings: Recording) -> Finding:
        [found] = prove(made, [prop], limits, recordings=recordings)
        return found

    shown_ = verdict(recording(*[9] * 60), recording(*[7] * 50))
    assert isinstance(shown_.result, Proved)
    assert shown_.result.witness is not None
    assert (shown_.result.engine, len(shown_.result.witness.steps)) == ("recorded", DEEP + 1)
    assert shown_.method == "recorded, re-checked by interpreter"
    early = verdict(recording(*[7] * 3))
    assert not isinstance(early.result, Proved) or early.result.engine == "bmc"


def test_a_recorded_run_comes_first_in_a_composition() -> None:
    """There a short run takes long to search; of a single machine the short one is the witness, though a recording has it too."""
    alone, prop = system(), reachable("counts", N > 0)
    whole = compose("whole", [COUNTER], {})
    inside = reachable("counts", whole.of(COUNTER).bool(N > 0))
    named = Recording({"deep.start": 3}, [{"deep.x": 8}] * 4)
    limits = Limits(depth=5, seconds=2)
    of_one = reached(observe(alone, prop), limits, [recording(8, 8, 8)])
    of_all = reached(observe(whole.system, inside), limits, [named])
    assert isinstance(of_one, Proved)
    assert isinstance(of_all, Proved)
    assert ("bmc", "recorded") == (of_one.engine, of_all.engine)
    without = reached(observe(whole.system, inside), limits)
    assert isinstance(without, Proved)
    assert "bmc" == without.engine
