"""Records: single measurements of a vehicle's devices, each with the time to which it refers.

Every record names its channel (the device) and the machine inputs that it sets:

    distance  {end}_{unit}_mm                                       signed, positive towards end A
    pulses    {end}_{unit}_pulses                                   signed
    marker    {end}_marker, {end}_marker_position_mm, ..._accuracy_mm, ..._since_mm
    value     its own name
    truth     none; it gives the remark truth_mm

Records are strict: a number in quotes, a fraction, NaN or an unknown field is refused, never converted. A record with an
invalid measurement is `Unusable`: the cycle builder counts it as a fault of its channel.
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
"""The fixed ends of the vehicle: front is end A, rear is end B, whichever way it runs."""

_Time = Annotated[int, Field(ge=0, description="ms since the recording began")]
Name = Annotated[str, Field(pattern=r"^[A-Za-z_][A-Za-z0-9_.]*$")]


class DistanceRecord(Config):
    """The distance that a unit measured since its last record."""

    is_increment: ClassVar[bool] = True
    kind: Literal["distance"] = "distance"
    time_ms: _Time
    end: End
    unit: Name
    distance_mm: Annotated[int, Field(description="distance run in this cycle, positive towards end A (front)")]

    @property
    def channel(self) -> str:
        """The channel: the device that sent the record."""
        return f"{self.end}_{self.unit}"

    def inputs(self) -> Mapping[str, int]:
        """Return the machine inputs that it sets."""
        return {f"{self.channel}_mm": self.distance_mm}


class PulseRecord(Config):
    """The pulses that a wheel generator counted since its last record; the machine knows the distance per pulse."""

    is_increment: ClassVar[bool] = True
    kind: Literal["pulses"] = "pulses"
    time_ms: _Time
    end: End
    unit: Name = "wheel"
    pulses: Annotated[int, Field(description="pulses counted in this cycle, positive towards end A (front)")]

    @property
    def channel(self) -> str:
        """The channel: the device that sent the record."""
        return f"{self.end}_{self.unit}"

    def inputs(self) -> Mapping[str, int]:
        """Return the machine inputs that it sets."""
        return {f"{self.channel}_pulses": self.pulses}


class MarkerRecord(Config):
    """A marker read at one end. Without a position it is a foreign marker: the map does not have it."""

    is_increment: ClassVar[bool] = False
    kind: Literal["marker"] = "marker"
    time_ms: _Time
    end: End
    marker: Annotated[int, Field(ge=0, description="identity of the marker that the reader at this end read")]
    position_mm: Annotated[
        int | None, Field(description="place of the marker on the line's map; absent: the map does not have it")
    ] = None
    accuracy_mm: Annotated[
        Annotated[int, Field(ge=0)] | None,
        Field(description="largest distance between the marker and this place; absent: the configured one"),
    ] = None
    since_mm: Annotated[
        int | None,
        Field(description="distance run since the reader stood over the marker, positive towards end A (front)"),
    ] = None

    @property
    def channel(self) -> str:
        """The channel: the device that sent the record."""
        return f"{self.end}_marker"

    def inputs(self) -> Mapping[str, int]:
        """Return the machine inputs that it sets; unknown ones are left out."""
        values = {"_position_mm": self.position_mm, "_accuracy_mm": self.accuracy_mm, "_since_mm": self.since_mm}
        known = {f"{self.channel}{name}": value for name, value in values.items() if value is not None}
        return {self.channel: self.marker, **known}


class ValueRecord(Config):
    """Any other input of a machine, by its name."""

    is_increment: ClassVar[bool] = False
    kind: Literal["value"] = "value"
    time_ms: _Time
    name: Name
    value: int | bool | str

    @property
    def channel(self) -> str:
        """The channel: the device that sent the record."""
        return self.name

    def inputs(self) -> Mapping[str, int | str]:
        """Return the machine input that it sets."""
        return {self.name: self.value}


class TruthRecord(Config):
    """The true position of end A: known to simulations and survey, never to a machine."""

    is_increment: ClassVar[bool] = False
    kind: Literal["truth"] = "truth"
    time_ms: _Time
    position_nm: int

    @property
    def channel(self) -> str:
        """The channel: the device that sent the record."""
        return "truth"

    def inputs(self) -> Mapping[str, int]:
        """Return no inputs: no machine reads the truth."""
        return {}

    def remarks(self) -> Mapping[str, int]:
        """Return `truth_mm`, rounded down."""
        return {"truth_mm": self.position_nm // NM_PER_MM}


Record = DistanceRecord | PulseRecord | MarkerRecord | ValueRecord | TruthRecord
RECORD: TypeAdapter[Record] = TypeAdapter(Annotated[Record, Field(discriminator="kind")])
"""Validator of any record."""


@dataclass(frozen=True)
class Unusable:
    """A record without a usable measurement, with the reason."""

    time_ms: int
    channel: str
    reason: Reason
    detail: str = ""
