"""Resolution: pivots that are there, pivots that are not, and clauses that say the same."""

from __future__ import annotations

import pytest

from safeloc.checker.proofs.steps import WrongStep
from safeloc.checker.proofs.terms import FALSE, TRUE, Term
from tests.checker.proofs.formulas import follows, formula, listed

A, B = formula("a"), formula("b")


def chain(signs: list[Term], pivots: list[Term], *result: Term) -> list[Term]:
    """Arguments of a chain."""
    return [*result, listed(*signs), listed(*pivots)]


RIGHT = [
    ("RESOLUTION", ["(or a c)", "(or (not a) d)"], [TRUE, A], "(or c d)"),
    ("RESOLUTION", ["(or (not a) d)", "(or a c)"], [FALSE, A], "(or d c)"),
    ("RESOLUTION", ["a", "(not a)"], [TRUE, A], "false"),
    ("RESOLUTION", ["(or a c)", "(not a)"], [TRUE, A], "c"),
    ("RESOLUTION", ["(or a b)", "(or (not (or a b)) c)"], [TRUE, formula("(or a b)")], "c"),
    ("CHAIN_RESOLUTION", ["(or a b c)", "(not a)", "(or (not b) c)"], chain([TRUE, TRUE], [A, B]), "(or c c)"),
    ("CHAIN_RESOLUTION", ["(or a b c)", "(not a)", "(or (not b) c)"], chain([TRUE, TRUE], [A, B]), "c"),
    ("CHAIN_M_RESOLUTION", ["(or a b)", "(not a)", "(not b)"], chain([TRUE, TRUE], [A, B], FALSE), "false"),
    ("FACTORING", ["(or a b a)"], [], "(or a b)"),
    ("FACTORING", ["(or a a)"], [], "a"),
    ("REORDERING", ["(or a b c)"], [formula("(or c a b)")], "(or c a b)"),
]
WRONG = [
    ("RESOLUTION", ["(or a c)", "(or (not b) d)"], [TRUE, A], "(or c d)"),
    ("RESOLUTION", ["(or a c)", "(or a d)"], [TRUE, A], "(or c d)"),
    ("RESOLUTION", ["(or a c)", "(or (not a) d)"], [FALSE, A], "(or c d)"),
    ("RESOLUTION", ["(or a c)", "(or (not a) d)"], [TRUE, A], "c"),
    ("RESOLUTION", ["(or a c)", "(or (not a) d)"], [TRUE, A], "false"),
    ("RESOLUTION", ["(or a c)", "(or (not a) d)"], [B, A], "(or c d)"),
    ("RESOLUTION", ["(or a (or b c))", "(not b)"], [TRUE, B], "(or a c)"),
    ("CHAIN_RESOLUTION", ["(or a c)", "(not a)", "(not b)"], chain([TRUE, TRUE], [A, B]), "c"),
    ("CHAIN_RESOLUTION", ["(or a b)", "(not a)"], chain([TRUE, TRUE], [A, B]), "false"),
    ("CHAIN_RESOLUTION", ["a"], chain([], []), "false"),
    ("CHAIN_M_RESOLUTION", ["(or a b c)", "(not a)", "(not b)"], chain([TRUE, TRUE], [A, B], FALSE), "false"),
    ("FACTORING", ["(or a b a)"], [], "a"),
    ("REORDERING", ["(or a b c)"], [formula("(or a b)")], "(or a b)"),
    ("REORDERING", ["(or a b)"], [formula("(or a b c)")], "(or a b c)"),
]


@pytest.mark.parametrize(("rule", "premises", "args", "claim"), RIGHT)
def test_a_resolvent_follows(rule: str, premises: list[str], args: list[Term], claim: str) -> None:
    """The rule gives the claim."""
    assert follows(rule, premises, args, claim)


@pytest.mark.parametrize(("rule", "premises", "args", "claim"), WRONG)
def test_what_is_no_resolvent_is_refused(rule: str, premises: list[str], args: list[Term], claim: str) -> None:
    """No pivot, one of the same sign, a literal lost, a literal that stands deeper: each is refused."""
    with pytest.raises(WrongStep):
        follows(rule, premises, args, claim)
