"""Functions shared by the makers of shipped machines: recordings by name, and the target of a single machine."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from pydantic import BaseModel

from safeloc.language.machine import Machine
from safeloc.language.spec import Property
from safeloc.language.system import lower
from safeloc.target import Target

STREAMS = Path(__file__).parents[1] / "models" / "streams"


def recorded(name: str) -> tuple[Path, ...]:
    """Return recorded step streams that ship for a machine: `name-what-happens.jsonl.gz`."""
    return tuple(sorted(STREAMS.glob(f"{name}-*.jsonl.gz")))


def single(machine: Machine, properties: Sequence[Property], config: BaseModel) -> Target:
    """Return a single machine with the streams that ship under its name."""
    name = machine.name
    return Target(name, (machine,), lower(machine), tuple(properties), config, machine.doc, recorded(name))
