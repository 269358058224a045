"""An undecided property: the state from which a good step leads to a bad one, and lemmas that exclude it."""

from __future__ import annotations

import json
import pickle

import pytest

from safeloc.explain.lemma_candidates import tried_lemmas
from safeloc.language.interpret import holds, step
from safeloc.language.render import infix
from safeloc.language.spec import observe
from safeloc.language.verdict import Unknown
from safeloc.proof.provers import portfolio
from safeloc.proof.provers.escape import escape
from safeloc.proof.provers.limits import Limits
from safeloc.proof.provers.portfolio import prove_one
from safeloc.proof.provers.verdicts_as_data import pack, unpack
from safeloc.proof.results import Finding
from safeloc.proof.verification.plain import pack_findings, unpack_findings
from tests.explain.pump import KEPT, LATE, OPEN, target


def test_a_good_state_is_followed_by_a_bad_one() -> None:
    """The run is one of the machine's own steps: the interpreter made it, from a state that keeps the property."""
    goal = observe(target().system, OPEN)
    found = escape(goal, Limits())
    assert found is not None
    assert found.good_steps == len(found.run.steps) == Limits().induction
    state = {var: found.run.initial[var.name] for var in goal.original.state}
    goods = [holds(goal.good, state)]
    for one in found.run.steps:
        state, _ = step(goal.original, state, {var: one.inputs[var.name] for var in goal.original.inputs})
        goods.append(holds(goal.good, state))
    assert goods == [True, True, True, False]
    assert found.row == "count"


def test_nothing_leads_out_of_what_is_inductive() -> None:
    """There is no counterexample to the induction of a property that is proved by it."""
    assert escape(observe(target().system, KEPT), Limits()) is None


def test_the_lemma_that_is_missing_is_found() -> None:
    """Both numbers count the same; one bound from the other is enough, and nothing else is named."""
    tried = tried_lemmas(observe(target().system, OPEN), Limits())
    assert tried.needed is not None
    assert [infix(one) for one in tried.needed] in (["counted ≤ strokes"], ["counted = strokes"], ["strokes = counted"])
    assert tried.held >= tried.inductive >= 1


def test_no_lemma_proves_what_does_not_hold() -> None:
    """The candidates are inductive, but the property is violated."""
    tried = tried_lemmas(observe(target().system, LATE), Limits(seconds=5))
    assert tried.needed is None
    assert tried.inductive > 0


def test_an_undecided_property_comes_with_it(monkeypatch: pytest.MonkeyPatch) -> None:
    """The verdict holds the run, also when another process sends it and when it is kept as plain data."""
    here = target()
    goal = observe(here.system, OPEN)
    monkeypatch.setattr(portfolio, "_ENGINES", portfolio._QUICK)  # Spacer would prove it
    verdict = prove_one(goal, Limits(depth=3))
    assert isinstance(verdict, Unknown) and verdict.escape is not None
    sent = unpack(pickle.loads(pickle.dumps(pack(verdict))), goal.plain, goal.system)
    finding = Finding("pump/property/open", here.name, "property", "", verdict, "", 0.0)
    plain = json.loads(json.dumps(pack_findings([finding], here.system)))
    [kept] = unpack_findings(plain, here.system)
    for arrived in (sent, kept.result):
        assert isinstance(arrived, Unknown) and arrived.escape is not None
        assert (arrived.reason, arrived.depth) == (verdict.reason, verdict.depth)
        assert arrived.escape.initial == verdict.escape.initial
        assert arrived.escape.steps == verdict.escape.steps
