"""The areas of a partition, and the reports of vehicles that they listen to."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import replace
from functools import partial

from safeloc.errors import InputError
from safeloc.railway.trackside.area_vehicle import AreaVehicle
from safeloc.railway.trackside.seen import Seen, read_report
from safeloc.railway.trackside.trains import Trains
from safeloc.railway.trackside.wiring import Wiring
from safeloc.runtime.embedding import Program
from safeloc.runtime.outside import refusal
from safeloc.runtime.service.broker.codes import Codes
from safeloc.runtime.service.broker.port import Beside
from safeloc.runtime.service.broker.topics import Topics, partition_of
from safeloc.runtime.service.clock_lag import Pace
from safeloc.runtime.service.fleet import Fleet, FleetSettings
from safeloc.runtime.service.lines import Line
from safeloc.runtime.service.messages import Message, shortened
from safeloc.runtime.service.vehicle import MakeController, Output, Vehicle

_NO_CODE = "its code does not fit: it was changed, is another's, or was made without the key"


class AreaFleet(Fleet):
    """Areas by name. A line is one of detection, for one cycle of its area; lines and reports have a code (`codes`).

    topics  those of the areas
    """

    def __init__(self, program: Program, settings: FleetSettings, wiring: Wiring, codes: Codes, topics: Topics) -> None:
        self._wiring, self._codes, self._topics = wiring, codes, topics
        self._topic_of = _topics(wiring)
        self._areas_of: Mapping[str, list[str]] = {vehicle: [] for vehicle in wiring.file.vehicles}
        for area in wiring.file.areas:
            for vehicle in wiring.vehicles_of(area):
                self._areas_of[vehicle].append(area)
        any_area = next(iter(wiring.file.areas.values()))
        super().__init__(program, replace(settings, inputs=True, numbered=True, first=any_area.first))

    def handle(self, origin: str, line: Line, *, from_start: bool, only: str | None = None) -> list[Output]:
        """Handle a line of detection; without a code that fits it counts as one that cannot be read."""
        if not line.flaw:
            text = self._codes.opened(self._topics.record(origin), line.text)
            line = line._replace(text=b"", flaw=_NO_CODE) if text is None else line._replace(text=text)
        return super().handle(origin, line, from_start=from_start, only=only)

    def told(self, about: str, payload: bytes) -> list[Output]:
        """Hand the report of a vehicle to the areas that it may come into."""
        areas = [name for name in self._areas_of.get(about, ()) if name in self.vehicles]
        seen = self._read(about, payload) if areas else ""
        return [one for name in areas for one in self._heard(name, about, seen)]

    def _heard(self, area: str, about: str, seen: Seen | str) -> list[Output]:
        vehicle = self.vehicles[area]
        assert isinstance(vehicle, AreaVehicle)
        return self._of_one(vehicle, partial(vehicle.hear, about, seen))

    def _read(self, about: str, payload: bytes) -> Seen | str:
        text = self._codes.opened(self._topic_of[about], payload)
        if text is None:
            return _NO_CODE
        try:
            return read_report(about, text, self._wiring.file.vehicles[about])
        except Exception as error:  # the rule of every border (safeloc.runtime.outside)
            return shortened(refusal(error))

    def _admitted(self, name: str, origin: str, line: Line, message: Message, from_start: bool) -> list[Output]:
        if name not in self._wiring.file.areas:
            why = f"no area of this name in {self._wiring.name}"
            return [{"vehicle": name, "event": "refused", "line": line.number, "reason": why}]
        return super()._admitted(name, origin, line, message, from_start)

    def _settings_of(self, name: str) -> FleetSettings:
        if name not in self._wiring.file.areas:
            raise InputError(
                f"area {name} of the snapshot is not in {self._wiring.name}; put it back, or name a new folder."
            )
        return replace(self.settings, first=self._wiring.file.areas[name].first)

    def _vehicle(self, name: str, make: MakeController, pace: Pace, *, from_start: bool) -> Vehicle:
        file = self._wiring.file
        vehicles = {vehicle: file.vehicles[vehicle] for vehicle in self._wiring.vehicles_of(name)}
        trains = Trains(file.areas[name], vehicles, self._wiring.config.area, file.clock_error_ms, file.shortest_mm)
        return AreaVehicle(name, make, pace, trains, from_start=from_start)


class VehicleReports(Beside):
    """The last reports of the vehicles that the areas of a partition listen to.

    partitions  parts into which the areas are divided, as the vehicles of their fleet are
    """

    def __init__(self, wiring: Wiring, partitions: int) -> None:
        self._topic_of = _topics(wiring)
        self._about = {topic: vehicle for vehicle, topic in self._topic_of.items()}
        self._wiring, self._partitions = wiring, partitions

    def topics(self, partition: int) -> Iterable[str]:
        """Return the topics of all vehicles that may come into an area of this partition."""
        areas = [area for area in self._wiring.file.areas if partition_of(area, self._partitions) == partition]
        vehicles = dict.fromkeys(vehicle for area in areas for vehicle in self._wiring.vehicles_of(area))
        return [self._topic_of[vehicle] for vehicle in vehicles]

    def about(self, topic: str) -> str | None:
        """Return the vehicle whose report a message of this topic is."""
        return self._about.get(topic)


def _topics(wiring: Wiring) -> Mapping[str, str]:
    """Return the topic of each vehicle's reports."""
    topics = Topics(wiring.file.fleet, wiring.file.partitions)
    return {one: topics.report(partition_of(one, topics.partitions), one) for one in wiring.file.vehicles}
