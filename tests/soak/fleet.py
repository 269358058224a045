"""The day itself: vehicles speak in the order of their clocks, the process is ended and started, windows are written."""

from __future__ import annotations

import heapq
import os
import selectors
import signal
import time
from collections.abc import Iterator, Mapping
from dataclasses import dataclass

from tests.soak.day import HOUR_MS, PERIOD_MS
from tests.soak.process import Process, waited_s
from tests.soak.vehicle import MOST_WAITING, Vehicle
from tests.soak.windows import Window

ENDS: Mapping[float, signal.Signals] = {0.2: signal.SIGKILL, 0.4: signal.SIGTERM}
"""At these shares of the day the process is ended, and started again. In the last half it is left alone: memory is judged there."""

OUTAGE_CYCLES = 20
"""So long nobody is heard then, by the fleet's clock."""

SLACK_S = 0.05
"""So much the fleet's clock may be behind and catch up."""

PATIENCE_S = 10.0
"""So long a vehicle waits for an answer while too much waits; then it goes on without."""


@dataclass(frozen=True)
class Plan:
    """How long a day, of how many vehicles, in which time by the wall at least, written a window at a time."""

    hours: float
    vehicles: int
    wall_minutes: float
    windows: int
    seed: int

    @property
    def length_ms(self) -> int:
        """The day in ms of the fleet's clock, whole cycles in each window."""
        return self.window_ms * self.windows

    @property
    def window_ms(self) -> int:
        """A window, in whole cycles."""
        return max(1, round(self.hours * HOUR_MS / self.windows / PERIOD_MS)) * PERIOD_MS

    @property
    def speed(self) -> float:
        """How much faster the fleet's clock runs than the wall's."""
        return self.length_ms / (self.wall_minutes * 60_000)


class Clock:
    """The fleet's time by the wall. Where the machine is too slow it is held up, and nothing is hurried to catch up."""

    def __init__(self, fleet_ms: float, speed: float) -> None:
        self._speed, self.late_s = speed, 0.0
        self._begin_s = time.perf_counter() - fleet_ms / 1_000 / speed

    def left_s(self, fleet_ms: float) -> float:
        """How long until then, by the wall; negative where it is over."""
        return self._begin_s + fleet_ms / 1_000 / self._speed - time.perf_counter()

    def reached(self, fleet_ms: float) -> None:
        """It is no later than that; what is more than some slack behind is given up."""
        late_s = -self.left_s(fleet_ms) - SLACK_S
        if late_s > 0:
            self._begin_s += late_s
            self.late_s += late_s


class Fleet:
    """Vehicles of a plan, from a time on, with the process that hears them."""

    def __init__(self, plan: Plan, process: Process, begin_ms: int) -> None:
        self._plan, self._process, self._begin_ms = plan, process, begin_ms
        self._selector = selectors.DefaultSelector()
        self._vehicles = [Vehicle(number, plan.seed, begin_ms, self._selector) for number in range(plan.vehicles)]
        self._due = [(self._due_ms(place), place) for place in range(plan.vehicles)]
        heapq.heapify(self._due)

    def windows(self, first: int) -> Iterator[Window]:
        """From that number on, each when it is over."""
        self._started(fresh=True)
        clock = Clock(self._begin_ms, self._plan.speed)
        for number in range(first, self._plan.windows):
            window = Window(number, number * self._plan.window_ms, (number + 1) * self._plan.window_ms)
            self._restart(window)
            self._pass(window, clock)
            if number == self._plan.windows - 1:
                self._end(signal.SIGTERM, window)
            yield window
        self._selector.close()

    def _started(self, *, fresh: bool) -> None:
        port = self._process.start(fresh=fresh)
        for vehicle in self._vehicles:
            vehicle.port = port

    def _restart(self, window: Window) -> None:
        """End the process and start it, where the plan says so; the fleet's clock goes on by the outage only."""
        for share, number in ENDS.items():
            if window.number == max(1, round(share * self._plan.windows)):
                self._end(number, window)
                self._started(fresh=False)
                for vehicle in self._vehicles:
                    vehicle.lose(OUTAGE_CYCLES)

    def _end(self, number: signal.Signals, window: Window) -> None:
        window.failures += self._process.end(number)
        window.ended = number.name
        for vehicle in self._vehicles:
            vehicle.hang_up()

    def _pass(self, window: Window, clock: Clock) -> None:
        begin_s, late_s, processor_s = time.perf_counter(), clock.late_s, self._process.processor_s()
        both = (self._process.pid, os.getpid())
        waited = [waited_s(pid) for pid in both]
        spoke: set[int] = set()
        while self._due[0][0] <= window.to_ms:
            due_ms, place = heapq.heappop(self._due)
            self._wait(clock, due_ms, window)
            self._speak(self._vehicles[place], window)
            spoke.add(place)
            heapq.heappush(self._due, (self._due_ms(place), place))
        window.life, window.driving = self._process.life, len(spoke)
        window.wall_s = round(time.perf_counter() - begin_s, 3)
        window.late_s = round(clock.late_s - late_s, 3)
        window.processor_s = round(self._process.processor_s() - processor_s, 3)
        more = max(waited_s(pid) - before for pid, before in zip(both, waited, strict=True))
        window.waited = round(more / (time.perf_counter() - begin_s), 4)
        window.load, window.resident_kib = round(os.getloadavg()[0], 2), self._process.resident_kib()

    def _due_ms(self, place: int) -> float:
        """When the vehicle says its next cycle: those of all vehicles end one after the other."""
        return self._vehicles[place].next_ms + place * PERIOD_MS / len(self._vehicles)

    def _wait(self, clock: Clock, due_ms: float, window: Window) -> None:
        self._hear(0.0, window)
        while (left_s := clock.left_s(due_ms)) > 0:
            self._hear(left_s, window)
        clock.reached(due_ms)

    def _speak(self, vehicle: Vehicle, window: Window) -> None:
        until_s = time.perf_counter() + PATIENCE_S
        while vehicle.unheard > MOST_WAITING and time.perf_counter() < until_s:
            self._hear(0.1, window)
        vehicle.speak(window)

    def _hear(self, timeout_s: float, window: Window) -> None:
        for key, _ in self._selector.select(timeout_s):
            key.data.hear(window)
