"""Records: single measurements of a vehicle's devices, each with the time for which it is valid.

Every record names its channel (the device) and the machine inputs that it sets:

    distance  {end}_{unit}_mm                                       signed, positive towards end A
    pulses    {end}_{unit}_pulses                                   signed
    marker    {end}_marker, {end}_marker_position_mm, ..._accuracy_mm, ..._since_mm
    value     its own name
    truth     the remark truth_mm, which no machine reads

Records are strict: a number in quotes, a fraction, NaN or an unknown field is refused, never converted. A record whose
value is no measurement is `Unusable`: the cycle builder counts it as a fault of its channel.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Annotated, ClassVar, Literal

from pydantic import Field, TypeAdapter

from safeloc.config import Config
from safeloc.language.units import NM_PER_MM
from safeloc.runtime.border import Reason

End = Literal["front", "rear"]
"""The fixed ends of the vehicle: A and B, whichever way it runs."""

Time = Annotated[int, Field(ge=0, description="ms since the recording began")]
Name = Annotated[str, Field(pattern=r"^[A-Za-z_][A-Za-z0-9_.]*$")]


class DistanceRecord(Config):
    """The distance a unit measured since its last record."""

    is_increment: ClassVar[bool] = True
    kind: Literal["distance"] = "distance"
    time_ms: Time
    end: End
    unit: Name
    step_mm: int

    @property
    def channel(self) -> str:
        """The channel: the device that sent the record."""
        return f"{self.end}_{self.unit}"

    def inputs(self) -> Mapping[str, int]:
        """Return the machine inputs it stands for."""
        return {f"{self.channel}_mm": self.step_mm}


class PulseRecord(Config):
    """The pulses a wheel generator counted since its last record; what a pulse is worth is the machine's matter."""

    is_increment: ClassVar[bool] = True
    kind: Literal["pulses"] = "pulses"
    time_ms: Time
    end: End
    unit: Name = "wheel"
    pulses: int

    @property
    def channel(self) -> str:
        """The channel: the device that sent the record."""
        return f"{self.end}_{self.unit}"

    def inputs(self) -> Mapping[str, int]:
        """Return the machine inputs it stands for."""
        return {f"{self.channel}_pulses": self.pulses}


class MarkerRecord(Config):
    """A marker read at one end. Without a position the map does not have it: a foreign marker."""

    is_increment: ClassVar[bool] = False
    kind: Literal["marker"] = "marker"
    time_ms: Time
    end: End
    marker: Annotated[int, Field(ge=0)]
    position_mm: int | None = None
    accuracy_mm: Annotated[int, Field(ge=0)] | None = None
    since_mm: int | None = None

    @property
    def channel(self) -> str:
        """The channel: the device that sent the record."""
        return f"{self.end}_marker"

    def inputs(self) -> Mapping[str, int]:
        """Return the machine inputs it stands for; what is not known is left out."""
        own = {"_position_mm": self.position_mm, "_accuracy_mm": self.accuracy_mm, "_since_mm": self.since_mm}
        known = {f"{self.channel}{name}": value for name, value in own.items() if value is not None}
        return {self.channel: self.marker, **known}


class ValueRecord(Config):
    """Any other input of a machine, by its name."""

    is_increment: ClassVar[bool] = False
    kind: Literal["value"] = "value"
    time_ms: Time
    name: Name
    value: int | bool | str

    @property
    def channel(self) -> str:
        """The channel: the device that sent the record."""
        return self.name

    def inputs(self) -> Mapping[str, int | str]:
        """Return the machine input it stands for."""
        return {self.name: self.value}


class TruthRecord(Config):
    """The true position of end A: known to simulations and survey, never to a machine."""

    is_increment: ClassVar[bool] = False
    kind: Literal["truth"] = "truth"
    time_ms: Time
    position_nm: int

    @property
    def channel(self) -> str:
        """The channel: the device that sent the record."""
        return "truth"

    def inputs(self) -> Mapping[str, int]:
        """Nothing: the truth is a remark."""
        return {}

    def remarks(self) -> Mapping[str, int]:
        """`truth_mm`, rounded down."""
        return {"truth_mm": self.position_nm // NM_PER_MM}


Record = DistanceRecord | PulseRecord | MarkerRecord | ValueRecord | TruthRecord
RECORD: TypeAdapter[Record] = TypeAdapter(Annotated[Record, Field(discriminator="kind")])
"""Checks and reads any record."""


@dataclass(frozen=True)
class Unusable:
    """A record without a usable measurement, with the reason."""

    time_ms: int
    channel: str
    reason: Reason
    detail: str = ""
