"""Certificates hold only the hypotheses that a proof needs; a cached core is never trusted."""

from __future__ import annotations

from pathlib import Path

import pytest

from safeloc.codegen.smtlib import Query
from safeloc.language.expr import Bool, NumVar, number
from safeloc.language.nodes import product
from safeloc.language.render import infix
from safeloc.language.units import MM
from safeloc.proof.cache import answers
from safeloc.proof.cache.answers import keep_needed, kept_in, needed_before
from safeloc.proof.cache.store import Store
from safeloc.proof.provers import needed, recheck
from safeloc.proof.provers.implication import Refuted, core_of, text_of, unproved
from safeloc.proof.provers.needed import only_needed
from safeloc.proof.provers.recheck import certify

A, B, C = (number(name, MM, -1000, 1000) for name in "abc")
ORDERED = (A < B) & (B < C)


def query(*hypotheses: Bool, goal: Bool) -> Query[str]:
    return Query("small", list(hypotheses), {"goal": goal})


def test_what_no_proof_needs_goes_conjunct_by_conjunct() -> None:
    small = only_needed(query(ORDERED & (C < 7), A > 3, goal=B < C))
    assert [infix(part) for part in small.hypotheses] == [infix(B < C)]


def test_what_the_proof_needs_stays() -> None:
    small = only_needed(query(ORDERED & (C < 7), A > 3, goal=A < C))
    assert len(small.hypotheses) == 2
    assert unproved(small, 10.0) == {}
    assert all(unproved(query(*_without(small, one), goal=A < C), 10.0) for one in small.hypotheses)


def test_a_goal_that_does_not_follow_keeps_every_hypothesis() -> None:
    whole = query(ORDERED & (C < 7), A > 3, goal=B < A)
    assert len(only_needed(whole).hypotheses) == 4
    assert isinstance(unproved(only_needed(whole), 10.0)["goal"], Refuted)


def test_without_time_every_hypothesis_stays() -> None:
    assert len(only_needed(query(ORDERED & (C < 7), goal=A < C), seconds=0.0).hypotheses) == 3


def test_a_name_that_looks_like_a_switch_is_a_variable_of_its_own() -> None:
    like = NumVar("k!0", MM, -1000, 1000)
    small = only_needed(query(like < A, A < B, goal=like < B))
    assert len(small.hypotheses) == 2


def test_the_certificate_holds_no_more() -> None:
    text = certify(query(ORDERED & (C < 7), A > 3, goal=B < C), seconds=10.0).text
    assert text.count("(assert t") == 1
    assert "|a|" not in text


def test_a_fact_about_products_stays_where_it_speaks_of_nothing_else() -> None:
    monotone, other = ((A >= 0) & (A <= B)).implies(product(A, A) <= product(B, B)), product(A, C) > 5
    small = only_needed(query(monotone, other, A < B, C < 7, goal=A < B))
    assert [infix(part) for part in small.hypotheses] == [infix(monotone), infix(A < B)]


@pytest.mark.usefixtures("without_yices")
def test_where_that_does_not_do_cvc5_is_asked_from_every_hypothesis(monkeypatch: pytest.MonkeyPatch) -> None:
    def stuck(_: str, text: str, expected: int, **__: object) -> list[str]:
        return ["unsat" if "|c|" in text else "unknown"] * expected

    monkeypatch.setattr(recheck, "recheck", stuck)
    certificate = certify(query(A < B, C < 7, goal=A < B), seconds=10.0)
    assert certificate.undecided == ()
    assert "|c|" in certificate.text


def test_it_is_found_once(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    whole = query(ORDERED & (C < 7), A > 3, goal=A < C)
    with kept_in(Store(tmp_path)):
        first = only_needed(whole)
        monkeypatch.setattr(needed, "find_core", lambda *_: pytest.fail("asked again"))
        assert only_needed(whole).hypotheses == first.hypotheses
        again = query(ORDERED & (C < 7), A > 3, goal=A < C)
        assert core_of(again) is None
        assert only_needed(again).hypotheses == first.hypotheses


@pytest.mark.parametrize("proposed", [[], [3], [0, 2]])
def test_a_wrong_proposal_proves_nothing(tmp_path: Path, proposed: list[int]) -> None:
    whole = query(ORDERED & (C < 7), A > 3, goal=A < C)
    with kept_in(Store(tmp_path)):
        keep_needed(text_of(whole), proposed)
        small = only_needed(whole)
        assert len(small.hypotheses) == len(proposed)
        with pytest.raises(Exception, match=r"(yices|cvc5) does not confirm the proof"):
            certify(whole, seconds=10.0)


@pytest.mark.parametrize("data", [b"0 99", b"x", b"-1"])
def test_a_proposal_of_other_hypotheses_is_no_crash(tmp_path: Path, data: bytes) -> None:
    store, text = Store(tmp_path), text_of(query(ORDERED, goal=A < C))
    with kept_in(store):
        store.put(answers.NEEDED, answers._key("z3", text), data)
        assert needed_before(text, 2) in (None, [])


def _without(one: Query[str], left_out: Bool) -> list[Bool]:
    return [part for part in one.hypotheses if part is not left_out]


def test_a_proof_tells_what_it_needs() -> None:
    """The proof of the goals gives the core at no extra cost; a goal that does not follow has a countermodel and no
    core.
    """
    whole, wrong = query(ORDERED & (C < 7), A > 3, goal=A < C), query(ORDERED, goal=C < A)
    assert {} == unproved(whole, 10.0)
    assert 2 == len(core_of(whole) or ())
    assert isinstance(unproved(wrong, 10.0)["goal"], Refuted)
    assert core_of(wrong) is None
