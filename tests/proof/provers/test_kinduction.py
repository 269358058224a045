"""k-induction: the properties that it proves, the facts that it needs, and those that it must not use."""

from __future__ import annotations

import re
from dataclasses import replace
from typing import Any

import pytest

from benchmarks.composed_line import composed_target
from safeloc.codegen.smtlib import Query
from safeloc.language.spec import observe, previous, within
from safeloc.language.terms import variables
from safeloc.language.verdict import Unknown, require_proved
from safeloc.proof.provers import kinduction as module
from safeloc.proof.provers.implication import unproved
from safeloc.proof.provers.kinduction import kinduction, queries
from safeloc.proof.provers.limits import Limits
from safeloc.proof.provers.proved_base import base
from safeloc.proof.provers.recheck import Certificate, certify
from tests.examples import latch
from tests.proof.provers.small import FULL_TOGETHER, LEVEL, SAME, TICK, counter, goal, pair, system

ONE = Limits(induction=1)


def test_a_declared_lemma_makes_a_property_inductive() -> None:
    """Without its lemma the claim is undecided at every k that is tried; with it, one step is enough."""
    alone = kinduction(goal(pair(), FULL_TOGETHER), Limits())
    assert isinstance(alone, Unknown)
    assert re.match(
        r"not 3-inductive with the proved ranges and lemmas: good steps from a state with \w+ = \d+.* lead to a bad one",
        alone.reason,
    )
    proved = require_proved(kinduction(goal(pair({"in step": SAME}), FULL_TOGETHER), ONE))
    assert proved.engine == "1-induction"


def test_a_wrong_lemma_is_not_assumed() -> None:
    """A false lemma that would imply the claim proves nothing."""
    verdict = kinduction(goal(pair({"in step": SAME}, behind=True), FULL_TOGETHER & SAME), Limits())
    assert isinstance(verdict, Unknown)


def test_a_contradictory_lemma_is_not_assumed() -> None:
    """A lemma that never holds would imply everything; nothing is proved from it."""
    verdict = kinduction(goal(counter(lemmas={"nonsense": (LEVEL < 0)}), LEVEL <= 3), Limits())
    assert isinstance(verdict, Unknown)


def test_a_broken_guard_makes_the_proof_fail() -> None:
    """The claim is proved of the right machine and not of the wrong one."""
    require_proved(kinduction(goal(counter(), LEVEL <= 10), ONE))
    assert isinstance(kinduction(goal(counter(stride=2), LEVEL <= 10), Limits()), Unknown)


def test_two_steps_where_one_is_not_enough() -> None:
    """k grows until the claim follows; start and step are certified for that k."""
    example = latch()
    target = observe(example.system, example.holds)
    assert isinstance(kinduction(target, ONE), Unknown)
    proved = require_proved(kinduction(target, Limits(induction=2)))
    assert (proved.engine, proved.depth) == ("2-induction", 2)
    start, _ = queries(target, base(example.system), 2)
    assert list(start.goals) == ["good after 0 steps", "good after 1 steps"]


def test_conjuncts_are_asked_one_by_one() -> None:
    """Each part of a conjunction is a question of its own, in z3 and in the certificate."""
    target = goal(pair(), SAME & FULL_TOGETHER)
    _, later = queries(target, base(target.original), 1)
    assert list(later.goals) == ["good after the last step, part 1", "good after the last step, part 2"]
    proved = require_proved(kinduction(target, ONE))
    [step] = [text for file, text in proved.certificates.items() if file.startswith("pair-claim-step-")]
    assert step.count("(check-sat)") == 2


def test_an_unconditional_property_uses_no_assumption() -> None:
    """A property that needs the assumption is proved with it, and not without it."""
    machine = counter(assumption=~TICK, lemmas={"rests": LEVEL.eq(0)})
    require_proved(kinduction(goal(machine, LEVEL <= 3), ONE))
    assert isinstance(kinduction(goal(machine, LEVEL <= 3, unconditional=True), ONE), Unknown)


def test_a_helper_is_proved_with_the_property() -> None:
    """A lemma over the time waited helps to prove a response time, and is proved too; with nothing pending it says nothing."""
    lowered = system(counter())
    soon = within("soon", 3, LEVEL.eq(10), LEVEL >= 10, helper=lambda waited: waited > 3)
    require_proved(kinduction(observe(lowered, soon), ONE))  # its trigger never waits
    wrong = within("one step later", 1, TICK, previous(TICK), helper=lambda waited: waited > 3)
    assert isinstance(kinduction(observe(lowered, wrong), Limits()), Unknown)
    require_proved(kinduction(observe(lowered, replace(wrong, helper=lambda waited: waited <= 1)), Limits()))


def test_no_time_is_unknown() -> None:
    """Without time the verdict is Unknown, with the reason."""
    verdict = kinduction(goal(counter(), LEVEL <= 10), Limits(seconds=1e-6))
    assert isinstance(verdict, Unknown)
    assert "undecided" in verdict.reason


def test_z3_alone_proves_nothing(monkeypatch: pytest.MonkeyPatch) -> None:
    """If cvc5 cannot confirm in time, the verdict is Unknown and says so."""

    def doubtful(query: Query, **how: Any) -> Certificate:
        return replace(certify(query, **how), undecided=tuple(query.goals))

    monkeypatch.setattr(module, "certify", doubtful)
    verdict = kinduction(goal(counter(), LEVEL <= 10), ONE)
    assert isinstance(verdict, Unknown)
    assert verdict.reason == "proved by 1-induction in z3, but cvc5 could not confirm it in time"


def test_certificates_name_what_they_rely_on() -> None:
    """The shared texts of ranges and lemmas are part of the evidence, and named in the text that uses them."""
    proved = require_proved(kinduction(goal(counter(), LEVEL <= 10), ONE))
    [shared] = [file for file in proved.certificates if file.startswith("counter-always-step-")]
    [start] = [text for file, text in proved.certificates.items() if file.startswith("counter-claim-start-")]
    assert f"; relies on: {shared}\n" in start


def test_a_claim_on_few_machines_is_proved_by_what_is_known_of_these(monkeypatch: pytest.MonkeyPatch) -> None:
    """Of a line of sections, no question about the first one reads the last one, nor the other way round."""
    asked: list[Query[Any]] = []

    def noted(query: Query[Any], *limits: Any) -> dict[Any, Any]:
        asked.append(query)
        return unproved(query, *limits)

    monkeypatch.setattr(module, "unproved", noted)
    target = composed_target(31)
    for section, other in (("section_1", "section_4"), ("section_4", "section_1")):
        asked.clear()
        claim = next(one for one in target.properties if one.name.startswith(f"{section}:"))
        require_proved(kinduction(observe(target.system, claim), Limits()))
        read = [var.name for query in asked for var in variables([*query.hypotheses, *query.goals.values()])]
        assert any(name.startswith(f"{section}.") for name in read)
        assert not any(name.startswith(f"{other}.") for name in read)
