"""Dead ends: they are found wherever they are, and proved absent if there are none."""

from __future__ import annotations

import pytest

from safeloc.language.expr import FALSE, TRUE, Bool, boolean, minimum, number
from safeloc.language.machine import ANY, Machine, Transition, modes
from safeloc.language.spec import Property, always, observe, reachable
from safeloc.language.system import TransitionSystem, lower
from safeloc.language.units import COUNT
from safeloc.language.verdict import Proved, Unknown, Vacuous, Violated
from safeloc.language.world import World
from safeloc.proof.provers import assumption
from safeloc.proof.provers.assumption import Ended, assumption_kept, comes_round
from safeloc.proof.provers.dead_ends import lasts
from safeloc.proof.provers.kinduction import kinduction
from safeloc.proof.provers.limits import Limits
from safeloc.proof.provers.obligation import Obligation
from safeloc.proof.provers.portfolio import prove, prove_one
from safeloc.proof.provers.recheck import decide
from safeloc.proof.provers.recorded_witnesses import Recording
from safeloc.proof.provers.replayed_evidence import admissible_run
from safeloc.proof.provers.spacer import spacer
from tests.proof.provers.explicit_dead_ends import dead_end, random_system
from tests.proof.provers.seeded_dead_ends import SEEDS

(S,) = modes("S")
GO, X = boolean("i"), number("x", COUNT, 0, 20)
LIMITS = Limits(seconds=60)
RANDOM = 60


@pytest.mark.thorough(ordinary=7)
@pytest.mark.parametrize("name", SEEDS)
def test_a_seeded_dead_end_is_found(name: str) -> None:
    """The shortest run into it is found, and the interpreter finds no lawful inputs after it either."""
    seed = SEEDS[name]
    system = seed.make(False)
    assert seed.depth == dead_end(system)
    verdict = lasts(system, LIMITS)
    assert isinstance(verdict, Violated)
    assert verdict.trace is not None
    assert seed.depth == len(verdict.trace.steps)
    assert f"after these {seed.depth} steps no inputs satisfy the assumption" in verdict.reason
    admissible_run(system, verdict.trace.initial, [one.inputs for one in verdict.trace.steps])


@pytest.mark.thorough(ordinary=4)
@pytest.mark.parametrize("name", SEEDS)
def test_a_mended_machine_is_proved_to_last(name: str) -> None:
    """The proof comes with certificates that cvc5 confirms."""
    system = SEEDS[name].make(True)
    assert dead_end(system) is None
    verdict = lasts(system, LIMITS)
    assert isinstance(verdict, Proved)
    for file, text in verdict.certificates.items():
        expected = set[str]() if "; rule: witnesses\n" in text else {"unsat"}
        assert expected == set(decide(file, text, seconds=60))


@pytest.mark.thorough(ordinary=8)
@pytest.mark.parametrize("seed", range(RANDOM))
def test_random_machines_are_judged_as_by_enumeration(seed: int) -> None:
    """Proved if no reachable state is a dead end, violated by a shortest run otherwise."""
    system = random_system(seed)
    steps, verdict = dead_end(system), lasts(system, LIMITS)
    if steps is None:
        assert isinstance(verdict, Proved)
    else:
        assert isinstance(verdict, Violated)
        assert max(steps, 0) == (0 if verdict.trace is None else len(verdict.trace.steps))


def machine(assumption: Bool, *, first: object = 0, initially: Bool = TRUE) -> Machine:
    """Counts every step, up to 20; or jumps to where it likes if an input says so."""
    up = Transition("up", S, S, TRUE, {X: minimum(X + 1, 20)})
    return Machine(
        "m",
        (S,),
        [GO],
        {X: first},
        {},
        [up],
        world=World(clauses={"assumption": assumption}, reads_machine="the test asks it"),
        initially=initially,
    )  # type: ignore[dict-item]


@pytest.mark.parametrize(
    ("assumption", "initially", "why"),
    [
        (GO & ~GO, TRUE, "The clause 'm: assumption' excludes every run by itself, in the first step"),
        (X > 20, TRUE, "The clause 'm: assumption' excludes every run by itself, in the first step"),
        (
            TRUE,
            (X > 3) & (X < 3),
            "The first state and the ranges have no run, whatever the clauses (in the first step)",
        ),
    ],
    ids=["contradiction", "not at first", "no first state"],
)
def test_no_run_at_all_is_no_run(assumption: Bool, initially: Bool, why: str) -> None:
    """If no run begins, the violation comes without a run, and says why."""
    verdict = lasts(lower(machine(assumption, first=ANY, initially=initially)), LIMITS)
    assert isinstance(verdict, Violated)
    assert verdict.trace is None
    assert f"no run satisfies the assumption: every proof under it would be empty. {why}" == verdict.reason


def test_a_first_state_may_be_a_dead_end() -> None:
    """Other first states are none: the run to it has no steps."""
    verdict = lasts(lower(machine(X < 20, first=ANY)), LIMITS)
    assert isinstance(verdict, Violated)
    assert verdict.trace is not None
    assert 0 == len(verdict.trace.steps)
    assert "in this first state no inputs satisfy the assumption" in verdict.reason


def test_a_recorded_run_into_a_dead_end_is_found() -> None:
    """It is found even if no search reaches it in time."""
    far = number("far", COUNT, 0, 10_000)
    go = number("go", COUNT, 0, 1)
    rows = [Transition("up", S, S, TRUE, {far: minimum(far + go, 10_000)})]
    system = lower(
        Machine(
            "far",
            (S,),
            [go],
            {far: 0},
            {},
            rows,
            world=World(clauses={"assumption": far < 300}, reads_machine="the test asks it"),
        )
    )
    recording = Recording({}, [{"go": 1}] * 310)
    verdict = lasts(system, Limits(depth=5, seconds=60), [recording])
    assert isinstance(verdict, Violated)
    assert verdict.trace is not None
    assert 300 == len(verdict.trace.steps)
    assert "recorded" == verdict.engine


# ------------------------------------------------------------------ as an obligation


def kept(system: TransitionSystem) -> dict[str, Obligation]:
    """The obligations about the assumption, by name."""
    return {one.name: one for one in assumption_kept(system, LIMITS)}


def test_a_dead_end_that_can_be_avoided_does_not_end_the_assumption() -> None:
    """One run goes on for ever, another one reaches a dead end; both are shown."""
    only_zero = Machine(
        "m",
        (S,),
        [GO],
        {X: 0},
        {},
        [Transition("s", S, S, GO, {X: 1 + 0 * X})],
        world=World(clauses={"assumption": X.eq(0)}, reads_machine="the test asks it"),
    )
    found = kept(lower(only_zero))
    lasting, ending = found["assumption lasts"].verdict, found["dead ends"].verdict
    assert isinstance(lasting, Proved)
    assert lasting.witness is not None
    assert lasting.witness.steps[-1].state in [lasting.witness.initial, *(s.state for s in lasting.witness.steps[:-1])]
    assert isinstance(ending, Violated)
    assert ending.trace is not None
    assert [True] == [one.inputs["i"] for one in ending.trace.steps]


def test_an_assumption_that_ends_in_every_run_does_not_last() -> None:
    """The violation comes with the run, and so does the dead end."""
    found = kept(lower(machine(X < 7)))
    for name in ("assumption lasts", "dead ends"):
        verdict = found[name].verdict
        assert isinstance(verdict, Violated)
        assert verdict.trace is not None
        assert 7 == len(verdict.trace.steps)
    assert Ended(8) == comes_round(lower(machine(X < 7)), Limits(seconds=5))


def test_one_run_that_ends_is_no_evidence_that_all_do(monkeypatch: pytest.MonkeyPatch) -> None:
    """A ring of twenty-one states can be left for a dead end; it is longer than the search, so it is not excluded."""
    monkeypatch.setattr(assumption, "ROUND_STEPS", 6)
    rows = [
        Transition("leave", S, S, GO & X.eq(3), {X: 20 + 0 * X}),
        Transition("round", S, S, X.eq(19), {X: 0 * X}),
        Transition("up", S, S, X < 19, {X: X + 1}),
    ]
    system = lower(
        Machine(
            "ring",
            (S,),
            [GO],
            {X: 0},
            {},
            rows,
            world=World(clauses={"assumption": X < 20}, reads_machine="the test asks it"),
        )
    )
    found = kept(system)
    assert isinstance(found["dead ends"].verdict, Violated)
    lasting = found["assumption lasts"].verdict
    assert isinstance(lasting, Unknown)
    assert (
        "some run comes to a dead end; no lawful run of at most 6 steps comes back to an earlier state"
        == lasting.reason
    )
    monkeypatch.undo()
    assert isinstance(kept(system)["assumption lasts"].verdict, Proved)


def test_an_assumption_that_lasts_is_proved_to() -> None:
    """Certificates prove it, not a run."""
    found = kept(lower(machine(X <= 20)))
    for name in ("assumption lasts", "dead ends"):
        verdict = found[name].verdict
        assert isinstance(verdict, Proved)
        assert verdict.certificates


# ------------------------------------------------------------------ the further assumption of a property


def small(further: Bool) -> Property:
    """A property that holds only while its further assumption keeps x small."""
    return always("x is never 20", X < 20, further_assumption=further)


def test_a_further_assumption_that_dies_is_told_as_vacuous() -> None:
    """The verdict comes with the run into its end, however late that is."""
    for last in (7, 19):
        (found,) = prove(lower(machine(TRUE)), [small(X < last)], LIMITS)
        assert isinstance(found.result, Vacuous)
        assert found.result.trace is not None
        assert last == len(found.result.trace.steps)
        assert "the further assumption comes to an end" in found.result.reason


def test_a_further_assumption_that_lasts_is_part_of_the_proof() -> None:
    """The proof's certificates show that it can be satisfied for ever."""
    counting = Machine("m", (S,), [GO], {X: 0}, {}, [Transition("up", S, S, GO & (X < 20), {X: X + 1})])
    further = GO.implies(X < 19)
    (found,) = prove(lower(counting), [small(further)], LIMITS)
    assert isinstance(found.result, Proved)
    assert any("its-further-assumption" in file for file in found.result.certificates)


def test_a_further_assumption_that_nobody_can_judge_leaves_a_proof_open(monkeypatch: pytest.MonkeyPatch) -> None:
    """The verdict is Unknown: Proved would say more than is known."""
    monkeypatch.setattr("safeloc.proof.provers.dead_ends.lasts", lambda *_args, **_more: Unknown("no time", 3))
    verdict = prove_one(observe(lower(machine(TRUE)), small(X < 7)), LIMITS)
    assert isinstance(verdict, Unknown)
    assert "it is not known if the further assumption can be satisfied for ever: no time" in verdict.reason


@pytest.mark.parametrize("further", [GO & ~GO, FALSE], ids=["contradiction", "false"])
def test_engines_by_themselves_do_not_prove_from_a_contradiction(further: Bool) -> None:
    """They report that the proof would be empty."""
    goal = observe(lower(machine(TRUE)), always("x is 0", X <= 0, further_assumption=further))
    for engine in (kinduction, spacer, prove_one):
        verdict = engine(goal, LIMITS)
        assert isinstance(verdict, Vacuous), engine
        assert "no run satisfies the further assumption" in verdict.reason


def test_what_is_unreachable_under_a_contradiction_is_vacuous() -> None:
    """No run reaches the goal, since no run exists."""
    goal = observe(lower(machine(TRUE)), reachable("x is 9", X.eq(9), further_assumption=GO & ~GO))
    assert isinstance(prove_one(goal, LIMITS), Vacuous)
