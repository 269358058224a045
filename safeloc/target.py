"""A system with everything that is to be shown of it, and what makes one from a configuration."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from pydantic import BaseModel

from safeloc.config import Configurations
from safeloc.language.machine import Machine
from safeloc.language.nodes import Value
from safeloc.language.spec import Property
from safeloc.language.system import TransitionSystem
from safeloc.railway.pictures import Picture
from safeloc.reported import Reported


@dataclass(frozen=True, eq=False)
class Target:
    """A system with its properties, recordings, simulation and pictures: one item under verification.

    streams   recorded step streams that ship with it; `verify` replays them
    reported  which outputs are the reported interval; None for a machine that reports none
    simulate  seed -> steps of simulated sensors, where there is a simulation
    pictures  how a report draws its recorded runs
    silent    machines that may get no input in a step: the assumption also holds if all their inputs are absent
    said      record name -> input name, for each input whose records have another name
    spec      the requested name, as on the command line
    unasked   the reason why there is no property, if there is none: the name looked for, the file, and the remedy
    given     of a user's machine: the content of its configuration file
    members   of a composition: what is claimed of each of its machines by itself, by the machine's name, in its own terms
    """

    name: str
    machines: tuple[Machine, ...]
    system: TransitionSystem
    properties: tuple[Property, ...]
    config: BaseModel | None = None
    doc: str = ""
    streams: tuple[Path, ...] = ()
    reported: Reported | None = None
    simulate: Callable[[int], Sequence[Mapping[str, Value | str]]] | None = None
    pictures: tuple[Picture, ...] = ()
    silent: tuple[str, ...] = ()
    said: Mapping[str, str] = field(default_factory=dict)
    spec: str = ""
    unasked: str = ""
    given: Mapping[str, Any] | None = None
    members: Mapping[str, tuple[Property, ...]] = field(default_factory=dict)


Maker = Callable[[BaseModel], Target]


@dataclass(frozen=True, eq=False)
class Entry:
    """A shipped machine: its configuration class, how to make it, and the configurations beside the defaults in which it is
    proved."""

    name: str
    summary: str
    config: type[BaseModel]
    make: Maker
    configurations: Configurations = Configurations()
