"""Whether everything of a machine is proved, with the runs that ship with it: no search finds again what they show."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from safeloc.catalogue import load_target
from safeloc.language.machine import Machine
from safeloc.language.spec import Property
from safeloc.language.system import lower
from safeloc.language.verdict import word
from safeloc.proof.provers.limits import Limits
from safeloc.proof.provers.portfolio import prove
from safeloc.proof.provers.recorded_witnesses import Recording
from safeloc.proof.verification.witness_files import read_witnesses
from safeloc.runtime.streams.steps import read_steps


def shipped_runs(name: str) -> dict[str, Any]:
    """The recordings and witnesses that ship with a machine, for provers: what they show needs no search."""
    target = load_target(name)
    recordings = [Recording(stream.first, stream.steps) for stream in map(read_steps, target.streams)]
    return {"recordings": recordings, "witnesses": read_witnesses(target.witnesses)}


def unproved_of(machine: Machine, properties: Sequence[Property]) -> dict[str, str]:
    """Properties and lemmas of a shipped machine that are not proved without bound, with their verdict."""
    found = prove(lower(machine), properties, Limits(seconds=30), jobs=1, **shipped_runs(machine.name))
    return {one.id: word(one.result) for one in found if word(one.result) != "proved"}
