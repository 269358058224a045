"""Findings that say that nothing was asked: they end with exit code 3, since silence is no good news."""

from __future__ import annotations

from safeloc.target import Target
from safeloc.language.verdict import NotAsked
from safeloc.proof.results import Finding, Kind

SOMETHING = "something of the machine is to be shown"
NO_PROPERTY = "the target has no property; declare what must hold."


def nothing_asked(target: Target) -> list[Finding]:
    """One finding where there is no property, which says what was looked for and what to do; else none."""
    return [] if target.properties else [unasked(target, "property", "nothing asked", reason(target))]


def nothing_tested(target: Target) -> list[Finding]:
    """One finding where nothing is left that a test could break; else none."""
    if any(prop.kind != "reachable" for prop in target.properties):
        return []
    return [unasked(target, "test", "nothing tested", reason(target))]


def reason(target: Target) -> str:
    """Why a run of the machine leaves nothing to be checked: no property, or only such as `reachable`."""
    if not target.properties:
        return target.unasked or NO_PROPERTY
    number = len(target.properties)
    all_ = "the only property is" if number == 1 else f"all {number} properties are"
    return (
        f"{all_} of kind reachable, which `prove` and `verify` look for; tests and replays check always, never, within."
    )


def unasked(target: Target, kind: Kind, name: str, why: str) -> Finding:
    """A finding of verdict `not asked`."""
    return Finding(f"{target.name}/{kind}/{name}", target.name, kind, SOMETHING, NotAsked(why), "nothing to check", 0.0)
