"""What the makers of shipped machines share: recordings by name, and a machine that stands alone."""

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
    """Recorded step streams that ship for a machine: `name-what-happens.jsonl.gz`."""
    return tuple(sorted(STREAMS.glob(f"{name}-*.jsonl.gz")))


def single(machine: Machine, properties: Sequence[Property], config: BaseModel) -> Target:
    """A single machine with the streams that ship under its name."""
    name = machine.name
    return Target(name, (machine,), lower(machine), tuple(properties), config, machine.doc, recorded(name))
