"""Findings with the verdict "not asked": they give exit code 3, since a missing check is not a success.

Nothing was declared that could be asked, or the run was a quick one, which asks for no proof.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

from safeloc.language.composed_names import contract_text
from safeloc.language.expr import TRUE
from safeloc.language.verdict import NotAsked, Vacuous
from safeloc.proof.provers.absent_in_claims import some_read
from safeloc.proof.provers.obligations import ASSUMPTION, CHECKS, CLAIMS
from safeloc.proof.results import Finding, Kind
from safeloc.target import Target

_SOMETHING = "the machine has a property to prove"
_NO_PROPERTY = "the target has no property; declare what must hold."
QUICK = "not asked: a quick run"
"""Method of a finding that a quick run leaves open; the headline of a report knows it by this."""
LATER = "a quick run proves nothing; `safeloc verify` without --quick asks for it."


def nothing_asked(target: Target) -> list[Finding]:
    """Return one finding if there is no property, with the reason and a remedy; else none."""
    return [] if target.properties else [unasked(target, "property", "nothing asked", reason(target))]


def nothing_tested(target: Target) -> list[Finding]:
    """Return one finding if the target has no property that a test could break; else none."""
    if any(prop.kind != "reachable" for prop in target.properties):
        return []
    return [unasked(target, "test", "nothing tested", reason(target))]


def reason(target: Target) -> str:
    """Return the reason why a run has nothing to check: there is no property, or only `reachable` ones."""
    if not target.properties:
        return target.unasked or _NO_PROPERTY
    number = len(target.properties)
    all_ = "the only property is" if number == 1 else f"all {number} properties are"
    return (
        f"{all_} of kind reachable, which `prove` and `verify` look for; tests and replays check always, never, within."
    )


def unasked(target: Target, kind: Kind, name: str, why: str) -> Finding:
    """Return a finding of verdict `not asked`."""
    return Finding(
        f"{target.name}/{kind}/{name}", target.name, kind, _SOMETHING, NotAsked(why), "nothing to check", 0.0
    )


def left_open(target: Target) -> list[Finding]:
    """Return a finding for everything that a complete run would prove and a quick one does not: properties, lemmas, obligations."""
    why = NotAsked(LATER)
    proofs = [
        Finding(
            f"{target.name}/property/{one.name}",
            target.name,
            "property",
            one.statement,
            why,
            QUICK,
            0.0,
            one.requirements,
        )
        for one in target.properties
    ]
    others: Iterator[tuple[Kind, str, str]] = _lemmas_and_obligations(target)
    return proofs + [
        Finding(f"{target.name}/{kind}/{name}", target.name, kind, what, why, QUICK, 0.0) for kind, name, what in others
    ]


def _lemmas_and_obligations(target: Target) -> Iterator[tuple[Kind, str, str]]:
    for name in target.system.lemmas:
        yield "lemma", name, f"lemma {name}"
    for part in target.system.parts:
        if part.contract is not TRUE:
            yield "lemma", contract_text(part.name), f"what {part.name} assumes is guaranteed by the machines before it"
    for check in (*CHECKS, ASSUMPTION):
        if check != "overlap":  # one of each machine
            yield "obligation", check, f"built-in check {check}"
    if some_read(target.properties, target.system):
        yield "obligation", CLAIMS, f"built-in check {CLAIMS}"
    for machine in target.machines:
        yield "obligation", f"overlap {machine.name}", "built-in check overlap"
        for mode in machine.modes:
            yield "obligation", f"mode {machine.name} {mode.label}", "the mode occurs"
        for transition in machine.transitions:
            yield "obligation", f"transition {machine.name}: {transition.name}", "the transition fires"


def as_left_open(finding: Finding) -> Finding:
    """Return the finding of a property test in a quick run: a case that never occurred is left open, as it was not searched for."""
    if not isinstance(finding.result, Vacuous):
        return finding
    return replace(finding, result=NotAsked(f"{finding.result.reason}; {LATER}"), method=QUICK)
