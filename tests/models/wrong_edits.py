"""Whether a wrong edit of a machine is noticed by a proof: which of its properties are lost."""

from __future__ import annotations

from collections.abc import Sequence

from safeloc.language.machine import Machine
from safeloc.language.spec import Property
from safeloc.language.system import TransitionSystem, lower
from safeloc.language.verdict import word
from safeloc.proof.provers.limits import Limits
from safeloc.proof.provers.portfolio import prove


def lost(machine: Machine, properties: Sequence[Property], *names: str) -> dict[str, str]:
    """Of the named properties, or of all, those that the machine as edited is no longer proved to keep, with the verdict."""
    return lost_by(lower(machine), properties, *names)


def lost_by(system: TransitionSystem, properties: Sequence[Property], *names: str, seconds: int = 20) -> dict[str, str]:
    """The same of a composition; within so many seconds each."""
    known = {prop.name for prop in properties}
    if unknown := set(names) - known:
        raise KeyError(f"no such property: {sorted(unknown)}")
    asked = [prop for prop in properties if not names or prop.name in names]
    found = prove(system, asked, Limits(seconds=seconds), jobs=1, lemmas=False)
    verdicts = {one.id.split("/property/")[-1]: word(one.result) for one in found}
    return {prop.name: verdicts[prop.name] for prop in asked if verdicts[prop.name] != "proved"}
