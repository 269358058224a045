"""The fuzzer finds what it is there to find: engines, facts, obligations and back ends that lie are told of."""

from __future__ import annotations

from dataclasses import replace

import pytest

from safeloc.codegen import compiled
from safeloc.errors import PropertyError
from safeloc.language.expr import TRUE
from safeloc.language.interpret import run
from safeloc.language.spec import Goal
from safeloc.language.system import TransitionSystem
from safeloc.language.verdict import Proved, Result, Unknown, Vacuous, Violated
from safeloc.proof.provers.antecedents import Never, Open, Outcome, Seen
from safeloc.proof.provers.limits import Limits
from safeloc.proof.provers.obligation import Obligation
from safeloc.proof.provers.proved_base import Base
from tests.fuzz import backends, verdicts
from tests.fuzz.build import build
from tests.fuzz.case import Case
from tests.fuzz.explore import search
from tests.fuzz.judge import Claim
from tests.fuzz.obligations import _judged
from tests.fuzz.occurrence import of_cases
from tests.fuzz.tally import Expect, Tally
from tests.fuzz.terms import Term
from tests.fuzz.verdicts import claim
from tests.fuzz.world import Row, Var, Whole, World

X, GO = Var("x", "number", 0, 3), Var("go", "truth")
UP: Term = ("min", ("add", ("var", "x"), ("lit", 1)), ("lit", 3))
COUNTER = World("m", 1, (GO,), {X: 0}, rows=(Row("up", (0,), 0, ("var", "go"), {"x": UP}),))
HOLDS, BREAKS = (Claim("c", "always", ("le", ("var", "x"), ("lit", most))) for most in (3, 1))
NEVER = Claim("c", "always", ("implies", ("gt", ("var", "x"), ("lit", 3)), ("var", "go")))
SOUND = Expect()
COMES = Claim("c", "reachable", ("eq", ("var", "x"), ("lit", 3)))


def case(expect: Expect = SOUND) -> Case:
    """The case of a machine."""
    return Case(COUNTER, build(COUNTER), search(COUNTER), expect, Tally())


@pytest.mark.parametrize(
    ("one", "said"),
    [
        (BREAKS, Proved(None, "liar")),
        (HOLDS, Violated(None, "liar")),
        (BREAKS, Unknown("tired", 2)),
        (HOLDS, Vacuous("nothing said")),
        (COMES, Violated(None, "liar")),
        (COMES, Proved(None, "liar")),
    ],
)
def test_a_wrong_verdict_is_told(one: Claim, said: Result, monkeypatch: pytest.MonkeyPatch) -> None:
    """Whatever the lie: proved though broken, violated or vacuous though it holds, a depth that is too great, no run."""
    asked = case()
    monkeypatch.setitem(verdicts.ENGINES, "portfolio", lambda goal, limits: said)
    claim(asked, one, ["portfolio"])
    assert 1 == len(asked.tally.wrong)


def test_a_trace_that_is_not_the_shortest_is_told(monkeypatch: pytest.MonkeyPatch) -> None:
    """Bounded search has to give a shortest run, and a run of the very machine."""
    from safeloc.proof.provers.replayed_evidence import confirmed

    def slow(goal: Goal, _: Limits) -> Result:
        return Violated(confirmed(goal, {}, [{"go": False}, {"go": True}, {"go": True}], "slow"), "bmc")

    asked = case()
    monkeypatch.setitem(verdicts.ENGINES, "bmc", slow)
    claim(asked, BREAKS, ["bmc"])
    assert ["bmc: its trace has 3 steps, the shortest 2"] == [one.split(";")[0] for one in asked.tally.wrong]


def test_an_invariant_that_does_not_hold_is_told(monkeypatch: pytest.MonkeyPatch) -> None:
    """A proof of something true by something false is a disagreement."""
    asked = case()
    false = asked.built.names["x"] <= 1
    monkeypatch.setitem(verdicts.ENGINES, "k-induction", lambda goal, limits: Proved(false, "liar"))
    claim(asked, HOLDS, ["k-induction"])
    assert "invariant does not hold" in asked.tally.wrong[0]


def test_an_exception_is_told_and_a_refusal_is_judged(monkeypatch: pytest.MonkeyPatch) -> None:
    """An engine that breaks is a disagreement; so is the refusal of what is well-formed."""
    asked = case()

    def breaks(_goal: Goal, _limits: Limits) -> Result:
        raise KeyError("x")

    def refuses(_system: TransitionSystem, _prop: object) -> Goal:
        raise PropertyError("no")

    monkeypatch.setitem(verdicts.ENGINES, "Spacer", breaks)
    claim(asked, HOLDS, ["Spacer"])
    monkeypatch.setattr(verdicts, "observe", refuses)
    claim(asked, HOLDS, ["Spacer"])
    assert ["Spacer", "refusal"] == [one.split(":")[0] for one in asked.tally.wrong]


def test_a_fact_that_does_not_hold_is_told(monkeypatch: pytest.MonkeyPatch) -> None:
    """Of the base, in every state."""
    asked = case()
    lie = {"low": asked.built.names["x"] <= 1}
    monkeypatch.setattr(verdicts, "base", lambda system, seconds: Base(lie, lie, {}, {}, 1.0))
    verdicts.facts(asked)
    assert 2 == len(asked.tally.wrong)


def test_a_contract_that_is_not_kept_is_told(monkeypatch: pytest.MonkeyPatch) -> None:
    """Wired inputs out of range and a broken contract are both reported."""
    later = World("b", 1, (Var("q", "number", 0, 1),), {}, assumption=("le", ("var", "q"), ("lit", 0)))
    whole = Whole("w", (replace(COUNTER, name="a"), later), {"b.q": ("var", "a.x")}, discharge=("b",))
    asked = Case(whole, build(whole), search(whole), Expect(), Tally())
    kept = {"contract of b holds": TRUE}
    monkeypatch.setattr(verdicts, "base", lambda system, seconds: Base({}, {}, {}, {}, 1.0, kept, ["b"]))
    verdicts.facts(asked)
    assert ["heard", "contract"] == [one.split(":")[0] for one in asked.tally.wrong]


@pytest.mark.parametrize(
    ("name", "verdict"),
    [
        ("ranges", Proved(None, "liar")),
        ("overlap m", Proved(None, "liar")),
        ("absence", Proved(None, "liar")),
        ("mode m M1", Proved(None, "liar")),
        ("transition m: a", Violated(None, "liar")),
        ("assumption", Violated(None, "liar")),
        ("assumption lasts", Proved(None, "liar")),
        ("assumption lasts", Violated(None, "liar")),
        ("dead ends", Proved(None, "liar")),
        ("overflow", Violated(None, "liar")),
        ("division", Violated(None, "liar")),
    ],
)
def test_a_wrong_obligation_is_told(name: str, verdict: Result) -> None:
    """Of a machine that leaves its range, overlaps, reads what is absent, never comes to M1, and has a dead end."""
    o = Var("o", "number", 0, 1, optional=True)
    grows: Term = ("add", ("var", "x"), ("var", "o"))
    rows = (Row("a", (0,), 0, ("var", "go"), {"x": grows}), Row("b", (0,), 0, ("var", "go")))
    small = ("lt", ("var", "x"), ("lit", 9)) if name != "overflow" else ("true",)
    grows = grows if name != "overflow" else ("lit", 1)
    rows = (replace(rows[0], sets={"x": grows}), rows[1])
    world = World("m", 2, (GO, o), {X: 0}, rows=rows, assumption=small)
    asked = Case(world, build(world), search(world, 40), Expect(dead_ends=True), Tally())
    asked = (
        replace(asked, space=replace(asked.space, full=None)) if name in ("assumption lasts", "dead ends") else asked
    )
    one = Obligation(name, "", verdict, "")  # type: ignore[arg-type] # all of these are verdicts
    _judged(asked, one, [one])
    assert 1 == len(asked.tally.wrong)


@pytest.mark.parametrize("expected", [0, 1])
def test_vacuous_is_an_expectation_that_can_be_switched_on(expected: int) -> None:
    """Where nothing can come, Proved is wrong from the day on that Vacuous is told."""
    asked = case(expect=Expect(vacuous=bool(expected)))
    verdicts.judged(asked, NEVER, verdicts.truth(asked.space, NEVER), "prove", Proved(None, "any"))
    assert expected == len(asked.tally.wrong)


def test_a_back_end_that_differs_is_told(monkeypatch: pytest.MonkeyPatch) -> None:
    """One that computes otherwise, and one that breaks."""
    from random import Random

    from tests.fuzz.draw import Draw

    other = replace(COUNTER, rows=(replace(COUNTER.rows[0], sets={"x": ("lit", 2)}),))
    tally = Tally()
    monkeypatch.setattr(backends, "simulate", lambda *_, **__: 1 // 0)
    monkeypatch.setattr(backends, "compile_system", lambda system: compiled.compile_system(build(other).system))
    backends.all_back_ends(COUNTER, build(COUNTER), Draw(Random("x")), tally, compiled_c=False)
    assert {"numpy", "Python"} == {one.split(":")[0] for one in tally.wrong}


def test_a_pair_of_rows_is_judged_by_itself() -> None:
    """Two pairs meet in one table and one of them only in states that no run comes to: neither speaks for the other."""
    late = ("eq", ("var", "x"), ("lit", 2))
    rows = (Row("a", (0,), 0, ("var", "go")), Row("b", (0,), 0, ("var", "go")), Row("c", (0,), 0, late, rank=1), Row("d", (0,), 0, late, rank=1))  # fmt: skip
    world = World("m", 1, (GO,), {X: 0}, rows=rows)
    asked = Case(world, build(world), search(world), Expect(overlap_happens=True), Tally())
    told = {
        "overlap m: rows 1 and 2": (Violated(None, "right"), Proved(None, "liar")),
        "overlap m: rows 3 and 4": (Proved(None, "right"), Violated(None, "liar")),
    }
    for name, (right, wrong) in told.items():
        for verdict, count in ((right, 0), (wrong, 1)):
            asked.tally.wrong.clear()
            _judged(asked, Obligation(name, "", verdict, ""), [Obligation(each, "", right, "") for each in told])
            assert (name, count) == (name, len(asked.tally.wrong))


def test_a_run_that_does_not_come_round_is_told() -> None:
    """Where the assumption is said to last by a run, its last state has to be an earlier one."""
    asked = case()
    for stream, count in (([{"go": True}, {"go": False}], 0), ([{"go": True}, {"go": True}], 1)):
        asked.tally.wrong.clear()
        shown = Proved(None, "bmc", 2, witness=run(asked.built.system, stream))
        one = Obligation("assumption lasts", "", shown, "")
        _judged(asked, one, [one])
        assert count == len(asked.tally.wrong)


CALM = World("a", 1, (Var("i", "number", 0, 3),), {X: 0}, rows=(Row("follow", (0,), 0, sets={"x": ("var", "i")}),))
HEARS = Var("q", "number", 0, 9)
ALARM = World("b", 2, (HEARS,), rows=(Row("raise", (0,), 1, ("gt", ("var", "q"), ("lit", 2))),))
WIRED = Whole("w", (CALM, ALARM), {"b.q": ("var", "a.x")})
BY_ITSELF = "of the machine by itself, witness of {} steps under its assumption; {}"


@pytest.mark.parametrize(
    ("method", "count"),
    [
        (BY_ITSELF.format(1, "the whole was not searched in time"), 0),
        (BY_ITSELF.format(1, "none of the whole in 0 steps"), 0),
        (BY_ITSELF.format(1, "none of the whole in 1 steps"), 1),
        (BY_ITSELF.format(1, "none of the whole in -1 steps"), 1),
        (BY_ITSELF.format(2, "the whole was not searched in time"), 1),
        (BY_ITSELF.format(1, "proved impossible in the whole while the assumption is kept"), 1),
        ("found", 1),
    ],
)
def test_what_a_machine_does_by_itself_is_judged_as_it_is_told(method: str, count: int) -> None:
    """The machine's own run has to be as long as is told, and the whole not to come there as early as was searched."""
    asked = Case(WIRED, build(WIRED), search(WIRED), SOUND, Tally())
    own = run(asked.built.system.parts[1].alone, [{"q": 3}])
    one = Obligation("transition b: raise", "b: 'raise' fires, by itself", Proved(None, "bmc", 1, witness=own), method)
    _judged(asked, one, [one])
    assert count == len(asked.tally.wrong)
    asked.tally.wrong.clear()
    quiet = run(asked.built.system.parts[1].alone, [{"q": 1}])
    _judged(asked, replace(one, verdict=Proved(None, "bmc", 1, witness=quiet)), [one])
    assert 1 == len(asked.tally.wrong)
    of_the_whole = replace(one, statement="b: 'raise' fires", verdict=Proved(None, "bmc", 1))
    asked.tally.wrong.clear()
    _judged(asked, of_the_whole, [of_the_whole])
    assert ["obligation reachable: Proved, yet no run is shown"] == [one.split(";")[0] for one in asked.tally.wrong]


RARE = Claim("c", "always", ("or", ("le", ("var", "b.mode"), ("lit", 0)), ("ge", ("var", "a.x"), ("lit", 0))))
LOUD = replace(WIRED, wires={"b.q": ("min", ("var", "a.x"), ("lit", 1))})  # the alarm is never raised in the whole
ALONE = Seen("of b by itself, none of the whole")


@pytest.mark.parametrize(
    ("game", "outcomes", "wrong"),
    [
        (WIRED, [Seen("by search")], []),
        (WIRED, [Never("liar")], ["never, yet it occurs"]),
        (LOUD, [Never("right")], ["Proved, yet it says nothing"]),
        (LOUD, [Open("not found")], []),
        (LOUD, [Open("nobody looked")], ["nobody looked"]),
        (LOUD, [ALONE], []),
        (LOUD, [Seen("of a by itself, none of the whole")], ["its machine by itself does not come there"]),
        (LOUD, [Seen("by search")], ["it occurs, yet no run comes there", "Proved, yet it says nothing"]),
        (LOUD, [], ["0 cases are told of, where there are", "Proved, yet it says nothing"]),
    ],
)
def test_what_is_told_of_a_case_is_judged(game: Whole, outcomes: list[Outcome], wrong: list[str]) -> None:
    """That it occurs, never occurs, occurs in its machine by itself; a proof that says nothing has to be told of."""
    asked = Case(game, build(game), search(game), Expect(vacuous=True), Tally())
    of_cases(asked, RARE, outcomes)
    verdicts.judged(asked, RARE, verdicts.truth(asked.space, RARE), "prove", Proved(None, "any"), outcomes)
    assert len(wrong) == len(asked.tally.wrong)
    assert all(each in told for each, told in zip(wrong, asked.tally.wrong, strict=True))


def test_vacuous_is_wrong_where_a_claim_speaks_of_no_case() -> None:
    """Also where the assumption ends: that is told once, of the assumption, and not of each property."""
    ends = replace(COUNTER, assumption=("and", ("var", "go"), ("not", ("var", "go"))))
    asked = Case(ends, build(ends), search(ends), Expect(vacuous=True), Tally())
    for said, count in ((Proved(None, "right"), 0), (Vacuous("nothing said"), 1)):
        asked.tally.wrong.clear()
        verdicts.judged(asked, HOLDS, verdicts.truth(asked.space, HOLDS), "prove", said)
        assert count == len(asked.tally.wrong)
