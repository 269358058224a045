"""The declaration of a campaign: a TOML file, refused with file and line for whatever is wrong in it."""

from __future__ import annotations

import json
import tomllib
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Literal, get_args

from pydantic import Field, ValidationError, model_validator

from safeloc.campaign.distributions import Distribution
from safeloc.config import Config
from safeloc.errors import InputError
from safeloc.runtime.flaws import Flaw, FlawsError
from safeloc.runtime.outside import read_text, reading
from safeloc.runtime.toml_place import line_of, refusal

LARGEST_TEXT = 1_000_000
Question = Literal["containment", "availability", "width", "time to withdraw", "reaction"]
QUESTIONS: tuple[Question, ...] = get_args(Question)
_WEIGHT = 1e-9
"""How far weights may sum beside 1."""

Weight = Annotated[float, Field(ge=0, le=1)]
Figures = Mapping[str, Distribution]


class LineShare(Config):
    """A line that vehicles drive: its name or file, its routes (all of them without any), and the share of vehicles on it."""

    line: str
    routes: tuple[str, ...] = ()
    weight: Weight = 1.0


class VehicleShare(Config):
    """A kind of vehicle: its name or file, and the share of vehicles that are of it."""

    vehicle: str
    weight: Weight = 1.0


class FaultDraw(Config):
    """A fault that every vehicle of a situation has, in the words of the simulation; its time and figures are drawn.

    lasts  how long; without it, to the end
    tilt   in place of `begin`, `lasts` or figures, for the tilted vehicles of the situation
    """

    kind: str
    where: str | int = ""
    begin: Distribution | None = None
    lasts: Distribution | None = None
    figures: Figures = Field(default_factory=dict)
    tilt: Figures = Field(default_factory=dict)

    @property
    def drawn(self) -> dict[str, Distribution]:
        """Return what is drawn of the fault, by name: its times, then its figures."""
        times = {name: one for name, one in (("begin", self.begin), ("lasts", self.lasts)) if one is not None}
        return {**times, **self.figures}


class Situation(Config):
    """A situation: what happens to its vehicles.

    weight    the share of vehicles in operation that are in it
    vehicles  how many run, on each line and of each kind of vehicle
    figures   of the sensors, in place of those of the campaign
    tilt      in place of figures, for the tilted vehicles
    tilted    the share of vehicles that are tilted, where anything is: importance sampling (safeloc.campaign.tilting)
    """

    name: str = Field(min_length=1)
    weight: Weight
    vehicles: int = Field(ge=1, le=1_000_000_000)
    figures: Figures = Field(default_factory=dict)
    faults: tuple[FaultDraw, ...] = ()
    tilt: Figures = Field(default_factory=dict)
    tilted: float = Field(default=0.5, gt=0, lt=1)

    @property
    def greatest_weight(self) -> float | None:
        """The greatest weight of a vehicle; None where nothing is tilted and each has weight 1."""
        return 1 / (1 - self.tilted) if self.tilt or any(one.tilt for one in self.faults) else None


class Declaration(Config):
    """The declaration of a campaign.

    machine         a machine of the catalogue, or the address of one of your own
    cycles          cycles of each vehicle
    shard_vehicles  vehicles of a shard: what is run, kept and, after a loss, run again as one
    confidence      of every interval
    alert_limit_mm  error beyond which a wrong interval is called hazardous in the picture; without it the machine's tolerance
    place_step_mm   length of the stretches in which the width is shown along the line
    kept            streams that are kept of each kind: wrong intervals with the laws kept, and broken; smallest margins
    """

    machine: str
    cycles: int = Field(ge=1, le=1_000_000)
    seed: int = Field(default=0, ge=0)
    shard_vehicles: int = Field(default=250, ge=1, le=100_000)
    confidence: float = Field(default=0.95, gt=0.5, lt=1)
    questions: tuple[Question, ...] = Field(default=QUESTIONS, min_length=1)
    alert_limit_mm: int | None = Field(default=None, ge=1)
    place_step_mm: int = Field(default=50_000, ge=1_000)
    kept: int = Field(default=3, ge=0, le=1_000)
    trust_first: bool = False
    figures: Figures = Field(default_factory=dict)
    lines: tuple[LineShare, ...] = ()
    vehicles: tuple[VehicleShare, ...] = ()
    situations: tuple[Situation, ...] = Field(min_length=1)

    @model_validator(mode="after")
    def _weights_sum_to_one(self) -> Declaration:
        for what, shares in (("lines", self.lines), ("vehicles", self.vehicles), ("situations", self.situations)):
            total = sum(one.weight for one in shares)
            if shares and abs(total - 1) > _WEIGHT:
                told = f"the weights of the {what} sum to {total:g}; they must sum to 1"
                raise FlawsError([Flaw(told, [(what, number, "weight") for number in range(len(shares))])])
        return self

    @model_validator(mode="after")
    def _names_differ(self) -> Declaration:
        names = [one.name for one in self.situations]
        for number, name in enumerate(names):
            if name in names[:number]:
                told = f"two situations have one name, {name!r}; each needs a name of its own"
                raise FlawsError([Flaw(told, [("situations", one, "name") for one in (number, names.index(name))])])
        return self


@dataclass(frozen=True)
class Stratum:
    """Vehicles of one kind on one line in one situation.

    weight  the share of vehicles in operation that it stands for
    """

    number: int
    situation: int
    line: int | None
    vehicle: int | None
    weight: float
    vehicles: int


@dataclass(frozen=True)
class Shard:
    """A part of a stratum that is run as one: vehicles `first` up to, not including, `end` of it."""

    number: int
    stratum: Stratum
    first: int
    end: int


@dataclass(frozen=True)
class Campaign:
    """A declared campaign with its text, which holds all that a shard needs beside the lines and vehicles that it names."""

    declared: Declaration
    text: str
    name: str

    @property
    def strata(self) -> list[Stratum]:
        """All strata, in the order of the file: situations, lines, kinds of vehicle."""
        return list(self._strata())

    def _strata(self) -> Iterator[Stratum]:
        number = 0
        for index, situation in enumerate(self.declared.situations):
            for line in range(len(self.declared.lines)) or (None,):
                for vehicle in range(len(self.declared.vehicles)) or (None,):
                    shares = situation.weight
                    shares *= 1.0 if line is None else self.declared.lines[line].weight
                    shares *= 1.0 if vehicle is None else self.declared.vehicles[vehicle].weight
                    yield Stratum(number, index, line, vehicle, shares, situation.vehicles)
                    number += 1

    @property
    def shards(self) -> list[Shard]:
        """All shards by number."""
        found: list[Shard] = []
        size = self.declared.shard_vehicles
        for stratum in self.strata:
            for first in range(0, stratum.vehicles, size):
                found.append(Shard(len(found), stratum, first, min(first + size, stratum.vehicles)))
        return found

    def situation_of(self, stratum: Stratum) -> Situation:
        """Return the situation of a stratum."""
        return self.declared.situations[stratum.situation]

    def words_of(self, stratum: Stratum) -> str:
        """Return situation, line and vehicle of a stratum in words."""
        line = "" if stratum.line is None else f", line {self.declared.lines[stratum.line].line}"
        vehicle = "" if stratum.vehicle is None else f", {self.declared.vehicles[stratum.vehicle].vehicle}"
        return f"{self.situation_of(stratum).name}{line}{vehicle}"

    def figures_of(self, stratum: Stratum) -> dict[str, tuple[Distribution, Sequence[str | int]]]:
        """Return the declared figures of a stratum, each with its place in the file."""
        found: dict[str, tuple[Distribution, Sequence[str | int]]] = {}
        for name, one in self.declared.figures.items():
            found[name] = one, ("figures", name)
        for name, one in self.situation_of(stratum).figures.items():
            found[name] = one, ("situations", stratum.situation, "figures", name)
        return found

    def refuse(self, place: Sequence[str | int], why: str) -> InputError:
        """Return the error that refuses what stands at a place of the file."""
        return InputError(f"{self.name}:{line_of(self.text, place)}: {'.'.join(map(str, place))}: {why}")


def load_campaign(path: Path) -> Campaign:
    """Read a campaign. InputError with file, line and key for anything wrong in it."""
    with reading(path):
        return parse_campaign(read_text(path, LARGEST_TEXT), str(path))


def parse_campaign(text: str, name: str) -> Campaign:
    """Return the campaign of a text; `name` stands for it in messages. InputError as in `load_campaign`."""
    try:
        data = tomllib.loads(text)
    except tomllib.TOMLDecodeError as error:
        raise InputError(f"{name}: not TOML: {error}.") from error
    except RecursionError as error:
        raise InputError(f"{name}: nested too deeply to be a campaign.") from error
    try:
        declared = Declaration.model_validate_json(json.dumps(data, allow_nan=True, default=str))
    except ValidationError as error:
        raise InputError(refusal(error, lambda place: f"{name}:{line_of(text, place)}")) from error
    return Campaign(declared, text, name)
