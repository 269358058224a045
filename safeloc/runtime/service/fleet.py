"""All vehicles of the process: which line is whose, and what is remembered of them together."""

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
from safeloc.runtime.service.messages import ALONE, Ended, Header, Message, Reader, Refused, Said, Step, shortened
from safeloc.runtime.service.vehicle import Told, Vehicle

MOST_VEHICLES = 1_000


@dataclass(frozen=True)
class Ways:
    """Settings for reading lines and bridging gaps.

    inputs          lines are inputs of steps, not records
    numbered        every line needs its number, for lines may be lost unseen on their way
    longest_gap_ms  longest silence that is bridged by cycles without inputs; after a longer one a vehicle restarts
    most_vehicles   of the process; one that is silent and has no place makes room for a new one
    most_of_a_peer  vehicles for which one peer may send; None: as many as there is room for
    assumptions     judge the observable laws of the worlds in each cycle
    """

    period_ms: int
    inputs: bool = False
    numbered: bool = False
    longest_gap_ms: int = LONGEST_GAP_MS
    most_vehicles: int = MOST_VEHICLES
    most_of_a_peer: int | None = None
    expected: Mapping[str, int] = field(default_factory=dict)
    first: Mapping[str, Value] = field(default_factory=dict)
    assumptions: bool = True


@dataclass
class Tally:
    """Counts since the start of the process."""

    lines: int = 0
    refused: int = 0
    cycles: int = 0
    rejections: int = 0
    breaches: int = 0
    failed: int = 0


Answer = Callable[[], list[Told]]


class Fleet:
    """Vehicles by name. Origins are the peers that lines come from; a vehicle is of the one that spoke of it last.

    own        vehicle -> program, where it is not the common one
    clock      seconds, for how long a vehicle has been silent
    withdrew   a place was withdrawn: set here, cleared by who has saved that
    by_clock   something happened that the lines alone do not say: the same
    on_failure is told of an exception that nobody planned, and of which vehicle

    InputError where no controller can be made of these figures.
    """

    def __init__(
        self,
        program: Program,
        ways: Ways,
        own: Mapping[str, Program] | None = None,
        clock: Callable[[], float] = time.monotonic,
    ) -> None:
        self.ways, self.tally = ways, Tally()
        self.withdrew = self.by_clock = False
        self.on_failure: Callable[[str, Exception], None] = lambda _vehicle, _error: None
        self.vehicles: dict[str, Vehicle] = {}
        self._clock = clock
        self._heard: dict[str, float] = {}
        self.origins: dict[str, str] = {}
        self._flawed: set[str] = set()
        self._program, self._own = program, own or {}
        self._reader = Reader(program, self._own, inputs=ways.inputs, numbered=ways.numbered, first=ways.first)
        self._pace = Pace(ways.period_ms, ways.longest_gap_ms)
        for one in (program, *self._own.values()):
            _controller(one, ways, 0)  # what is wrong with the figures shows now, not with the first line

    def heed(self, origin: str, line: Line, *, whole: bool, only: str | None = None) -> list[Told]:
        """One line. `whole`: the first line of this origin is the first one there was. `only`: of which vehicle alone
        it may be; a line of another one is nobody's, and may have been this one's."""
        self.tally.lines += 1
        message = self._reader.read(line)
        if only is not None:
            message = _of_it(only, message)
        if isinstance(message, Header):
            return self._begun(message, whole and origin not in self._flawed)
        name = message.vehicle if isinstance(message, Refused) else message.envelope.vehicle
        if name is None:
            assert isinstance(message, Refused)
            if whole:
                self._flawed.add(origin)
            return self._whoever(origin, line, message)
        told: list[Told] = []
        if name not in self.vehicles:
            told = self._admitted(name, origin, line, message, whole and origin not in self._flawed)
            if name not in self.vehicles:
                if whole:
                    self._flawed.add(origin)
                return self._counted(told)
        vehicle = self.vehicles[name]
        self._heard[name] = self._clock()
        if self.origins.setdefault(name, origin) != origin:
            self.origins[name] = origin
            vehicle.be_unsure("another peer sends for it")
        return [*told, *self._of_one(vehicle, partial(vehicle.heed, line.number, message), line.number)]

    def _begun(self, header: Header, whole: bool) -> list[Told]:
        """A step stream of the vehicle that needs no name."""
        if header.kept and ALONE not in self.vehicles:
            self.vehicles[ALONE] = self._made(ALONE, whole)
        vehicle = self.vehicles.get(ALONE)
        if isinstance(vehicle, StepsVehicle):
            vehicle.begin_stream(header.kept)
        return []

    def _admitted(self, name: str, origin: str, line: Line, message: Message, whole: bool) -> list[Told]:
        """Add a new vehicle, removing another one if needed; refuse it if its first line is unreadable or there is no
        room."""
        told: list[Told] = []
        reason = message.reason if isinstance(message, Refused) else self._no_room(origin, told)
        if reason:
            told.append({"vehicle": name, "event": "refused", "line": line.number, "reason": shortened(reason)})
        else:
            self.vehicles[name] = self._made(name, whole)
        return told

    def _no_room(self, origin: str, told: list[Told]) -> str:
        """Return the reason why this peer cannot have one more vehicle; "" if it can, perhaps after removing another
        one."""
        own = self._of(origin)
        most = self.ways.most_of_a_peer
        if most is not None and len(own) >= most:
            return "" if self._forgot(own, told) else f"{len(own)} vehicles of this peer already"
        if len(self.vehicles) >= self.ways.most_vehicles:
            return "" if self._forgot(list(self.vehicles), told) else f"{len(self.vehicles)} vehicles already"
        return ""

    def _forgot(self, names: list[str], told: list[Told]) -> bool:
        """Remove the vehicle with the longest silence beyond the longest gap and without a position; return whether there
        was one."""
        silent = self._clock() - self.ways.longest_gap_ms / 1_000
        found = [name for name in names if self._heard[name] < silent and self.vehicles[name].forgettable]
        if not found:
            return False
        name = min(found, key=self._heard.__getitem__)
        del self.vehicles[name], self._heard[name]
        self.origins.pop(name, None)
        self.by_clock = True
        told.append(
            {"vehicle": name, "event": "forgotten", "reason": "removed to make room: silent, and without a position"}
        )
        return True

    def gone(self, origin: str, why: str) -> None:
        """Handle a disconnected peer: its last lines may not have arrived."""
        self._flawed.discard(origin)
        for name in self._of(origin):
            self.vehicles[name].be_unsure(why)

    def silence(self, name: str, why: str) -> list[Told]:
        """Handle a vehicle whose cycle should be over by now."""
        vehicle = self.vehicles[name]
        return self._of_one(vehicle, partial(vehicle.silence, why))

    def withdraw(self, name: str, why: str) -> list[Told]:
        """Withdraw the position of a vehicle after too long a silence."""
        vehicle = self.vehicles[name]
        told = self._of_one(vehicle, partial(vehicle.withdraw, why))
        self.by_clock = self.by_clock or bool(told)
        return told

    def finish(self) -> list[Told]:
        """Nothing more will come, from anyone."""
        return [told for vehicle in self.vehicles.values() for told in self._of_one(vehicle, vehicle.finish)]

    def make_ready_to_save(self) -> None:
        """Make one snapshot of each program now: the first one takes long, and lines would have to wait."""
        for program in (self._program, *self._own.values()):
            _controller(program, self.ways, 0).snapshot()

    @property
    def name(self) -> str:
        """The machine's name."""
        return self._program.name

    @property
    def wrong(self) -> int:
        """The number of reports whose interval did not contain the true position."""
        return sum(vehicle.wrong for vehicle in self.vehicles.values())

    def freeze(self) -> Callable[[], dict[str, Any]]:
        """Return a function that makes all vehicles as plain data, in whichever thread it is called."""
        frozen = {name: vehicle.freeze() for name, vehicle in self.vehicles.items()}
        return lambda: {name: make() for name, make in frozen.items()}

    def restore(self, kept: Mapping[str, Mapping[str, Any]], unsure: str = "") -> None:
        """Go on where `freeze` was called. `unsure`: why lines may have been lost since; "" if none can have been.

        SnapshotError where a vehicle's part is of something else, or is none.
        """
        for name, one in kept.items():
            vehicle = self.vehicles[name] = self._made(name, whole=True)
            self._heard[name] = self._clock()
            try:
                vehicle.restore(one)
            except SnapshotError as error:
                raise SnapshotError(f"vehicle {name}: {error}") from error
            if unsure:
                vehicle.be_unsure(unsure)

    def _made(self, name: str, whole: bool) -> Vehicle:
        ways = self.ways
        make = partial(_controller, self._own.get(name, self._program), ways)
        kind = StepsVehicle if ways.inputs else RecordsVehicle
        return kind(name, make, self._pace, whole=whole)

    def _whoever(self, origin: str, line: Line, refused: Refused) -> list[Told]:
        """Handle a line without a readable vehicle: every vehicle of this origin may have lost it.

        Half a line where a peer went away is no line yet: that it went away is doubt enough, and the next number ends it.
        """
        told = self._counted([{"event": "refused", "line": line.number, "reason": refused.reason}])
        why = f"line {line.number}: {refused.reason}"
        doubted = [] if line.cut else [self.vehicles[name] for name in self._of(origin)]
        return [*told, *(one for vehicle in doubted for one in self._of_one(vehicle, partial(vehicle.missed, why)))]

    def _of(self, origin: str) -> list[str]:
        return [name for name, whose in self.origins.items() if whose == origin]

    def _of_one(self, vehicle: Vehicle, answer: Answer, line: int | None = None) -> list[Told]:
        """Collect and count a vehicle's answers, and note a withdrawn position. An exception affects this vehicle only."""
        try:
            told = answer()
        except Exception as error:  # whatever it is: the others go on, and nothing of this one is trusted
            told = vehicle.fail(shortened(f"{type(error).__name__}: {error}"), line)
            self.tally.failed += 1
            self.on_failure(vehicle.name, error)
        if vehicle.withdrew:
            vehicle.withdrew, self.withdrew = False, True
        return self._counted(told) if told else told

    def _counted(self, told: list[Told]) -> list[Told]:
        for one in told:
            self.tally.refused += one.get("event") == "refused"
            self.tally.cycles += "mode" in one
            self.tally.rejections += len(one.get("rejections", ()))
            self.tally.breaches += len(one.get("assumptions_broken", ()))
        return told


def _of_it(only: str, message: Message) -> Message:
    """The message, refused where the vehicle it names is not the one that its sender is known to be."""
    name: str | None
    match message:
        case Header():
            name = ALONE
        case Refused():
            name = message.vehicle
        case Said() | Ended() | Step():
            name = message.envelope.vehicle
        case _:
            assert_never(message)
    if name is None or name == only:
        return message
    return Refused(f"a line of vehicle {name}; the sender's certificate is for vehicle {only} only")


def _controller(program: Program, ways: Ways, start_ms: int) -> Controller:
    return Controller(
        program, period_ms=ways.period_ms, start_ms=start_ms, expected=ways.expected, first=ways.first,
        assumptions=ways.assumptions,
    )  # fmt: skip
