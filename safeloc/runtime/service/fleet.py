"""All vehicles of the process: assignment of lines to vehicles, and the memory of all vehicles together."""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from functools import partial
from typing import Any, assert_never

from safeloc.errors import SnapshotError
from safeloc.language.nodes import Value
from safeloc.runtime.embedding import Controller, Program
from safeloc.runtime.service.by_records import RecordsVehicle
from safeloc.runtime.service.by_steps import StepsVehicle
from safeloc.runtime.service.clock_lag import LONGEST_GAP_MS, Pace
from safeloc.runtime.service.lines import Line
from safeloc.runtime.service.messages import (
    ALONE,
    CycleEnd,
    Header,
    Message,
    Reader,
    RecordLine,
    Refused,
    Step,
    shortened,
)
from safeloc.runtime.service.vehicle import MakeController, Output, Vehicle

_MOST_VEHICLES = 1_000


@dataclass(frozen=True)
class FleetSettings:
    """Settings for reading lines and bridging gaps.

    inputs          lines are inputs of steps instead of records
    numbered        every line needs a number, since lines may be lost unnoticed
    longest_gap_ms  longest silence that is bridged by cycles without inputs; after a longer one a vehicle restarts
    most_vehicles   most vehicles of the process; a new one replaces one that is silent and reports no position
    most_of_a_peer  most vehicles for which one peer may send; None: no limit of its own
    assumptions     check the observable laws of the worlds in each cycle
    """

    period_ms: int
    inputs: bool = False
    numbered: bool = False
    longest_gap_ms: int = LONGEST_GAP_MS
    most_vehicles: int = _MOST_VEHICLES
    most_of_a_peer: int | None = None
    expected: Mapping[str, int] = field(default_factory=dict)
    first: Mapping[str, Value] = field(default_factory=dict)
    assumptions: bool = True


@dataclass
class _Tally:
    """Counts since the start of the process."""

    lines: int = 0
    refused: int = 0
    cycles: int = 0
    rejections: int = 0
    breaches: int = 0
    failed: int = 0


_Answer = Callable[[], list[Output]]


class Fleet:
    """Vehicles by name. Origins are the peers that send lines; a vehicle belongs to the one that sent its last line.

    own         vehicle -> its program, if that is not the common one
    clock       wall clock in seconds, to measure silence
    withdrew    a position was withdrawn; set here, cleared by the loop after a snapshot
    by_clock    something happened that does not follow from the lines alone; set and cleared likewise
    on_failure  called with the vehicle and the exception after an unexpected exception
    on_line     called with the vehicle and the number of each of its lines, before it is handled

    InputError if no controller can be made with these settings.
    """

    def __init__(
        self,
        program: Program,
        settings: FleetSettings,
        own: Mapping[str, Program] | None = None,
        clock: Callable[[], float] = time.monotonic,
    ) -> None:
        self.settings, self.tally = settings, _Tally()
        self.withdrew = self.by_clock = False
        self.on_failure: Callable[[str, Exception], None] = lambda _vehicle, _error: None
        self.on_line: Callable[[str, int | None], None] | None = None
        self.vehicles: dict[str, Vehicle] = {}
        self._clock = clock
        self._last_line_at: dict[str, float] = {}
        self.origins: dict[str, str] = {}
        self._flawed: set[str] = set()
        self._program, self._own = program, own or {}
        self._reader = Reader(
            program, self._own, inputs=settings.inputs, numbered=settings.numbered, first=settings.first
        )
        self._pace = Pace(settings.period_ms, settings.longest_gap_ms)
        for one in (program, *self._own.values()):
            _controller(one, settings, 0)  # so that wrong settings are refused now, and not with the first line

    def handle(self, origin: str, line: Line, *, from_start: bool, only: str | None = None) -> list[Output]:
        """Handle one line; return reports and events.

        from_start  the first line read from this origin is the first line that was sent
        only    the only vehicle for which the sender may send; a line of another one is refused, and counts as a line that
                this vehicle may have lost
        """
        self.tally.lines += 1
        message = self._reader.read(line)
        name = _named(message)
        if only is not None and name is not None and name != only:
            name, message = (
                None,
                Refused(f"a line of vehicle {name}; the sender's certificate is for vehicle {only} only"),
            )
        if isinstance(message, Header):
            return self._begun(message, from_start and origin not in self._flawed)
        if name is None:
            assert isinstance(message, Refused)
            if from_start:
                self._flawed.add(origin)
            return self._unassigned(origin, line, message)
        outputs: list[Output] = []
        if name not in self.vehicles:
            outputs = self._admitted(name, origin, line, message, from_start and origin not in self._flawed)
            if name not in self.vehicles:
                if from_start:
                    self._flawed.add(origin)
                return self._counted(outputs)
        vehicle = self.vehicles[name]
        self._last_line_at[name] = self._clock()
        if self.on_line is not None:
            self.on_line(name, message.number if isinstance(message, Refused) else message.envelope.number)
        if self.origins.setdefault(name, origin) != origin:
            self.origins[name] = origin
            vehicle.be_unsure("another peer sends for it")
        found = self._of_one(vehicle, lambda: vehicle.handle(line.number, message), line.number)
        return [*outputs, *found] if outputs else found

    def _begun(self, header: Header, from_start: bool) -> list[Output]:
        """Begin a step stream of the vehicle without a name."""
        if header.kept and ALONE not in self.vehicles:
            self.vehicles[ALONE] = self._made(ALONE, from_start)
        vehicle = self.vehicles.get(ALONE)
        if isinstance(vehicle, StepsVehicle):
            vehicle.begin_stream(header.kept)
        return []

    def _admitted(self, name: str, origin: str, line: Line, message: Message, from_start: bool) -> list[Output]:
        """Add a new vehicle, removing another one if needed; refuse it if its first line is unreadable or there is no
        room."""
        outputs: list[Output] = []
        reason = message.reason if isinstance(message, Refused) else self._no_room(origin, outputs)
        if reason:
            outputs.append({"vehicle": name, "event": "refused", "line": line.number, "reason": shortened(reason)})
        else:
            self.vehicles[name] = self._made(name, from_start)
        return outputs

    def _no_room(self, origin: str, outputs: list[Output]) -> str:
        """Return the reason why this peer cannot have one more vehicle; "" if it can, perhaps after removing another
        one."""
        own = self._of(origin)
        most = self.settings.most_of_a_peer
        if most is not None and len(own) >= most:
            return "" if self._forgot(own, outputs) else f"{len(own)} vehicles of this peer already"
        if len(self.vehicles) >= self.settings.most_vehicles:
            return "" if self._forgot(list(self.vehicles), outputs) else f"{len(self.vehicles)} vehicles already"
        return ""

    def _forgot(self, names: list[str], outputs: list[Output]) -> bool:
        """Remove one vehicle without a position and silent for more than the longest gap: the one silent for longest.

        Return whether there was one.
        """
        silent = self._clock() - self.settings.longest_gap_ms / 1_000
        found = [name for name in names if self._last_line_at[name] < silent and self.vehicles[name].forgettable]
        if not found:
            return False
        name = min(found, key=self._last_line_at.__getitem__)
        del self.vehicles[name], self._last_line_at[name]
        self.origins.pop(name, None)
        self.by_clock = True
        outputs.append(
            {"vehicle": name, "event": "forgotten", "reason": "removed to make room: silent, and without a position"}
        )
        return True

    def gone(self, origin: str, why: str) -> None:
        """Handle a disconnected peer: its last lines may not have arrived."""
        self._flawed.discard(origin)
        for name in self._of(origin):
            self.vehicles[name].be_unsure(why)

    def told(self, about: str, payload: bytes) -> list[Output]:
        """Handle a message beside the lines; a fleet whose vehicles listen to nobody uses none."""
        del about, payload
        return []

    def silence(self, name: str, why: str) -> list[Output]:
        """End the overdue cycle of a vehicle."""
        vehicle = self.vehicles[name]
        return self._of_one(vehicle, partial(vehicle.silence, why))

    def withdraw(self, name: str, why: str) -> list[Output]:
        """Withdraw the position of a vehicle after too long a silence."""
        vehicle = self.vehicles[name]
        outputs = self._of_one(vehicle, partial(vehicle.withdraw, why))
        self.by_clock = self.by_clock or bool(outputs)
        return outputs

    def finish(self) -> list[Output]:
        """Handle the end of all lines; return the last reports and events."""
        return [one for vehicle in self.vehicles.values() for one in self._of_one(vehicle, vehicle.finish)]

    def make_ready_to_save(self) -> None:
        """Make one snapshot of each program now: the first one takes long, and no line should wait for it."""
        for program in (self._program, *self._own.values()):
            _controller(program, self.settings, 0).snapshot()

    @property
    def name(self) -> str:
        """The machine's name."""
        return self._program.name

    @property
    def localized(self) -> int:
        """The number of vehicles that report a position."""
        return sum(vehicle.place is not None for vehicle in self.vehicles.values())

    @property
    def wrong(self) -> int:
        """The number of reports whose interval did not contain the true position."""
        return sum(vehicle.wrong for vehicle in self.vehicles.values())

    def freeze(self) -> Callable[[], dict[str, Any]]:
        """Return a function that returns all vehicles as plain data; it may be called in another thread."""
        frozen = {name: vehicle.freeze() for name, vehicle in self.vehicles.items()}
        return lambda: {name: make() for name, make in frozen.items()}

    def restore(self, saved: Mapping[str, Mapping[str, Any]], unsure: str = "") -> None:
        """Continue from the data that `freeze` gave. `unsure`: why lines may have been lost since; "" if none can be.

        SnapshotError if the data of a vehicle are invalid or of another machine.
        """
        for name, one in saved.items():
            vehicle = self.vehicles[name] = self._made(name, from_start=True)
            self._last_line_at[name] = self._clock()
            try:
                vehicle.restore(one)
            except SnapshotError as error:
                raise SnapshotError(f"vehicle {name}: {error}") from error
            if unsure:
                vehicle.be_unsure(unsure)

    def _made(self, name: str, from_start: bool) -> Vehicle:
        make = partial(_controller, self._own.get(name, self._program), self._settings_of(name))
        return self._vehicle(name, make, self._pace, from_start=from_start)

    def _settings_of(self, name: str) -> FleetSettings:
        """Return the settings of a vehicle: those of all."""
        del name
        return self.settings

    def _vehicle(self, name: str, make: MakeController, pace: Pace, *, from_start: bool) -> Vehicle:
        """Return a new vehicle of the kind that its lines have."""
        kind = StepsVehicle if self.settings.inputs else RecordsVehicle
        return kind(name, make, pace, from_start=from_start)

    def _unassigned(self, origin: str, line: Line, refused: Refused) -> list[Output]:
        """Handle a line without a readable vehicle: every vehicle of this origin may have lost it.

        An incomplete line at the end of a connection is no lost line: the disconnection already makes its vehicles unsure,
        until their next number.
        """
        outputs = self._counted([{"event": "refused", "line": line.number, "reason": refused.reason}])
        why = f"line {line.number}: {refused.reason}"
        doubted = [] if line.cut else [self.vehicles[name] for name in self._of(origin)]
        return [*outputs, *(one for vehicle in doubted for one in self._of_one(vehicle, partial(vehicle.missed, why)))]

    def _of(self, origin: str) -> list[str]:
        return [name for name, whose in self.origins.items() if whose == origin]

    def _of_one(self, vehicle: Vehicle, answer: _Answer, line: int | None = None) -> list[Output]:
        """Collect and count a vehicle's outputs, and note a withdrawn position. An exception affects this vehicle only."""
        try:
            outputs = answer()
        except Exception as error:  # of any kind: the other vehicles continue, and this one is no longer trusted
            outputs = vehicle.fail(shortened(f"{type(error).__name__}: {error}"), line)
            self.tally.failed += 1
            self.on_failure(vehicle.name, error)
        if vehicle.withdrew:
            vehicle.withdrew, self.withdrew = False, True
        return self._counted(outputs) if outputs else outputs

    def _counted(self, outputs: list[Output]) -> list[Output]:
        for one in outputs:
            self.tally.refused += one.get("event") == "refused"
            self.tally.cycles += "mode" in one
            self.tally.rejections += len(one.get("rejections", ()))
            self.tally.breaches += len(one.get("assumptions_broken", ()))
        return outputs


def _named(message: Message) -> str | None:
    """Return the vehicle of a message; None if it cannot be read."""
    match message:
        case RecordLine() | CycleEnd() | Step():
            return message.envelope.vehicle
        case Refused():
            return message.vehicle
        case Header():
            return ALONE
        case _:
            assert_never(message)


def _controller(program: Program, settings: FleetSettings, start_ms: int) -> Controller:
    return Controller(
        program, period_ms=settings.period_ms, start_ms=start_ms, expected=settings.expected, first=settings.first,
        assumptions=settings.assumptions,
    )  # fmt: skip
