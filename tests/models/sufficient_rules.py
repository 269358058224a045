"""A rule of a layout suffices for its goal, and a looser one does not: decided by the solvers for all lengths."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from safeloc.codegen.smtlib import Query, to_smtlib
from safeloc.language.expr import FALSE, Bool
from safeloc.proof.provers.implication import Refuted, unproved
from safeloc.proof.provers.recheck import recheck

_SECONDS = 30


@dataclass(frozen=True, eq=False)
class Claim:
    """Under `given`, and a rule of the layout, the goal holds; with `loose` in the rule's place it does not."""

    given: Sequence[Bool]
    rule: Bool
    loose: Bool
    goal: Bool


def require_sufficient(name: str, ranges: Sequence[Bool], claim: Claim) -> None:
    """Require the goal: proved by z3, confirmed by cvc5; and that the rule itself can be kept."""
    given = [*ranges, *claim.given, claim.rule]
    assert {} == unproved(Query(name, given, {"goal": claim.goal}), _SECONDS)
    assert ["unsat"] == recheck(f"{name}.smt2", to_smtlib(Query(name, given, {"goal": claim.goal})), 1)
    assert isinstance(unproved(Query(name, given, {"nothing": FALSE}), _SECONDS)["nothing"], Refuted)


def require_loose(name: str, ranges: Sequence[Bool], claim: Claim) -> None:
    """Require a counterexample with the looser rule."""
    given = [*ranges, *claim.given, claim.loose]
    assert isinstance(unproved(Query(name, given, {"goal": claim.goal}), _SECONDS).get("goal"), Refuted)
