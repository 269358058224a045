"""Data sent between processes arrive unchanged."""

from __future__ import annotations

import pickle

import pytest

from safeloc.codegen.smtlib import Query, to_smtlib
from safeloc.language.expr import Num
from safeloc.language.interpret import evaluate
from safeloc.language.spec import observe
from safeloc.language.verdict import Proved, Unknown, Vacuous, Verdict, Violated
from safeloc.proof.provers.bmc import bmc
from safeloc.proof.provers.kinduction import kinduction
from safeloc.proof.provers.limits import Limits
from safeloc.proof.provers.proved_base import base, ranges_and_lemmas
from safeloc.proof.provers.verdicts_as_data import (
    hold_for_forked,
    pack,
    pack_base,
    pack_term,
    unpack,
    unpack_base,
    unpack_term,
)
from safeloc.proof.provers.workers import Lost, Task, in_processes
from tests.examples import EXAMPLES, Example
from tests.proof.provers.small import LEFT, LEVEL, counter, pair, system


def _sent(verdict: Verdict, example: Example) -> Verdict:
    target = observe(example.system, example.holds)
    return unpack(pickle.loads(pickle.dumps(pack(verdict))), example.system, target.system)


@pytest.mark.parametrize("example", EXAMPLES, ids=lambda example: example.name)
def test_proofs_arrive_whole(example: Example) -> None:
    """Invariant, engine, depth and certificates are as sent."""
    target = observe(example.system, example.holds)
    proved = kinduction(target, Limits())
    assert isinstance(proved, Proved)
    data = pickle.loads(pickle.dumps(pack(proved)))
    arrived = unpack(data, example.system, target.system)
    assert isinstance(arrived, Proved)
    assert proved.invariant is not None
    assert arrived.invariant is not None
    sent, received = (to_smtlib(Query("it", [], {"it": term})) for term in (proved.invariant, arrived.invariant))
    assert received == sent
    assert (arrived.engine, arrived.depth, arrived.rechecked) == (proved.engine, proved.depth, proved.rechecked)
    assert arrived.certificates == proved.certificates


@pytest.mark.parametrize("example", EXAMPLES, ids=lambda example: example.name)
def test_traces_arrive_whole(example: Example) -> None:
    """The run is the same in every step, outputs and fired transitions included."""
    found = bmc(observe(example.system, example.fails), Limits(depth=12))
    assert isinstance(found, Violated)
    arrived = _sent(found, example)
    assert isinstance(arrived, Violated)
    assert found.trace is not None
    assert arrived.trace is not None
    assert arrived.trace.steps == found.trace.steps
    assert arrived.trace.initial == found.trace.initial


def test_certificates_that_both_processes_have_are_sent_by_name() -> None:
    """What was held before the fork comes back as the very text; a text that only equals it, and all within one process, is sent."""
    example = EXAMPLES[0]
    held = "; held"
    other = "".join([held])
    hold_for_forked({"a.smt2": held, "b.smt2": held})
    packed = [pack(Proved(None, "it", 1, (), texts)) for texts in ({"a.smt2": held}, {"b.smt2": other})]
    assert [list(one[5].values()) for one in packed] == [[held], [held]]
    work = [
        lambda texts=texts: pack(Proved(None, "it", 1, (), texts)) for texts in ({"a.smt2": held}, {"c.smt2": held})
    ]
    tasks = [Task("packs", one, 60.0) for one in work]
    arrived = [data for _, data, _ in in_processes(tasks, 1) if not isinstance(data, Lost)]
    assert [list(one[5].values()) for one in arrived] == [[None], [held]]
    back = [unpack(one, example.system, example.system) for one in arrived]
    assert [one.certificates for one in back if isinstance(one, Proved)] == [{"a.smt2": held}, {"c.smt2": held}]


def test_unknown_arrives_whole() -> None:
    """Reason and depth are as sent."""
    arrived = _sent(Unknown("why", 7), EXAMPLES[0])
    assert isinstance(arrived, Unknown)
    assert (arrived.reason, arrived.depth) == ("why", 7)


def test_vacuous_arrives_whole() -> None:
    """Reason and run are as sent."""
    found = bmc(observe(EXAMPLES[0].system, EXAMPLES[0].fails), Limits(depth=12))
    assert isinstance(found, Violated)
    arrived = _sent(Vacuous("its end", found.trace), EXAMPLES[0])
    assert isinstance(arrived, Vacuous)
    assert arrived.reason == "its end"
    assert arrived.trace is not None
    assert found.trace is not None
    assert arrived.trace.steps == found.trace.steps


def test_what_is_true_by_construction_arrives() -> None:
    """A proof without a solver still says so."""
    arrived = _sent(Proved(None, "construction", by_construction="divisors are positive constants"), EXAMPLES[0])
    assert isinstance(arrived, Proved)
    assert arrived.by_construction == "divisors are positive constants"


@pytest.mark.thorough
def test_deep_terms_are_sent_without_recursion() -> None:
    """A term of tens of thousands of levels is sent and read back."""
    lowered = system(counter())
    total: Num = LEVEL
    for _ in range(30_000):
        total = total + 1
    arrived = unpack_term(pickle.loads(pickle.dumps(pack_term(total >= 30_000))), lowered)
    assert evaluate([arrived], {LEVEL: 0}) == [True]
    assert evaluate([arrived], {LEVEL: -1}) == [False]


def test_a_base_arrives_whole() -> None:
    """Facts by key, refuted facts with reasons, certificates and time are as sent."""
    lowered = system(pair({"wrong": LEFT < 3}))
    known = base(lowered)
    arrived = unpack_base(pickle.loads(pickle.dumps(pack_base(known))), ranges_and_lemmas(lowered))
    assert set(arrived.always) == set(known.always)
    assert set(arrived.facts) == set(known.facts)
    assert arrived.refuted == known.refuted
    assert arrived.certificates == known.certificates
