"""Proof that a mutant is conservative: its interval contains the machine's, and is withdrawn whenever the machine's is.

The other outputs have to be equal, except while only the mutant withholds its interval. The known runs may refute this. Then the
machine and the mutant are compared as two copies side by side: from a list of relations between their values (equal, not greater,
not smaller; always, while the mutant reports, or in one mode) the greatest part that every step preserves is kept, and the
requirement has to follow from it.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

from safeloc.assurance.evidence.interval import ReportedTerms
from safeloc.assurance.mutation.claims import Canon, Held
from safeloc.assurance.mutation.equivalence import Side, equal
from safeloc.assurance.mutation.playing import Apart, Trodden, outputs_side_by_side
from safeloc.language.expr import Bool, NumVar
from safeloc.language.nodes import BoolVar, Value
from safeloc.language.units import Enumeration
from safeloc.proof.provers.limits import Limits
from safeloc.reported import Reported

_HOW = "its interval holds the machine's and is withdrawn no later, on every run under the assumption, by two copies side by side"


def conservative(
    known: Held,
    runs: Trodden,
    mutant: Held,
    apart: Sequence[Apart],
    reported: Reported | None,
    canon: Canon,
    limits: Limits,
) -> str:
    """Return a text that says how the mutant was proved conservative, or "". All claims have to be proved for the mutant."""
    if reported is None or any(_is_worse(reported, *outputs) for outputs in outputs_side_by_side(mutant, runs)):
        return ""
    side = Side(known, mutant, apart, canon, limits, still_proved=True)
    goals = _goals(side, reported)
    relations = side.at_first({**side.all_equal(), **dict(_relations(side, reported)), **goals})
    return _HOW if side.proved({**relations, **side.equal_by_mode()}, goals) else ""


def _is_worse(reported: Reported, was: Mapping[str, Value], now: Mapping[str, Value]) -> bool:
    """Return whether the outputs of one state show that the mutant is not conservative."""
    old, new = reported.interval_mm(was), reported.interval_mm(now)
    if new is not None and (old is None or new[0] > old[0] or new[1] < old[1]):
        return True
    return (old is None) == (new is None) and any(now[name] != was[name] for name in _others(reported, was))


def _others(reported: Reported, outputs: Mapping[str, object]) -> list[str]:
    return [name for name in outputs if name not in reported.outputs]


def _both(side: Side, reported: Reported) -> tuple[ReportedTerms, ReportedTerms]:
    """Return the intervals of the machine and of the mutant."""
    one, other = ({name: pair[number] for name, pair in side.outputs.items()} for number in (0, 1))
    return ReportedTerms.of(reported, one), ReportedTerms.of(reported, other)


def _goals(side: Side, reported: Reported) -> dict[str, Bool]:
    old, new = _both(side, reported)
    goals = {
        "withdrawn no later": new.valid.implies(old.valid),
        "no higher below": new.valid.implies(new.low <= old.low),
        "no lower above": new.valid.implies(old.high <= new.high),
    }
    alike = new.valid.iff(old.valid)
    same = {f"output {name}": alike.implies(equal(*side.outputs[name])) for name in _others(reported, side.outputs)}
    return goals | same


def _relations(side: Side, reported: Reported) -> Iterator[tuple[str, Bool]]:
    """Return relations of each variable to its twin: not greater and not smaller, and these and equality while the mutant reports."""
    _, new = _both(side, reported)
    for var, twin in side.twins.items():
        yield f"{var.name} equal if reported", new.valid.implies(equal(var, twin))
        for name, term in _ordered(var, twin):
            yield name, term
            yield f"{name} if reported", new.valid.implies(term)


def _ordered(var: NumVar | BoolVar, twin: NumVar | BoolVar) -> Iterator[tuple[str, Bool]]:
    if isinstance(var, BoolVar) and isinstance(twin, BoolVar):
        yield f"{var.name} no more", twin.implies(var)
        yield f"{var.name} no less", var.implies(twin)
    elif isinstance(var, NumVar) and isinstance(twin, NumVar) and not isinstance(var.unit, Enumeration):
        yield f"{var.name} no greater", twin <= var
        yield f"{var.name} no smaller", var <= twin
