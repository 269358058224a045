"""Proved queries are looked up by their whole text; others are never cached."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import pytest

from safeloc.codegen.smtlib import Query, to_smtlib
from safeloc.language.expr import Bool, number
from safeloc.language.units import COUNT
from safeloc.proof.cache import answers
from safeloc.proof.cache import store as store_module
from safeloc.proof.cache.answers import confirmed_before, keep_confirmed, keep_proved, keeping, kept_in, proved_before
from safeloc.proof.cache.store import Store
from safeloc.proof.provers import implication, recheck
from safeloc.proof.provers.implication import Refuted, unproved
from safeloc.proof.provers.needed import only_needed
from safeloc.proof.provers.recheck import certify, confirmed_by
from tests.proof.provers.small import ASKED_FIRST

X = number("x", COUNT, 0, 100)


def query(given: Bool, goal: Bool) -> Query[str]:
    """One goal from one hypothesis."""
    return Query("q", [given], {"goal": goal})


TRUE_ONE, FALSE_ONE = query(X > 5, X > 4), query(X > 5, X > 6)


@pytest.fixture
def store(tmp_path: Path) -> Iterator[Store]:
    """A store that answers are kept in."""
    made = Store(tmp_path)
    with kept_in(made):
        yield made
    assert not keeping()


def test_a_proof_is_kept_and_a_refutation_is_not(store: Store) -> None:
    """Neither z3's nor the second solver's."""
    assert {} == unproved(TRUE_ONE, 10)
    assert isinstance(unproved(FALSE_ONE, 10)["goal"], Refuted)
    assert () == certify(TRUE_ONE, seconds=10).undecided
    assert proved_before(to_smtlib(TRUE_ONE)) and confirmed_before(to_smtlib(TRUE_ONE)) == (ASKED_FIRST,)
    assert not proved_before(to_smtlib(FALSE_ONE)) and not confirmed_before(to_smtlib(FALSE_ONE))
    assert 3 == len(list(store.entries()))  # with the hypotheses that the proof needs


def test_what_is_undecided_is_not_kept(store: Store) -> None:
    """No time, no proof."""
    assert {"goal"} == set(unproved(TRUE_ONE, 0))
    assert not proved_before(to_smtlib(TRUE_ONE))
    assert [] == list(store.entries())


@pytest.mark.usefixtures("store")
def test_what_is_kept_is_not_asked_again(monkeypatch: pytest.MonkeyPatch) -> None:
    """The certificate is the same, text and name."""
    first = certify(TRUE_ONE, seconds=10)
    unproved(TRUE_ONE, 10)

    def refuse(*_: object, **__: object) -> None:
        raise AssertionError("a solver was asked")

    monkeypatch.setattr(recheck, "recheck", refuse)
    monkeypatch.setattr(recheck.yices, "answers", refuse)
    monkeypatch.setattr(implication, "_failures", refuse)
    again = certify(TRUE_ONE, seconds=10)
    assert (first.file, first.text, first.undecided) == (again.file, again.text, again.undecided)
    assert confirmed_by({"": again.text}) == (ASKED_FIRST,)
    assert {} == unproved(TRUE_ONE, 10)
    with pytest.raises(AssertionError, match="a solver was asked"):
        unproved(query(X > 5, X > 3), 10)
    with pytest.raises(AssertionError, match="a solver was asked"):
        certify(query(X > 6, X > 4), seconds=10)


@pytest.mark.usefixtures("store")
def test_one_solver_does_not_speak_for_the_other() -> None:
    """A cached answer of z3 does not count as one of the second solver, nor the other way round."""
    keep_proved(to_smtlib(FALSE_ONE))
    assert not confirmed_before(to_smtlib(FALSE_ONE))
    keep_confirmed(to_smtlib(TRUE_ONE), ("yices 1.0",))
    assert not proved_before(to_smtlib(TRUE_ONE))


def test_an_entry_that_names_no_program_is_asked_again(store: Store) -> None:
    """Nobody is said to have confirmed what only counts as confirmed; what is asked again is kept with its name."""
    text = to_smtlib(only_needed(TRUE_ONE))
    store.put("answers", answers._key("second", text), b"proved")
    assert not confirmed_before(text)
    assert confirmed_by({"": certify(TRUE_ONE, seconds=10).text}) == (ASKED_FIRST,)
    assert confirmed_before(text) == (ASKED_FIRST,)


def test_nothing_is_kept_without_a_store() -> None:
    """As in a test, or a library call."""
    with kept_in(None):
        assert not keeping()
        assert {} == unproved(TRUE_ONE, 10)
        assert not proved_before(to_smtlib(TRUE_ONE))


@pytest.mark.usefixtures("store")
def test_the_head_of_a_certificate_is_not_part_of_the_question() -> None:
    """It names other certificates, which say nothing to a solver."""
    keep_confirmed(to_smtlib(TRUE_ONE, ["one.smt2"]), ("yices 1.0", "cvc5 1.0"))
    assert confirmed_before(to_smtlib(TRUE_ONE, ["other.smt2"])) == ("yices 1.0", "cvc5 1.0")


def test_nothing_is_kept_of_an_engine_that_was_edited_meanwhile(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Its digest would be that of another one."""
    monkeypatch.setattr(answers, "undisturbed", lambda: False)
    with kept_in(Store(tmp_path)):
        assert not keeping()
        unproved(TRUE_ONE, 10)
    assert [] == list(Store(tmp_path).entries())


def test_a_fresh_run_uses_no_answer_of_before(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """And answers of its own it does use: what is asked twice is decided once."""
    made, text = Store(tmp_path), to_smtlib(TRUE_ONE)
    monkeypatch.setattr(store_module, "utc_now", lambda: "2026-01-01T00:00:00Z")
    with kept_in(made):
        keep_proved(text)
    monkeypatch.setattr(store_module, "utc_now", lambda: "2026-01-01T00:00:01Z")
    monkeypatch.setattr(answers, "utc_now", lambda: "2026-01-01T00:00:01Z")
    with kept_in(made):
        assert proved_before(text)
    with kept_in(made, fresh=True):
        assert not proved_before(text)
        keep_proved(text)
        assert proved_before(text)
