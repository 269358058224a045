"""The top event of a target's fault tree: its reported interval misses the truth, or its declared hazard occurs."""

from __future__ import annotations

from fnmatch import fnmatchcase

from safeloc.assurance.evidence.interval import HOLDS, holds_truth
from safeloc.errors import InputError
from safeloc.language.renamed import hint
from safeloc.language.spec import Property
from safeloc.target import Target

INTERVAL = "a reported interval misses the truth"


def top_event(target: Target) -> str:
    """Return the top event in words; "" for a target that neither reports an interval nor declares a hazard."""
    interval = INTERVAL if holds_truth(target) is not None else ""
    hazard = target.hazard.text if target.hazard is not None else ""
    return ", or ".join(one for one in (interval, hazard) if one)


def hazard_claims(target: Target) -> tuple[Property, ...]:
    """Return the properties whose breach is the declared hazard. InputError names one that the target does not have."""
    if target.hazard is None:
        return ()
    known = {prop.name: prop for prop in target.properties if prop.kind != "reachable"}
    found = dict[str, Property]()
    for pattern in target.hazard.claims:
        named = {name: prop for name, prop in known.items() if fnmatchcase(name, pattern)}
        if not named:
            raise InputError(
                f"{target.name}: the hazard names the property {pattern!r}; there is none.{hint(pattern, known)}"
            )
        found |= named
    return tuple(found.values())


def top_claims(target: Target) -> frozenset[str]:
    """Return the names of the claims whose breach is the top event."""
    interval = {HOLDS} if holds_truth(target) is not None else set[str]()
    return frozenset(interval | {prop.name for prop in hazard_claims(target)})
