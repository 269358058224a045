"""Formulas for the tests, written as SMT-LIB2 text over a, b, c, d (truth values) and x, y, z (whole numbers)."""

from __future__ import annotations

from safeloc.checker.proofs.goals import RULES
from safeloc.checker.proofs.rewrites import FAMILIES
from safeloc.checker.proofs.steps import Inference, Step
from safeloc.checker.proofs.terms import Term, make, number
from safeloc.checker.proofs.texts import read_goals

DECLARED = "".join(
    [*(f"(declare-const {name} Bool)" for name in "abcd"), *(f"(declare-const {name} Int)" for name in "xyz")]
)


def formula(text: str) -> Term:
    """The formula that the text asserts."""
    [goal] = read_goals(f"{DECLARED}(assert {text})(check-sat)")
    return goal.assertions[0]


def figure(text: str) -> Term:
    """The term of whole numbers."""
    return formula(f"(= {text} {text})").args[0]


def listed(*parts: Term) -> Term:
    """A list of terms, as some rules take for an argument."""
    return make("list", *parts)


def at(index: int) -> Term:
    """A number that counts parts."""
    return number(index)


def follows(rule: str, premises: list[str], args: list[Term], claim: str | Term) -> bool:
    """Whether the rule gives just this claim. WrongStep if it allows no step here."""
    wanted = formula(claim) if isinstance(claim, str) else claim
    inference = Inference(tuple(map(formula, premises)), tuple(args), wanted)
    return (RULES.get(rule) or FAMILIES[rule])(inference) is wanted


def step(rule: str, premises: tuple[int, ...], args: list[Term], claim: str) -> Step:
    """A step of a proof."""
    return Step(rule, premises, tuple(args), formula(claim))


def assume(text: str) -> Step:
    """The step that assumes a formula."""
    return step("ASSUME", (), [formula(text)], text)
