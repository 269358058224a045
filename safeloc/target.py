"""A system with everything that is to be shown of it, and what makes one from a configuration."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from pydantic import BaseModel

from safeloc.language.machine import Machine
from safeloc.language.spec import Property
from safeloc.language.system import TransitionSystem
from safeloc.railway.pictures import Picture
from safeloc.runtime.reported import Reported
from safeloc.runtime.streams.steps import Cell


@dataclass(frozen=True, eq=False)
class Target:
    """A system with everything that is to be shown of it.

    streams   recorded step streams that ship with it and are replayed by `verify`
    reported  which outputs are the reported interval; None for a machine that reports none
    simulate  seed -> steps of simulated sensors, where there is a simulation
    pictures  how a report draws its recorded runs
    silent    machines that may be told nothing in a step: without any of their inputs the assumption holds as well
    said      name that records have for an input -> the input, where they are not the same
    spec      what was asked for, as on the command line
    unasked   why there is no property, where there is none: what was looked for, in which file, and what to do
    given     of a user's machine: the content of the configuration file that it was made from
    """

    name: str
    machines: tuple[Machine, ...]
    system: TransitionSystem
    properties: tuple[Property, ...]
    config: BaseModel | None = None
    doc: str = ""
    streams: tuple[Path, ...] = ()
    reported: Reported | None = None
    simulate: Callable[[int], Sequence[Mapping[str, Cell]]] | None = None
    pictures: tuple[Picture, ...] = ()
    silent: tuple[str, ...] = ()
    said: Mapping[str, str] = field(default_factory=dict)
    spec: str = ""
    unasked: str = ""
    given: Mapping[str, Any] | None = None


Maker = Callable[[BaseModel], Target]


@dataclass(frozen=True, eq=False)
class Entry:
    """A shipped machine: its configuration class and how to make it."""

    name: str
    summary: str
    config: type[BaseModel]
    make: Maker
