"""Findings with the verdict "not asked": they give exit code 3, since a missing check is not a success."""

from __future__ import annotations

from safeloc.language.verdict import NotAsked
from safeloc.proof.results import Finding, Kind
from safeloc.target import Target

SOMETHING = "the machine has a property to prove"
NO_PROPERTY = "the target has no property; declare what must hold."


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
        return target.unasked or NO_PROPERTY
    number = len(target.properties)
    all_ = "the only property is" if number == 1 else f"all {number} properties are"
    return (
        f"{all_} of kind reachable, which `prove` and `verify` look for; tests and replays check always, never, within."
    )


def unasked(target: Target, kind: Kind, name: str, why: str) -> Finding:
    """Return a finding of verdict `not asked`."""
    return Finding(f"{target.name}/{kind}/{name}", target.name, kind, SOMETHING, NotAsked(why), "nothing to check", 0.0)
