"""Ranges and lemmas are proved before they are used; an unproved one is named and never assumed."""

import weakref
from dataclasses import replace

import pytest

from safeloc.proof.provers import proved_base as module
from safeloc.proof.provers.facts import Fact
from safeloc.proof.provers.implication import Refuted, Undecided
from safeloc.proof.provers.proved_base import base, proved_always
from safeloc.proof.provers.recheck import Certificate, certify
from tests.examples import EXAMPLES
from tests.proof.provers.small import HIGH, LEVEL, LOW, MODE, TICK, counter, system, told

TRUE_LEMMA = MODE.eq(HIGH).iff(LEVEL > 4)


def test_ranges_and_lemmas_are_proved_together() -> None:
    """A lemma that needs no assumption is proved for all inputs, together with the ranges."""
    known = base(system(counter(lemmas={"high from 5": TRUE_LEMMA})))
    assert told(known.always) == {"range of mode", "range of level", "high from 5"}
    assert not known.refuted
    assert [text.count("(check-sat)") for text in known.certificates.values()] == [3, 3]
    assert all("(check-sat)" in text for text in known.certificates.values())


def test_a_wrong_lemma_is_dropped_and_named() -> None:
    """A lemma that some step breaks is refuted with an example; the rest is still proved."""
    known = base(system(counter(lemmas={"wrong": LEVEL <= 9, "high from 5": TRUE_LEMMA})))
    assert isinstance(known.refuted[Fact("lemma", "wrong")], Refuted)
    assert "wrong" not in told([*known.always, *known.facts])
    assert "high from 5" in told(known.always)


def test_a_lemma_that_rests_on_a_wrong_one_falls_with_it() -> None:
    """A lemma whose proof used a dropped one is dropped too."""
    lemmas = {"wrong": LEVEL <= 9, "rests on it": MODE.eq(LOW) | (LEVEL <= 9)}
    known = base(system(counter(lemmas=lemmas)))
    assert told(known.refuted) == {"wrong", "rests on it"}


def test_a_range_that_is_left_is_refuted() -> None:
    """The range of a counter that runs past it is not proved."""
    known = base(system(counter(stride=2)))
    assert told(known.refuted) == {"range of level"}


def test_a_lemma_under_the_assumption_is_kept_apart() -> None:
    """A lemma that holds only under the assumption is no fact for all inputs."""
    known = base(system(counter(lemmas={"never counts": LEVEL.eq(0)}, assumption=~TICK)))
    assert told(known.facts) == {"never counts"}
    assert "never counts" not in told(known.always)


def test_too_little_time_is_no_refutation_and_is_tried_again() -> None:
    """Without time nothing is proved; with time the base of the same system is."""
    lowered = system(counter())
    hurried = base(lowered, seconds=1e-6)
    assert all(isinstance(why, Undecided) for why in hurried.refuted.values())
    assert not hurried.everything
    assert told(base(lowered).always) == {"range of mode", "range of level"}


def test_the_base_is_proved_once_per_system(monkeypatch: pytest.MonkeyPatch) -> None:
    """A second request is answered from memory."""
    lowered = system(counter())
    first = base(lowered)
    monkeypatch.setattr(module, "_prove", lambda *_: pytest.fail("proved twice"))
    assert base(lowered) is first
    assert base(lowered, seconds=1000.0) is first


def test_what_cvc5_cannot_confirm_is_not_used(monkeypatch: pytest.MonkeyPatch) -> None:
    """A fact needs cvc5's confirmation besides z3's proof."""

    def doubtful(query: object, **options: object) -> Certificate:
        honest = certify(query, **options)  # type: ignore[arg-type] # handed on as it came
        goals = query.goals  # type: ignore[attr-defined] # a Query
        return replace(honest, undecided=tuple(name for name in goals if str(name) == "range of level"))

    monkeypatch.setattr(module, "certify", doubtful)
    known = base(system(counter()))
    assert told(known.always) == {"range of mode"}
    assert str(known.refuted[Fact("range", "level")]) == "undecided: cvc5 could not confirm it in time"


def test_what_holds_for_all_inputs_is_proved_alone(monkeypatch: pytest.MonkeyPatch) -> None:
    """It is the same as in the whole base, also of a composition, and nothing is asked about the assumption."""
    of_one = system(counter(lemmas={"never counts": LEVEL.eq(0), "high from 5": TRUE_LEMMA}, assumption=~TICK))
    of_several = next(example.system for example in EXAMPLES if example.system.parts)
    whole = [told(base(lowered).always) for lowered in (of_one, of_several)]
    monkeypatch.setattr(module, "_KNOWN", weakref.WeakKeyDictionary())
    monkeypatch.setattr(module, "_world", lambda *_: pytest.fail("asked under the assumption"))
    assert [told(proved_always(lowered, seconds=30.0)) for lowered in (of_one, of_several)] == whole
    assert all(whole)
