"""The top event of a target that reports an interval: the interval does not contain the true position."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from safeloc.language.expr import Bool, Expr, Num, NumVar, exact_to
from safeloc.language.spec import Property, always, within
from safeloc.language.terms import numeric
from safeloc.language.units import NM
from safeloc.reported import Reported
from safeloc.target import Target

HOLDS = "the reported interval holds the truth"


def holds_truth(target: Target) -> Property | None:
    """Return the claim that a reported interval always contains the true position; None without interval or truth."""
    term = _term(target)
    return None if term is None else always(HOLDS, term)


def claims_of(target: Target) -> list[Property]:
    """Return the target's claims, without reachable ones, and the claim that its interval contains the truth."""
    top = holds_truth(target)
    claims = [prop for prop in target.properties if prop.kind != "reachable"]
    return [*claims, *([top] if top is not None else [])]


def withdrawn_within(target: Target, cycles: int) -> Property:
    """Return the claim that a wrong interval is right again or withdrawn after at most `cycles` cycles.

    ValueError if the target reports no interval.
    """
    term = _term(target)
    if term is None:
        raise ValueError(f"{target.name} reports no interval whose truth is known.")
    return within(f"a wrong interval is withdrawn within {cycles} cycles", cycles, ~term, term)


def valid_term(target: Target) -> Bool:
    """Return the term, over the state, that is true if an interval is reported."""
    assert target.reported is not None
    return ReportedTerms.of(target.reported, target.system.outputs).valid


@dataclass(frozen=True, eq=False)
class ReportedTerms:
    """A reported interval as terms over the state: whether one is reported, and its ends, in mm."""

    valid: Bool
    low: Num
    high: Num

    @classmethod
    def of(cls, reported: Reported, outputs: Mapping[str, Expr]) -> ReportedTerms:
        """Return the interval of these outputs."""
        flag = outputs[reported.valid]
        assert isinstance(flag, Bool)
        place, below, above = (numeric(outputs[name]) for name in (reported.position, reported.below, reported.above))
        return cls(flag if reported.valid_is else ~flag, place - below, place + above)


def _term(target: Target) -> Bool | None:
    reported, system = target.reported, target.system
    truth = None if reported is None else next((var for var in system.ghosts if var.name == reported.truth), None)
    if reported is None or not isinstance(truth, NumVar):
        return None
    ends = ReportedTerms.of(reported, system.outputs)
    return ends.valid.implies((_in_nm(ends.low) <= truth) & (truth <= _in_nm(ends.high)))


def _in_nm(term: Num) -> Num:
    return exact_to(term, NM)
