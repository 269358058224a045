"""Targets and catalogue entries.

A target is a system with its properties, recordings and pictures; an entry makes one from a configuration.
"""

from __future__ import annotations

import glob
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from enum import Enum
from pathlib import Path
from typing import TYPE_CHECKING, Any, Generic, Literal, TypeVar

from pydantic import BaseModel

from safeloc.config import Configurations, figures
from safeloc.errors import InputError
from safeloc.language.machine import Machine
from safeloc.language.renamed import hint
from safeloc.language.spec import Property
from safeloc.language.system import TransitionSystem, lower
from safeloc.reported import Reported
from safeloc.simulated import Steps

if TYPE_CHECKING:
    from safeloc.railway.pictures import Picture

AnyConfig = TypeVar("AnyConfig", bound=BaseModel)
Simulate = Callable[[int], Steps]
"""A simulation: seed -> steps of simulated sensors, or a SimulatedRun, which has first values as well."""
MODELS = Path(__file__).parent / "models"
"""The folders of the machines that ship; in the folder of each its recordings, witnesses and reasons."""


@dataclass(frozen=True)
class Hazard:
    """A wrong-side failure of a target, beside a wrong interval: the top event of its fault tree (EN 50129).

    text    the hazard as a sentence, such as "a section is reported clear with an axle in it"
    claims  the names of the properties whose breach is the hazard; `*` stands for any letters
    """

    text: str
    claims: tuple[str, ...]


@dataclass(frozen=True, eq=False)
class Target:
    """A system with its properties, recordings, simulation and pictures: one item under verification.

    streams   recorded step streams that ship with it; `verify` replays them
    other_figures  the streams were recorded with other figures than those of `config`: one that the machine cannot take is left out
    reported  the outputs that form the reported interval; None for a machine that reports none
    simulate  simulation, if there is one: seed -> steps of simulated sensors
    pictures  drawings of its recorded runs in a report
    silent    machines that may get no input in a step: the assumption also holds if all their inputs are absent
    input_of_record  record name -> input name, for each input whose records have another name
    spec      the requested name, as on the command line
    unasked   the reason why there is no property, if there is none: the name looked for, the file, and the remedy
    given     of a user's machine: the content of its configuration file
    witnesses file of short runs to events that a search would otherwise have to find (safeloc.proof.verification.witness_files)
    configuration  name of the declared configuration in which it was made; nothing for the defaults
    config_file    file of its configuration, if it was made with one
    sections  of a composition: the part of the configuration with the figures of a machine, by the machine's name, where it has another
              name; laws name figures of that part
    members   of a composition: the properties of each machine alone, in its own variables, by the machine's name
    hazard    the hazard, for a target that does not report an interval, or not only that
    """

    name: str
    machines: tuple[Machine, ...]
    system: TransitionSystem
    properties: tuple[Property, ...]
    config: BaseModel | None = None
    doc: str = ""
    streams: tuple[Path, ...] = ()
    other_figures: bool = field(default=False, kw_only=True)
    reported: Reported | None = None
    simulate: Simulate | None = None
    pictures: tuple[Picture, ...] = ()
    silent: tuple[str, ...] = ()
    input_of_record: Mapping[str, str] = field(default_factory=dict)
    spec: str = ""
    unasked: str = ""
    given: Mapping[str, Any] | None = None
    witnesses: Path | None = None
    configuration: str = ""
    config_file: Path | None = None
    members: Mapping[str, tuple[Property, ...]] = field(default_factory=dict)
    sections: Mapping[str, str] = field(default_factory=dict)
    hazard: Hazard | None = None

    @property
    def figures(self) -> list[dict[str, str]]:
        """Name, value, unit and source of every figure of the configuration; none for a target without one."""
        return [] if self.config is None else list(figures(self.config))


class Family(Enum):
    """Families of machines, by their means of localization. `safeloc list` names them in this order, and README.md has
    a row for each.
    """

    ODOMETRY = "odometry"
    MARKERS = "markers"
    FIBRE = "fibre"
    SATELLITES = "satellites"
    RECEIVER = "receiver"
    LOCALIZER = "localizer"


@dataclass(frozen=True)
class Pair:
    """Two figures of a configuration of which one gains what the other gives up: a front of `safeloc margins --pairs`.

    name    in the words of the field
    first   the figure that moves, with its direction, such as "speed_error_mm_s:down"
    second  the figure whose limit is searched beside each value of the first, with its direction
    where   world: both move in the world alone; design: in machine, world and claims alike
    """

    name: str
    first: str
    second: str
    where: Literal["world", "design"] = "world"


LAST = 1000
"""The position of a machine that states none."""


@dataclass(frozen=True, eq=False)
class Entry(Generic[AnyConfig]):
    """A machine of the catalogue, declared in `ENTRIES` of a `models/<folder>/target.py`.

    config          the class of its configuration; `safeloc verify` proves the machine with its defaults
    maker           makes the target from a configuration
    place           its position within its family in `safeloc list`; machines of equal position are sorted by name
    simulates       its target has a simulation with the defaults; stated here, so that a list of those machines makes none of them
    configurations  further configurations in which it is proved
    no_interval     the reason why it reports no interval; "" for a machine that reports one
    silent          machines of the target that may get no input in a step. Some inputs cannot be absent: truth values, members
                    of an enumeration, numbers that always come with them. If their device is silent they get a neutral value:
                    false, the first member, the number nearest to zero. For each machine named here
                    tests/runtime/embedding/test_silence.py proves that a step which obeys the assumption still obeys it
                    without all inputs of the machine, so every proof covers the silent step. A machine not named here stops
                    in such a step (an axle that was not reported is an axle lost)
    members         of a composition: the names of its machines with its defaults. The register of assumptions looks here for a
                    machine that ships in compositions alone
    records_of      record name -> input name, for inputs whose records have another name, such as that of the
                    odometer's unit (docs/records.md)
    hazard          the hazard, for a machine that does not report an interval, or not only that; where it depends on the
                    configuration, the target states it
    pairs           pairs of figures whose front `safeloc margins --pairs` finds
    pairs_of        of a composition that declares none: the machines whose pairs are its own, since their figures are among its
    folder          its folder of `models/`; `safeloc.shipped_machines` sets it when it finds the entry
    """

    name: str
    summary: str
    config: type[AnyConfig]
    maker: Callable[[AnyConfig], Target]
    family: Family
    place: int = LAST
    simulates: bool = False
    configurations: Configurations = Configurations()
    no_interval: str = ""
    hazard: Hazard | None = None
    silent: tuple[str, ...] = ()
    members: tuple[str, ...] = ()
    records_of: Mapping[str, str] = field(default_factory=dict)
    pairs: tuple[Pair, ...] = ()
    pairs_of: tuple[str, ...] = ()
    folder: str = ""

    def make(self, config: AnyConfig) -> Target:
        """Make the target for a configuration. InputError for a configuration of another machine."""
        if not isinstance(config, self.config):
            raise InputError(f"{self.name} takes a {self.config.__name__}, got {type(config).__name__}.")
        return self.for_hosts(self.maker(config))

    @property
    def of_other_kinds(self) -> dict[str, BaseModel]:
        """The named configurations of a class of their own: their figures have defaults and sources of their own."""
        return {name: config for name, config in self.configurations.named.items() if type(config) is not self.config}

    def for_hosts(self, target: Target) -> Target:
        """Return the target with the data that a host needs, limited to the machines and inputs of its configuration."""
        names = {machine.name for machine in target.machines}
        inputs = {var.name for var in target.system.inputs}
        silent = tuple(name for name in self.silent if name in names)
        input_of_record = {record: name for record, name in self.records_of.items() if name in inputs}
        return replace(
            target,
            silent=silent,
            input_of_record=input_of_record,
            witnesses=witnesses_of(self.name),
            hazard=target.hazard or self.hazard,
        )


def recorded(name: str) -> tuple[Path, ...]:
    """Return the recordings that ship for a machine: `recordings/NAME-what-happens.jsonl.gz` in its folder of `models/`."""
    return tuple(sorted(MODELS.glob(f"*/recordings/{name}-*.jsonl.gz")))


def find_recording(target: Target, name: Path) -> Path:
    """Return an existing file, or the recording of that name that ships with the target. InputError names those that ship."""
    if name.exists():
        return name
    known = {recording_name(path): path for path in target.streams}
    if str(name) in known:
        return known[str(name)]
    if len(name.parts) == 1 and any(MODELS.glob(f"*/recordings/{glob.escape(name.name)}.jsonl.gz")):
        raise InputError(
            f"{name}: a recording of another machine, {str(name).partition('-')[0]}; {target.name} cannot take it."
        )
    shipped = f"shipped with {target.name} are {', '.join(known)}" if known else f"none ships with {target.name}"
    raise InputError(f"{name}: no such file, and no recording of that name; {shipped}.{hint(str(name), known)}")


def recording_name(path: Path) -> str:
    """Return the name of a recording: that of its file without suffixes."""
    return path.name.partition(".")[0]


def witnesses_of(name: str) -> Path | None:
    """Return the file of witnesses that ships for a machine; None if there is none."""
    return beside(name, "witnesses.jsonl.xz")


def beside(name: str, kind: str) -> Path | None:
    """Return the file `NAME.KIND` of a machine that ships, in its folder of `models/`; None if there is none."""
    return next(iter(MODELS.glob(f"*/{name}.{kind}")), None)


def single(
    machine: Machine,
    properties: Sequence[Property],
    config: BaseModel,
    *,
    reported: Reported | None = None,
    simulate: Simulate | None = None,
    pictures: tuple[Picture, ...] = (),
) -> Target:
    """Make the target of a single machine, with the recordings that ship under its name."""
    return Target(
        machine.name, (machine,), lower(machine), tuple(properties), config, machine.doc, recorded(machine.name),
        reported, simulate, pictures,
    )  # fmt: skip
