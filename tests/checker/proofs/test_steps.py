"""Whole proofs as data: order, assumptions, what is discharged, and what is left to trust."""

from __future__ import annotations

from safeloc.checker.proofs.goals import RULES
from safeloc.checker.proofs.rewrites import FAMILIES
from safeloc.checker.proofs.steps import Checked, Failed, Step, check
from safeloc.checker.proofs.terms import FALSE
from tests.checker.proofs.formulas import assume, at, formula, step

ASSERTED = ["a", "(=> a b)", "(not b)"]
PROOF = [
    *map(assume, ASSERTED),
    step("MODUS_PONENS", (0, 1), [], "b"),
    step("CONTRA", (3, 2), [], "false"),
]


def checked(steps: list[Step], asserted: list[str]) -> Checked | Failed:
    """The proof from these assertions."""
    return check(steps, frozenset(map(formula, asserted)), RULES, families=FAMILIES)


def why(steps: list[Step], asserted: list[str]) -> str:
    """Why it is no proof."""
    result = checked(steps, asserted)
    assert isinstance(result, Failed)
    return result.where


def test_a_proof() -> None:
    """All steps follow, from what is asserted: nothing is left to trust."""
    assert Checked(5, {"ASSUME": 3, "MODUS_PONENS": 1, "CONTRA": 1}, {}) == checked(PROOF, ASSERTED)


def test_a_proof_from_something_else() -> None:
    """An assumption that the text does not assert is named."""
    for missing in range(3):
        assert "does not assert" in why(PROOF, ASSERTED[:missing] + ASSERTED[missing + 1 :])


def test_a_proof_of_something_else() -> None:
    """The last step has to claim false, and there has to be one."""
    assert "does not claim false" in why(PROOF[:-1], ASSERTED)
    assert "does not claim false" in why([], ASSERTED)


def test_a_step_uses_what_comes_before_it() -> None:
    """A step that rests on itself, on a later one or on none at all is wrong."""
    for premises in ((0, 5), (0, 4), (0, -1)):
        assert "before it" in why([*PROOF[:4], step("CONTRA", premises, [], "false")], ASSERTED)


def test_a_claim_is_what_follows() -> None:
    """A claim that differs from what the rule computes is wrong."""
    wrong = [*PROOF[:3], step("MODUS_PONENS", (0, 1), [], "c"), *PROOF[4:]]
    assert why(wrong, ASSERTED) == "step 3 of 5, MODUS_PONENS: claims c, but b follows"


def test_an_assumption_claims_itself() -> None:
    """Nothing is assumed under the name of another formula."""
    wrong = [Step("ASSUME", (), (formula("a"),), FALSE)]
    assert "claims another formula" in why(wrong, ["a"])


def test_what_is_assumed_for_a_while_is_discharged() -> None:
    """An assumption of a part of the proof is discharged by an implication, or by its negation where it led to false."""
    steps = [
        assume("(not c)"),
        assume("(=> (not c) false)"),
        step("MODUS_PONENS", (0, 1), [], "false"),
        step("SCOPE", (2,), [formula("(not c)")], "(not (not c))"),
        assume("(not (not (not c)))"),
        step("CONTRA", (3, 4), [], "false"),
    ]
    asserted = ["(=> (not c) false)", "(not (not (not c)))"]
    assert {} == getattr(checked(steps, asserted), "trusted", None)
    steps[3] = step("SCOPE", (2,), [formula("(not c)")], "(=> (not c) false)")
    assert "the implication" in why(steps, asserted)


def test_only_what_is_named_is_discharged() -> None:
    """Discharging one assumption leaves the others open, and those used past it stay open too."""
    steps = [
        assume("a"),
        assume("(not a)"),
        step("CONTRA", (0, 1), [], "false"),
        step("SCOPE", (2,), [formula("a")], "(not a)"),
        step("CONTRA", (0, 3), [], "false"),
    ]
    assert "does not assert" in why(steps, ["a"])
    assert "does not assert" in why(steps, ["(not a)"])
    assert isinstance(checked(steps, ["a", "(not a)"]), Checked)


def test_several_are_discharged_together() -> None:
    """The implication is from all of them in the order they are named, and from none if none is named."""
    premises = [assume("a"), assume("(not a)"), step("CONTRA", (0, 1), [], "false")]
    both = [formula("a"), formula("(not a)")]
    good = step("SCOPE", (2,), both, "(not (and a (not a)))")
    assert "false" in why([*premises, good], [])
    for wrong in (
        step("SCOPE", (2,), both, "(not (and (not a) a))"),
        step("SCOPE", (2,), [], "false"),
        step("SCOPE", (1, 2), both, "(not (and a (not a)))"),
    ):
        assert why([*premises, wrong], []).startswith("step 3 of 4, SCOPE")


def test_a_rule_that_is_unknown_is_trusted_and_named() -> None:
    """What no rule is known for counts under its name; it does not pass unseen, nor do its assumptions."""
    steps = [assume("a"), step("FINE_PRINT", (0,), [], "b"), step("FINE_PRINT", (1,), [], "false")]
    result = checked(steps, ["a"])
    assert isinstance(result, Checked)
    assert {"FINE_PRINT": 2} == result.trusted
    assert "does not assert" in why(steps, ["b"])


def test_a_rewrite_that_is_not_shown_is_trusted_and_named() -> None:
    """A rewrite counts under its own name."""
    steps = [
        step("DSL_REWRITE:ODD", (), [at(1)], "(= a b)"),
        assume("(not (= a b))"),
        step("CONTRA", (0, 1), [], "false"),
    ]
    assert {"DSL_REWRITE:ODD": 1} == getattr(checked(steps, ["(not (= a b))"]), "trusted", None)


def test_arguments_of_the_wrong_sort_are_no_crash() -> None:
    """A step of terms that do not fit is wrong."""
    steps = [assume("a"), Step("ARITH_MULT_POS", (), (formula("a"), formula("(< x y)")), FALSE)]
    assert why(steps, ["a"]).startswith("step 1 of 2, ARITH_MULT_POS")
