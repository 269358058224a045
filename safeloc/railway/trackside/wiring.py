"""The file that ties areas to vehicles: places of each area, and what of a vehicle its report does not say.

A report says where end A of the vehicle is. How long the train is, which way end A faces, and by which output of its machine
integrity is confirmed, stands here.
"""

from __future__ import annotations

import json
import tomllib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Annotated

from pydantic import Field, ValidationError

from safeloc.config import Config
from safeloc.errors import InputError
from safeloc.models.sections import SectionsConfig
from safeloc.railway.trackside.division import Stretch, division_flaws
from safeloc.runtime.outside import read_text, reading
from safeloc.runtime.toml_place import line_of, refusal

_MOST_BYTES = 10_000_000
_Name = Annotated[str, Field(pattern=r"^[A-Za-z0-9_.:-]{1,64}$")]


class VehicleWiring(Config):
    """Facts of a vehicle that its report does not say.

    length_mm      most that the train may be long, from end A to its far end
    faces_upwards  end A is the end towards growing places; it faces the same way all the time
    whole          output of its machine that is true while the train is confirmed to be whole; without one it never is
    """

    length_mm: int = Field(ge=1_000, le=5_000_000)
    faces_upwards: bool
    whole: str | None = Field(
        default=None, max_length=200, pattern=r"^[A-Za-z_][A-Za-z0-9_]*(\.[A-Za-z_][A-Za-z0-9_]*)*$"
    )


class AreaWiring(Config):
    """An area: its ends, its virtual sections, the detection sections inside it, and the vehicles that may come; all if none is named.

    without_section_mm  stretches that no virtual section covers on purpose; a gap that is not named is refused
    """

    low_end_mm: int
    high_end_mm: int
    sections_mm: tuple[Stretch, ...]
    without_section_mm: tuple[Stretch, ...] = ()
    inner_mm: tuple[Stretch, ...] = ()
    vehicles: tuple[_Name, ...] | None = None

    @property
    def first(self) -> Mapping[str, int]:
        """Return the first values of the machine `sections` that this area chooses."""
        found = {"area.low_end_mm": self.low_end_mm, "area.high_end_mm": self.high_end_mm}
        for number, (start, end) in enumerate(self.sections_mm, 1):
            found |= {f"section_{number}.from_mm": start, f"section_{number}.to_mm": end}
        for number, (start, end) in enumerate(self.inner_mm, 1):
            found |= {f"area.inner_{number}_from_mm": start, f"area.inner_{number}_to_mm": end}
        return found


class WiringFile(Config):
    """The file of `--trackside`.

    fleet           prefix below which the vehicles' reports are
    partitions      parts into which that fleet is divided
    clock_error_ms  most by which the clock of a vehicle and that of an area's detection differ
    shortest_mm     no vehicle that may come in is shorter: none fits between an end and a train that is so near
    """

    fleet: str = Field(pattern=r"^[A-Za-z0-9_.-]{1,64}(/[A-Za-z0-9_.-]{1,64}){0,7}$")
    partitions: int = Field(default=16, ge=1, le=1_024)
    clock_error_ms: int = Field(ge=0, le=60_000)
    shortest_mm: int = Field(default=0, ge=0, le=100_000)
    vehicles: dict[_Name, VehicleWiring]
    areas: dict[_Name, AreaWiring] = Field(min_length=1)


@dataclass(frozen=True)
class Wiring:
    """A wiring file that fits the machine's configuration."""

    file: WiringFile
    config: SectionsConfig
    name: str
    _text: str = field(repr=False)

    def vehicles_of(self, area: str) -> Sequence[str]:
        """Return the vehicles that may come into an area."""
        named = self.file.areas[area].vehicles
        return tuple(self.file.vehicles) if named is None else named

    def refuse(self, place: Sequence[str | int], why: str) -> InputError:
        """Return the error that refuses what stands at a place of the file."""
        return InputError(f"{self.name}:{line_of(self._text, place)}: {'.'.join(map(str, place))}: {why}")


def load_wiring(path: Path, config: SectionsConfig) -> Wiring:
    """Read a wiring file. InputError with file, line and key for anything wrong in it, or if it does not fit the configuration."""
    with reading(path):
        return _parsed(read_text(path, _MOST_BYTES), str(path), config)


def _parsed(text: str, name: str, config: SectionsConfig) -> Wiring:
    """Return the wiring of a text; `name` stands for it in messages. InputError as in `load_wiring`."""
    try:
        data = tomllib.loads(text)
    except tomllib.TOMLDecodeError as error:
        raise InputError(f"{name}: not TOML: {error}.") from error
    except RecursionError as error:
        raise InputError(f"{name}: nested too deeply to be a wiring of areas.") from error
    try:
        file = WiringFile.model_validate_json(json.dumps(data, allow_nan=True, default=str))
    except ValidationError as error:
        raise InputError(refusal(error, lambda place: f"{name}:{line_of(text, place)}")) from error
    made = Wiring(file, config, name, text)
    _require_clocks(made)
    for area in file.areas:
        _require_area(made, area)
    return made


def _require_clocks(wiring: Wiring) -> None:
    area = wiring.config.area
    if area.borders != "occupancy":
        raise InputError(
            'the configuration has area.borders = "counted": counters do not know which vehicle they count, so no report can '
            'be given to a slot; set area.borders = "occupancy".'
        )
    if wiring.file.clock_error_ms >= area.report_age_limit_ms:
        raise wiring.refuse(
            ("clock_error_ms",),
            f"{wiring.file.clock_error_ms} ms is no less than area.report_age_limit_ms {area.report_age_limit_ms}: every report "
            "would be too old; let the clocks agree better, or raise the limit.",
        )


def _require_area(wiring: Wiring, name: str) -> None:
    area, config = wiring.file.areas[name], wiring.config
    place = ("areas", name)
    most = config.area.limit_mm - config.area.reach.entry_mm
    if not -most <= area.low_end_mm < area.high_end_mm <= most:
        raise wiring.refuse(
            (*place, "low_end_mm"), f"the ends have to be in order, and within {most} mm of 0 (area.limit_mm)."
        )
    counts = (("sections_mm", len(area.sections_mm), config.sections, "sections"),
              ("inner_mm", len(area.inner_mm), config.area.inner_detection, "area.inner_detection"))  # fmt: skip
    for key, given, wanted, figure in counts:
        if given != wanted:
            raise wiring.refuse((*place, key), f"{given} stretches, but the configuration has {figure} = {wanted}.")
    for key, stretches in (
        ("sections_mm", area.sections_mm),
        ("without_section_mm", area.without_section_mm),
        ("inner_mm", area.inner_mm),
    ):
        for number, (start, end) in enumerate(stretches):
            if not area.low_end_mm <= start < end <= area.high_end_mm:
                raise wiring.refuse((*place, key, number), f"[{start}, {end}] is no stretch within the area.")
    flaw = next(division_flaws(area.low_end_mm, area.high_end_mm, area.sections_mm, area.without_section_mm), None)
    if flaw is not None:
        raise wiring.refuse((*place, flaw.key, flaw.number), flaw.why)
    for vehicle in area.vehicles or ():
        if (area.vehicles or ()).count(vehicle) > 1:
            raise wiring.refuse((*place, "vehicles"), f"{vehicle} is named twice.")
        if vehicle not in wiring.file.vehicles:
            raise wiring.refuse((*place, "vehicles"), f"{vehicle} is not among the vehicles of this file.")
