"""Rules of equality and connectives: what follows, and instances that are wrong."""

from __future__ import annotations

from itertools import product

import pytest

from safeloc.checker.proofs.cases import valid
from safeloc.checker.proofs.goals import RULES
from safeloc.checker.proofs.logic import RULES as LOGIC
from safeloc.checker.proofs.steps import Inference, WrongStep
from safeloc.checker.proofs.terms import FALSE, TRUE, Term, make, no, same, variable
from tests.checker.proofs.formulas import at, figure, follows, formula

RIGHT = [
    ("REFL", [], ["x"], "(= x x)"),
    ("SYMM", ["(= x y)"], [], "(= y x)"),
    ("SYMM", ["(not (= x y))"], [], "(not (= y x))"),
    ("TRANS", ["(= x y)", "(= y z)", "(= z x)"], [], "(= x x)"),
    ("CONG", ["(= x y)", "(= z z)"], ["(+ x z)"], "(= (+ x z) (+ y z))"),
    ("NARY_CONG", ["(= a b)", "(= c c)", "(= d a)"], ["(and a c d)"], "(= (and a c d) (and b c a))"),
    ("EQ_RESOLVE", ["a", "(= a b)"], [], "b"),
    ("TRUE_INTRO", ["a"], [], "(= a true)"),
    ("TRUE_ELIM", ["(= a true)"], [], "a"),
    ("FALSE_INTRO", ["(not a)"], [], "(= a false)"),
    ("FALSE_ELIM", ["(= a false)"], [], "(not a)"),
    ("CONTRA", ["a", "(not a)"], [], "false"),
    ("MODUS_PONENS", ["a", "(=> a b)"], [], "b"),
    ("AND_INTRO", ["a", "b"], [], "(and a b)"),
    ("AND_INTRO", ["a"], [], "a"),
    ("AND_ELIM", ["(and a b c)"], [1], "b"),
    ("NOT_OR_ELIM", ["(not (or a b))"], [1], "(not b)"),
    ("NOT_AND", ["(not (and a b))"], [], "(or (not a) (not b))"),
    ("NOT_NOT_ELIM", ["(not (not a))"], [], "a"),
    ("SPLIT", [], ["a"], "(or a (not a))"),
    ("ITE_EQ", [], ["(ite a x y)"], "(ite a (= (ite a x y) x) (= (ite a x y) y))"),
    ("CNF_AND_POS", [], ["(and a b)", 1], "(or (not (and a b)) b)"),
    ("CNF_AND_NEG", [], ["(and a b)"], "(or (and a b) (not a) (not b))"),
    ("CNF_OR_POS", [], ["(or a b)"], "(or (not (or a b)) a b)"),
    ("CNF_OR_NEG", [], ["(or a b)", 0], "(or (or a b) (not a))"),
]
WRONG = [
    ("SYMM", ["a"], []),
    ("TRANS", ["(= x y)", "(= z y)"], []),
    ("TRANS", [], []),
    ("CONG", ["(= x y)"], ["(+ x z)"]),
    ("CONG", ["(= x y)", "(= y y)"], ["(+ x z)"]),
    ("CONG", ["(= z y)", "(= x z)"], ["(+ x z)"]),
    ("CONG", [], ["x"]),
    ("EQ_RESOLVE", ["b", "(= a b)"], []),
    ("TRUE_ELIM", ["(= a false)"], []),
    ("FALSE_ELIM", ["(= a true)"], []),
    ("FALSE_INTRO", ["a"], []),
    ("CONTRA", ["a", "(not b)"], []),
    ("CONTRA", ["a", "b"], []),
    ("MODUS_PONENS", ["b", "(=> a b)"], []),
    ("AND_ELIM", ["(and a b c)"], [3]),
    ("AND_ELIM", ["(and a b c)"], [-1]),
    ("AND_ELIM", ["(or a b)"], [0]),
    ("NOT_OR_ELIM", ["(or a b)"], [0]),
    ("NOT_AND", ["(not (or a b))"], []),
    ("NOT_NOT_ELIM", ["(not a)"], []),
    ("ITE_EQ", [], ["(+ x y)"]),
    ("CNF_AND_POS", [], ["(or a b)", 0]),
    ("CNF_OR_NEG", [], ["(or a b)", 2]),
    ("ITE_ELIM1", ["(not (ite a b c))"], []),
]
OTHER = [
    ("SYMM", ["(= x y)"], [], "(= x y)"),
    ("CONG", ["(= x y)", "(= z z)"], ["(+ x z)"], "(= (- x z) (- y z))"),
    ("CONG", ["(= x y)", "(= z z)"], ["(+ x z)"], "(= (+ x z) (+ z y))"),
    ("AND_ELIM", ["(and a b c)"], [1], "c"),
    ("MODUS_PONENS", ["a", "(=> a b)"], [], "a"),
    ("NOT_AND", ["(not (and a b))"], [], "(or a b)"),
    ("ITE_ELIM1", ["(ite a b c)"], [], "(or a b)"),
]
LISTED = {rule for rule, *_ in RIGHT}
BOOLS = ("a", "b", "c", "d")


def term(written: str | int) -> Term:
    """A formula, a term of whole numbers, or an index."""
    if isinstance(written, int):
        return at(written)
    return formula(written) if written in BOOLS or written.startswith(("(and", "(or")) else figure(written)


@pytest.mark.parametrize(("rule", "premises", "args", "claim"), RIGHT)
def test_a_right_step_follows(rule: str, premises: list[str], args: list[str | int], claim: str) -> None:
    """The rule gives the claim."""
    assert follows(rule, premises, list(map(term, args)), claim)


@pytest.mark.parametrize(("rule", "premises", "args"), WRONG)
def test_a_wrong_step_is_refused(rule: str, premises: list[str], args: list[str | int]) -> None:
    """The rule allows nothing here."""
    with pytest.raises(WrongStep):
        follows(rule, premises, list(map(term, args)), "false")


@pytest.mark.parametrize(("rule", "premises", "args", "claim"), OTHER)
def test_another_claim_does_not_follow(rule: str, premises: list[str], args: list[str | int], claim: str) -> None:
    """The rule gives something else than the claim."""
    assert not follows(rule, premises, list(map(term, args)), claim)


def test_a_name_for_a_term_equals_it() -> None:
    """A name for a term is introduced by its equation only, and is no function that equal arguments go through."""
    name = make("purify", figure("(+ x y)"))
    claim = same(name, figure("(+ x y)"))
    assert claim is RULES["SKOLEM_INTRO"](Inference((), (name,), claim))
    with pytest.raises(WrongStep):
        RULES["SKOLEM_INTRO"](Inference((), (figure("x"),), claim))
    with pytest.raises(WrongStep, match="no function"):
        RULES["CONG"](Inference((formula("(= (+ x y) z)"),), (name,), claim))


PARTS = [variable(name, "Bool") for name in "abc"]
WHOLES = {
    "=>": make("=>", *PARTS[:2]),
    "=": same(*PARTS[:2]),
    "xor": make("xor", *PARTS[:2]),
    "ite": make("ite", *PARTS),
}


def _kind(rule: str) -> str:
    words = {"IMPLIES": "=>", "EQUIV": "=", "XOR": "xor", "ITE": "ite"}
    return next(op for word, op in words.items() if word in rule.split("_"))


@pytest.mark.parametrize(
    "rule", [rule for rule in LOGIC if rule.startswith("CNF_") and rule.split("_")[1] not in ("AND", "OR")]
)
def test_clauses_of_a_connective_are_true(rule: str) -> None:
    """A clause that a connective's rule gives is true in every case, and speaks of the whole formula."""
    whole = WHOLES[_kind(rule)]
    found = LOGIC[rule](Inference((), (whole,), TRUE))
    assert valid(found)
    assert {whole, no(whole)} & set(found.args)


@pytest.mark.parametrize("rule", [rule for rule in LOGIC if "_ELIM" in rule and rule not in LISTED])
def test_what_a_premise_gives_is_implied_by_it(rule: str) -> None:
    """Whatever an elimination makes of a premise is implied by the premise, and is not always true."""
    whole = WHOLES[_kind(rule)]
    premise = no(whole) if rule.startswith("NOT_") else whole
    found = LOGIC[rule](Inference((premise,), (), TRUE))
    assert valid(found, [premise])
    assert not valid(found)


def test_rules_of_ite_and_equivalence_are_not_mixed_up() -> None:
    """The two or three clauses of a connective together say as much as the connective itself."""
    for op, count in (("=>", 1), ("=", 2), ("xor", 2), ("ite", 2)):
        name = {"=>": "IMPLIES", "=": "EQUIV", "xor": "XOR", "ite": "ITE"}[op]
        rules = [f"{name}_ELIM{number}" if count > 1 else f"{name}_ELIM" for number in range(1, count + 1)]
        clauses = [LOGIC[rule](Inference((WHOLES[op],), (), FALSE)) for rule in rules]
        assert valid(WHOLES[op], clauses)
        clauses = [LOGIC[f"NOT_{name}_ELIM{number}"](Inference((no(WHOLES[op]),), (), FALSE)) for number in (1, 2)]
        assert valid(no(WHOLES[op]), clauses)


def test_truth_tables_are_complete() -> None:
    """`valid`, which these tests lean on, agrees with truth tables of Python on every formula of two connectives."""
    tables = {"and": all, "or": any, "=": lambda p: p[0] == p[1], "=>": lambda p: not p[0] or p[1]}
    for outer, inner in product(tables, repeat=2):
        asked = make(outer, make(inner, *PARTS[:2]), PARTS[2])
        truths = [tables[outer]([tables[inner](case[:2]), case[2]]) for case in product((False, True), repeat=3)]
        assert all(truths) == valid(asked)
        assert (not any(truths)) == valid(no(asked))
