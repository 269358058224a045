"""If a solver does not answer, the verdict is Unknown with the reason: never proved, never violated."""

from __future__ import annotations

import multiprocessing
from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import pytest
import z3

from safeloc.codegen.smtlib import Query
from safeloc.errors import EngineError
from safeloc.language.expr import number, optional
from safeloc.language.machine import Machine, Transition, modes
from safeloc.language.nodes import FloorDiv, Truth
from safeloc.language.spec import observe, reachable
from safeloc.language.system import lower
from safeloc.language.units import COUNT
from safeloc.language.verdict import Unknown, Verdict, Violated
from safeloc.proof.provers import absence, arithmetic, never, overlap, settle
from safeloc.proof.provers import kinduction as kinduction_module
from safeloc.proof.provers import spacer as spacer_module
from safeloc.proof.provers.assumption import assumption_kept
from safeloc.proof.provers.bmc import bmc
from safeloc.proof.provers.implication import Undecided, unproved
from safeloc.proof.provers.kinduction import kinduction
from safeloc.proof.provers.limits import Limits
from safeloc.proof.provers.obligation import Obligation
from safeloc.proof.provers.portfolio import prove
from safeloc.proof.provers.replayed_evidence import admissible_run, replayed
from safeloc.proof.provers.searches import first_runs
from safeloc.proof.provers.spacer import spacer
from safeloc.proof.provers.verdicts_as_data import unpack
from safeloc.proof.provers.workers import in_processes
from safeloc.proof.provers.z3_to_terms import UnreadableError, read_bool
from tests.proof.provers.small import FULL_TOGETHER, LEVEL, TICK, counter, goal, pair, system


@pytest.fixture
def tired(monkeypatch: pytest.MonkeyPatch) -> None:
    """A solver that gives up on every question."""
    monkeypatch.setattr(z3.Solver, "check", lambda *_: z3.unknown)
    monkeypatch.setattr(z3.Solver, "reason_unknown", lambda _: "canceled")


def no_time(query: Query, *_: object) -> Mapping[str, Undecided]:
    """The result of `unproved` for every goal when the time is up."""
    return {name: Undecided("solver: limit reached") for name in query.goals}


def said(verdict: Verdict) -> tuple[str, int]:
    """Reason and depth of a verdict that has to be Unknown."""
    assert isinstance(verdict, Unknown)
    return verdict.reason, verdict.depth


def only(found: Any) -> Obligation:
    """The only obligation."""
    (one,) = found
    assert isinstance(one, Obligation)
    return one


@pytest.mark.usefixtures("tired")
def test_bounded_search_says_why_it_ended() -> None:
    """The verdict gives the depth that was searched completely."""
    verdict = bmc(goal(counter(), LEVEL <= 10), Limits())
    assert said(verdict) == ("solver: limit reached", -1)


@pytest.mark.usefixtures("tired")
def test_an_implication_without_an_answer_is_undecided() -> None:
    """It is neither shown nor refuted."""
    assert unproved(Query("q", [LEVEL > 1], {"above 0": LEVEL > 0}), 1.0) == {
        "above 0": Undecided("solver: limit reached")
    }


@pytest.mark.usefixtures("tired")
def test_an_assumption_without_an_answer_is_undecided() -> None:
    """It is not called empty, nor a dead end."""
    moves, lasting, ends = assumption_kept(system(counter()), Limits(seconds=0.02))
    assert said(moves.verdict)[0] == "solver: limit reached"
    for one in (lasting, ends):
        assert isinstance(one.verdict, Unknown)
        assert "the first step: solver: limit reached" in one.verdict.reason


def test_an_undecided_induction_step_is_no_refutation(monkeypatch: pytest.MonkeyPatch) -> None:
    """The depth is the one for which the start was proved."""
    answers = iter([{}, {"claim": Undecided("solver: limit reached")}])
    monkeypatch.setattr(kinduction_module, "unproved", lambda *_: next(answers))
    verdict = kinduction(goal(counter(), LEVEL <= 9), Limits())
    assert said(verdict) == ("k = 1: undecided: solver: limit reached", 0)


def test_a_range_that_no_run_leaves_and_no_induction_shows(monkeypatch: pytest.MonkeyPatch) -> None:
    """Two counters only start together: without that fact as a lemma the range is undecided, not violated."""
    (on,) = modes("ON")
    a, b = number("a", COUNT, 0, 10), number("b", COUNT, 0, 10)
    machine = Machine(
        "twins", (on,), [TICK], {a: 0, b: 0}, {},
        [
            Transition("wrap", on, on, TICK & (b >= 10), {a: 0, b: 0}, rank=0),
            Transition("count", on, on, TICK & (b < 10), {a: a + 1, b: b + 1}, rank=1),
        ],
    )  # fmt: skip
    monkeypatch.setattr(never, "spacer", lambda *_: Unknown("gives up"))
    _, open_, *_ = arithmetic.ranges(lower(machine), Limits(depth=3))
    assert isinstance(open_.verdict, Unknown)
    assert "no run was found that reaches it; a lemma may be missing" in open_.verdict.reason
    assert open_.verdict.depth == 3


def test_a_divisor_that_is_not_positive_is_told() -> None:
    """Terms do not allow it, but a system that is built by hand could hold one: it is a violation."""
    own = system(counter())
    broken = replace(own, next={**own.next, LEVEL: FloorDiv(LEVEL, 0, COUNT)})
    verdict = only(arithmetic.division(broken, Limits())).verdict
    assert isinstance(verdict, Violated)
    assert verdict.reason == "divisors [0]"


def test_an_overlap_without_an_answer_is_undecided(monkeypatch: pytest.MonkeyPatch) -> None:
    """It is not called an overlap."""
    monkeypatch.setattr(settle, "unproved", no_time)
    monkeypatch.setattr(overlap, "never", lambda _, why, __: Unknown(why))
    verdicts = [one.verdict for one in overlap.overlap(system(counter()), Limits())]
    assert verdicts
    assert all(isinstance(verdict, Unknown) and "solver: limit reached" in verdict.reason for verdict in verdicts)


def test_an_absence_without_an_answer_is_undecided(monkeypatch: pytest.MonkeyPatch) -> None:
    """Each undecided question is named."""
    (on,) = modes("ON")
    distance, way = optional("distance", COUNT, 0, 9), number("way", COUNT, 0, 9)
    go = Transition("go", on, on, distance.value > 3, {way: distance.value})
    machine = Machine("walker", (on,), [distance], {way: 0}, {}, [go])
    monkeypatch.setattr(settle, "unproved", no_time)
    monkeypatch.setattr(absence, "unproved", no_time)
    verdict = only(absence.absence(lower(machine), Limits())).verdict
    assert isinstance(verdict, Unknown)
    assert "distance by way: undecided: solver: limit reached" in verdict.reason


def test_what_cannot_be_reached_nor_excluded_is_undecided() -> None:
    """Within these limits there is neither a run nor a proof."""
    (finding,) = prove(lower(pair()), [reachable("apart", ~FULL_TOGETHER)], Limits(depth=3, seconds=2, induction=1))
    reason, depth = said(finding.result)
    assert reason.startswith("not reached, and not shown to be unreachable: ")
    assert depth > 3  # the time that is left goes into longer runs


def test_a_search_for_nothing_is_over() -> None:
    """A search without goals is complete; one without time has searched no depth."""
    assert first_runs([], Limits(depth=7)).depth == 7
    high = observe(system(counter()), reachable("ten", LEVEL.eq(10)))
    runs = first_runs([high], Limits(seconds=1e-9))
    assert (dict(runs.found), runs.depth) == ({}, -1)


# ------------------------------------------------------------------ Spacer


def test_spacer_fails(monkeypatch: pytest.MonkeyPatch) -> None:
    """An exception of the solver becomes the reason."""

    def fails(*_: object) -> None:
        raise z3.Z3Exception("out of memory")

    monkeypatch.setattr(z3.Fixedpoint, "query", fails)
    assert said(spacer(goal(pair(), FULL_TOGETHER), Limits())) == ("spacer: out of memory", -1)


@pytest.mark.parametrize(("reason", "read"), [(b"canceled", "time limit"), ("", "undecided"), ("odd", "odd")])
def test_spacer_gives_up(monkeypatch: pytest.MonkeyPatch, reason: str | bytes, read: str) -> None:
    """The reason is in words that a person can read."""
    monkeypatch.setattr(z3.Fixedpoint, "query", lambda *_: z3.unknown)
    monkeypatch.setattr(z3.Fixedpoint, "reason_unknown", lambda _: reason)
    assert said(spacer(goal(pair(), FULL_TOGETHER), Limits())) == (f"spacer: {read}", -1)


def test_an_invariant_that_cannot_be_read_proves_nothing(monkeypatch: pytest.MonkeyPatch) -> None:
    """It could not be re-checked, so the verdict is Unknown."""

    def strange(*_: object) -> None:
        raise UnreadableError("a quantifier")

    monkeypatch.setattr(spacer_module, "read_bool", strange)
    verdict = spacer(goal(pair(), FULL_TOGETHER), Limits())
    assert said(verdict) == ("spacer: its invariant cannot be read back: a quantifier", -1)


def test_an_answer_of_another_shape_is_an_error(monkeypatch: pytest.MonkeyPatch) -> None:
    """A new version of z3 must not be misread."""
    monkeypatch.setattr(z3.Fixedpoint, "get_answer", lambda _: z3.BoolVal(True))
    with pytest.raises(EngineError, match=r"^spacer: its answer is no quantified equation: true$"):
        spacer(goal(pair(), FULL_TOGETHER), Limits())


def test_true_is_read_as_true() -> None:
    """The invariant `true` is translated back."""
    read = read_bool(z3.BoolVal(True), {})
    assert isinstance(read, Truth)
    assert read.value


# ------------------------------------------------------------------ evidence and processes


def test_a_first_state_that_violates_is_a_run_of_no_step() -> None:
    """It is replayed like every other run."""
    trace = replayed(goal(counter(), LEVEL > 0), {}, [{"tick": True}])
    assert trace is not None
    assert trace.steps == ()


def test_a_found_run_outside_the_ranges_is_an_error() -> None:
    """Solver and interpreter must agree on the ranges of inputs."""
    with pytest.raises(EngineError, match=r"^a run of counter that a solver found is not admissible: "):
        admissible_run(system(counter()), {}, [{"tick": 7}])


def test_a_found_run_that_breaks_the_assumption_is_an_error() -> None:
    """Such a run would show nothing."""
    lawful = lower(counter(assumption=~TICK))
    with pytest.raises(EngineError, match=r"^a run of counter that a solver found breaks the assumption in step 2\.$"):
        admissible_run(lawful, {}, [{"tick": False}, {"tick": True}])


def test_a_result_of_another_shape_is_a_defect() -> None:
    """It is not taken for a verdict."""
    own = system(counter())
    with pytest.raises(AssertionError, match="perhaps"):
        unpack(("perhaps",), own, own)  # type: ignore[arg-type]


def test_a_system_that_cannot_fork_says_so(monkeypatch: pytest.MonkeyPatch) -> None:
    """Terms are too deep to be sent to another process, so an error says that forking is needed."""
    monkeypatch.setattr(multiprocessing, "get_all_start_methods", lambda: ["spawn"])
    with pytest.raises(EngineError, match=r"^proving needs an operating system that can fork processes"):
        list(in_processes([], 1))
