"""The portfolio: it gives the right verdict whichever engine finds it, in order, in time, from several processes."""

from __future__ import annotations

import time
from dataclasses import replace

import pytest

from safeloc.errors import EngineError, PropertyError
from safeloc.language.expr import NumVar, number
from safeloc.language.machine import Machine, Transition
from safeloc.language.spec import Goal, always, reachable
from safeloc.language.system import TransitionSystem
from safeloc.language.units import COUNT
from safeloc.language.verdict import Proved, Unknown, Verdict, Violated, require_proved, word
from safeloc.proof.provers import portfolio as module
from safeloc.proof.provers.limits import Limits
from safeloc.proof.provers.portfolio import prove, prove_one
from safeloc.proof.results import Finding
from tests.examples import EXAMPLES, Example
from tests.proof.provers.small import (
    ASKED_FIRST,
    FULL_TOGETHER,
    HIGH,
    LEFT,
    LEVEL,
    LOW,
    MODE,
    ONLY,
    SAME,
    TICK,
    counter,
    goal,
    pair,
    system,
    told,
)
from tests.shipped import shipped

LIMITS = Limits(depth=12, seconds=20.0)
SAME_LEVEL = LEVEL.eq(LEVEL)


@pytest.mark.thorough(ordinary=2)
@pytest.mark.parametrize("example", EXAMPLES, ids=lambda example: example.name)
def test_every_example_is_decided(example: Example) -> None:
    """True properties are proved and false ones violated, in processes as in this one."""
    findings = prove(example.system, [example.holds, example.fails], LIMITS, jobs=2)
    results = [finding.result for finding in findings if finding.kind == "property"]
    assert [word(result) for result in results] == ["proved", "violated"]
    assert isinstance(results[1], Violated)
    assert results[1].trace is not None
    assert len(results[1].trace.steps) == example.fails_depth
    assert all(word(finding.result) == "proved" for finding in findings if finding.kind == "lemma")


def test_findings_are_in_order_and_told_as_they_come() -> None:
    """Lemmas come first, then properties as given; each is announced exactly once."""
    told: list[Finding] = []
    properties = [always(f"at most {most}", most >= LEVEL) for most in (10, 11, 12)]
    lowered = system(counter(lemmas={"high from 5": MODE.eq(HIGH).iff(LEVEL > 4)}))
    findings = prove(lowered, properties, LIMITS, jobs=2, on_finding=told.append)
    assert [finding.id for finding in findings] == [
        "counter/lemma/high from 5",
        "counter/property/at most 10",
        "counter/property/at most 11",
        "counter/property/at most 12",
    ]
    assert sorted(finding.id for finding in told) == sorted(finding.id for finding in findings)


def test_a_wrong_lemma_is_reported_with_a_run() -> None:
    """A false lemma is Violated, with the run that breaks it, and no property relies on it."""
    lowered = system(counter(lemmas={"wrong": LEVEL <= 6}))
    lemma, claim = prove(lowered, [always("claim", LEVEL <= 6)], LIMITS)
    assert isinstance(lemma.result, Violated)
    assert lemma.result.trace is not None
    assert len(lemma.result.trace.steps) == 7
    assert isinstance(claim.result, Violated)


def test_one_search_serves_all_dropped_lemmas() -> None:
    """Each wrong lemma gets its own shortest run; one that no run breaks is undecided, with the length that was searched."""
    lemmas = {"wrong at 7": LEFT <= 6, "too weak": FULL_TOGETHER, "wrong at 3": LEFT <= 2}
    late, weak, early = (one.result for one in prove(system(pair(lemmas)), [], LIMITS))
    assert [len(one.trace.steps) for one in (late, early) if isinstance(one, Violated) and one.trace] == [7, 3]
    assert isinstance(weak, Unknown)
    assert weak.depth == LIMITS.depth
    assert weak.reason.endswith(f"; no run of up to {LIMITS.depth} steps breaks it")


def test_a_lemma_that_is_true_but_not_inductive_is_reported() -> None:
    """No run breaks it and no proof is found: undecided, with the reason."""
    [lemma] = prove(system(pair({"too weak": FULL_TOGETHER})), [], LIMITS)
    assert isinstance(lemma.result, Unknown)
    assert lemma.result.reason.startswith("not used: does not follow, for example when")


def test_spacer_decides_what_induction_cannot() -> None:
    """The engines take turns: without its lemma the claim is left to Spacer."""
    verdict = prove_one(goal(pair(), FULL_TOGETHER), LIMITS)
    assert isinstance(verdict, Proved)
    assert verdict.engine == "spacer"


def test_a_broken_guard_is_shown_by_a_run() -> None:
    """The fault gives a run, not only a missing proof."""
    verdict = prove_one(goal(pair({"in step": SAME}, behind=True), SAME), LIMITS)
    assert isinstance(verdict, Violated)
    assert verdict.trace is not None
    assert verdict.trace.steps[-1].state == {"mode": 0, "left": 1, "right": 0}


def lock() -> Machine:
    """Opens by thirty numbers in a row, another one each time; any other number begins anew."""
    key, got = number("key", COUNT, 0, 999), number("got", COUNT, 0, 30)
    right = key.eq(got * 31 + 7)
    rows = [
        Transition("right", ONLY, ONLY, right & (got < 30), {got: got + 1}),
        Transition("wrong", ONLY, ONLY, ~right, {got: 0}, rank=1),
    ]
    return Machine("lock", (ONLY,), [key], {got: 0}, {"got": got}, rows)


def test_a_violation_that_spacer_claims_is_shown_beyond_the_depth_limit() -> None:
    """A run of thirty steps, that no random one finds, although searches end after twelve."""
    machine = lock()
    [got] = machine.state
    assert isinstance(got, NumVar)
    verdict = prove_one(goal(machine, got < 30), LIMITS)
    assert isinstance(verdict, Violated) and verdict.trace is not None
    assert ("bmc", 30) == (verdict.engine, len(verdict.trace.steps))
    undecided = prove_one(goal(machine, got < 30), replace(LIMITS, seconds=0.0001))
    assert isinstance(undecided, Unknown)


def test_reachable_is_proved_by_a_witness_and_refuted_by_induction() -> None:
    """A state that can be reached comes with a run; one that cannot is Violated without a trace, with the reason."""
    properties = [reachable("high", MODE.eq(HIGH)), reachable("low and full", MODE.eq(LOW) & LEVEL.eq(10))]
    high, never = (finding.result for finding in prove(system(counter()), properties, LIMITS))
    assert isinstance(high, Proved)
    assert high.witness is not None
    assert len(high.witness.steps) == 5
    assert isinstance(never, Violated)
    assert never.trace is None
    assert never.reason == "no run reaches it: proved by 1-induction"


def test_reachable_without_the_assumption() -> None:
    """A state that the assumption excludes is unreachable under it, and reached by an unconditional property."""
    properties = [
        reachable("under it", MODE.eq(HIGH)),
        reachable("without it", MODE.eq(HIGH), unconditional=True),
    ]
    results = [finding.result for finding in prove(system(counter(assumption=~TICK)), properties, LIMITS)]
    assert [word(result) for result in results] == ["violated", "proved"]


def test_too_little_time_is_unknown() -> None:
    """Within limits that are too small for anything, the verdict is Unknown: solvers get no less than a millisecond, which is enough for a toy."""
    counter_ = shipped("axle_counter")
    claims = [one for one in counter_.properties if one.name == "count is true"]
    [finding] = prove(counter_.system, claims, Limits(seconds=1e-8), lemmas=False)
    assert isinstance(finding.result, Unknown)


def test_properties_alone(monkeypatch: pytest.MonkeyPatch) -> None:
    """Without lemmas there are results of properties only, the same ones, and no run against a wrong lemma is searched for."""
    wrong, claims = system(counter(lemmas={"wrong": LEVEL <= 3})), [always("claim", LEVEL <= 10)]
    every = prove(wrong, claims, LIMITS)
    assert ["counter/lemma/wrong", "counter/property/claim"] == [one.id for one in every]
    monkeypatch.setattr(module, "bmc", lambda *_: pytest.fail("a run is searched for"))
    alone = prove(wrong, claims, LIMITS, lemmas=False)
    assert [(every[1].id, word(every[1].result))] == [(one.id, word(one.result)) for one in alone]


def test_a_hanging_engine_is_ended(monkeypatch: pytest.MonkeyPatch) -> None:
    """A solver that ignores its time limit leaves only its own property undecided."""

    def hangs(goal: Goal, limits: Limits) -> Verdict:
        del limits
        if goal.prop.name == "hard":
            time.sleep(600)
        return Unknown("easy")

    monkeypatch.setattr(module, "prove_one", hangs)
    monkeypatch.setattr(module, "GRACE_SECONDS", 0.2)
    hard, easy = prove(
        system(counter()), [always("hard", SAME_LEVEL), always("easy", SAME_LEVEL)], Limits(seconds=0.06)
    )
    assert isinstance(hard.result, Unknown)
    assert hard.result.reason == "ended by the clock after 2.6 s"
    assert isinstance(easy.result, Unknown)
    assert easy.result.reason == "easy"


def test_an_error_in_a_process_is_raised_here(monkeypatch: pytest.MonkeyPatch) -> None:
    """A prover that contradicts itself is an error, not a missing line in a report."""

    def contradicts(goal: Goal, limits: Limits) -> Verdict:
        raise EngineError(f"{goal.prop.name}: contradiction within {limits.seconds:g} s")

    monkeypatch.setattr(module, "prove_one", contradicts)
    with pytest.raises(EngineError, match="counter: claim: EngineError: claim: contradiction"):
        prove(system(counter()), [always("claim", SAME_LEVEL)], LIMITS)


def test_names_must_be_distinct() -> None:
    """Two properties of one name are refused; names that only look alike in a file's name are not."""
    with pytest.raises(PropertyError, match=r"rename one of them\.$"):
        prove(system(counter()), [always("same", LEVEL <= 10), always("same", LEVEL <= 10)], LIMITS)
    alike = prove(system(counter()), [always("a b", LEVEL <= 10), always("a-b", LEVEL <= 10)], LIMITS)
    files = [file for one in alike for file in require_proved(one.result).certificates if "-a-b-" in file]
    assert len(set(files)) == 4


def test_the_base_of_another_process_is_kept(monkeypatch: pytest.MonkeyPatch) -> None:
    """The base is proved once, in a process, and serves the next call without another one."""
    lowered: TransitionSystem = system(counter())
    first, _ = module.proved_base(lowered, LIMITS)
    monkeypatch.setattr(module.Queue, "add", lambda *_: pytest.fail("proved twice"))
    assert module.proved_base(lowered, LIMITS) == (first, 0.0)
    assert told(first.always) == {"range of mode", "range of level"}


def test_a_base_that_never_comes_proves_nothing(monkeypatch: pytest.MonkeyPatch) -> None:
    """If ranges and lemmas cannot be proved in time, none is assumed."""
    monkeypatch.setattr(module, "base", lambda *_, **__: time.sleep(600))
    monkeypatch.setattr(module, "GRACE_SECONDS", 0.1)
    known, _ = module.proved_base(system(counter()), Limits(seconds=0.1))
    assert not known.everything
    assert told(known.refuted) == {"range of mode", "range of level"}


def test_requirements_and_assumption_are_handed_on() -> None:
    """A finding has the property's requirements and assumption."""
    claim = always("claim", LEVEL <= 10, statement="never too full", requirements=("MRK-1",), assumption="none")
    [finding] = prove(system(counter()), [claim], LIMITS)
    assert (finding.statement, finding.requirements, finding.assumption) == ("never too full", ("MRK-1",), "none")
    assert finding.method == f"1-induction, re-checked by {ASKED_FIRST}"
