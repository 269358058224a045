"""Witness functions: what they show, and that a wrong one shows nothing."""

from __future__ import annotations

import re
from dataclasses import replace

import pytest

from safeloc.catalogue import load_target
from safeloc.language.expr import before
from safeloc.language.spec import always
from safeloc.proof.provers.portfolio import prove
from tests.checker.declared import KNOWN, PLACE, TICK
from tests.checker.small_proofs import LIMITS, Evidence, kept, refused

DEAD_ENDS = "tracking/obligation/dead ends"


def test_more_than_one_witness_function_is_needed(proofs: dict[str, Evidence]) -> None:
    """At the ends of the range another step is lawful than elsewhere."""
    evidence = proofs["tracking"]
    text = evidence.texts[evidence.file("by-what")]
    assert 2 <= len(set(re.findall(r"\|witness (\S+) of moved\|", text)))
    assert DEAD_ENDS not in refused(evidence.judged())


@pytest.mark.parametrize(
    ("pattern", "other"),
    [
        (r"(of read\| \(\) Int )\S+\)", r"\g<1>61)"),  # out of range
        (r"(of read\| \(\) Int )\S+\)", r"\g<1>0)"),  # not where the train is
        (r"(of read.present\| \(\) Bool )\S+\)", r"\g<1>false)"),
        (r"(of moved\| \(\) Int )\S+\)", r"\g<1>0)"),
        (r"\(define-fun \|witness \S+ of moved\| .*\)\n", ""),  # says nothing of an input
    ],
)
def test_a_wrong_witness_function(proofs: dict[str, Evidence], pattern: str, other: str) -> None:
    """The solvers agree to all that is asked of them, and the claim is not confirmed."""
    evidence = proofs["tracking"]
    file = evidence.file("by-what")
    changed, number = re.subn(pattern, other, evidence.texts[file])
    assert number
    assert DEAD_ENDS in refused(evidence.judged({file: changed}))


def test_a_witness_function_that_names_the_input_itself(proofs: dict[str, Evidence]) -> None:
    """An input in the place of itself leaves everything open."""
    evidence = proofs["tracking"]
    file = evidence.file("by-what")
    said = re.sub(r"(of moved\| \(\) Int )\S+\)", r"\g<1>|moved|)", evidence.texts[file])
    text = said.replace("(define-fun |witness", "(declare-const |moved| Int)\n(define-fun |witness", 1)
    found = evidence.judged({file: text})
    assert DEAD_ENDS in refused(found)
    assert file not in found.wrong


def test_what_a_property_is_given_has_to_last() -> None:
    """The proof stands, and without the witness functions the property is not confirmed: it might be of no run at all."""
    target = load_target("tests.checker.declared:tracking")
    given = always("known is near while it ticks", before(PLACE) <= KNOWN, further_assumption=TICK)
    asked = replace(target, properties=(given,))
    evidence = kept(asked, prove(asked.system, asked.properties, LIMITS))
    [name] = [row["id"] for row in evidence.rows if row["kind"] == "property"]
    assert name not in refused(evidence.judged())
    file = evidence.file("by-what")
    wrong = re.sub(r"(of tick\| \(\) Bool )\S+\)", r"\g<1>false)", evidence.texts[file])
    assert wrong != evidence.texts[file]
    assert name in refused(evidence.judged({file: wrong}))
