"""The computer of one vehicle: it says its cycles over a connection of its own, and compares what it hears with the truth."""

from __future__ import annotations

import json
import selectors
import socket
import time
from collections.abc import Iterator
from random import Random
from typing import Any

from tests.soak.day import PERIOD_MS, Trip, lines, trips
from tests.soak.mishaps import HANG_UP, away, befall
from tests.soak.windows import Window

MOST_WAITING = 8
"""So many cycles without any answer, and the vehicle waits for one before it speaks again. Else it never waits for reports."""


class Vehicle:
    """The vehicle with this number.

    port        where the process listens
    connection  None while it is switched off or away
    unheard     cycles sent since the process last answered
    next_ms     the end of the cycle that it says next
    """

    def __init__(self, number: int, seed: int, begin_ms: int, selector: selectors.BaseSelector) -> None:
        self.name, self._selector = f"v{number}", selector
        self.connection: socket.socket | None = None
        self.port = self.unheard = 0
        self._number, self._heard = 1, b""
        self._sent: dict[int, float] = {}
        self._chance = Random(f"{seed} {number} {begin_ms} mishaps")
        self._away = 0
        self._trips = trips(seed, number)
        self._trip = self._before = _under_way(self._trips, begin_ms)
        self.next_ms = max(self._trip.begin_ms, begin_ms) + PERIOD_MS

    def speak(self, window: Window) -> None:
        """Say the cycle that is over now, unless something keeps it from being heard."""
        time_ms = self.next_ms
        if time_ms > self._trip.end_ms:
            self._switch_off()
            return
        self.next_ms += PERIOD_MS
        said = lines(self.name, self._number, time_ms, self._trip.run.records[self._trip.cycle_at(time_ms)])
        self._number += len(said)
        if self._is_away(window):
            return
        if name := befall(said, self._chance):
            window.befell(name)
        if self._sends(b"".join(said)):
            self._sent[time_ms] = time.perf_counter()
            self.unheard += 1
            window.cycles += 1

    def hear(self, window: Window) -> None:
        """Judge what has come."""
        if self.connection is None:
            return  # let go in the same turn
        try:
            data = self.connection.recv(1 << 16)
        except ConnectionError:
            data = b""
        if not data:
            self.hang_up()
            return
        now = time.perf_counter()
        *whole, self._heard = (self._heard + data).split(b"\n")
        for line in whole:
            self._judge(json.loads(line), now, window)
        self.unheard = 0

    def hang_up(self) -> None:
        """Let the connection go; what waits for an answer gets none."""
        if self.connection is not None:
            self._selector.unregister(self.connection)
            self.connection.close()
        self.connection, self.unheard, self._heard = None, 0, b""
        self._sent.clear()

    def lose(self, cycles: int) -> None:
        """What it says in the next cycles is lost."""
        self._away = max(self._away, cycles)

    def _switch_off(self) -> None:
        self.hang_up()
        self._before, self._trip = self._trip, next(self._trips)
        self.next_ms = self._trip.begin_ms + PERIOD_MS

    def _is_away(self, window: Window) -> bool:
        if self._away:
            self._away -= 1
            return True
        name, cycles = away(self._chance)
        if name:
            window.befell(name)
        if name == HANG_UP:
            self.hang_up()
        self.lose(cycles)
        return cycles > 0

    def _sends(self, said: bytes) -> bool:
        try:
            if self.connection is None:
                self.connection = socket.create_connection(("127.0.0.1", self.port), timeout=20)
                self._selector.register(self.connection, selectors.EVENT_READ, self)
            self.connection.sendall(said)
        except ConnectionError:
            self.hang_up()
            return False
        return True

    def _judge(self, told: dict[str, Any], now: float, window: Window) -> None:
        if "mode" not in told:
            window.refused += told["event"] == "refused"
            return
        window.reports += 1
        time_ms, interval = int(told["time_ms"]), told["interval_mm"]
        if (sent := self._sent.pop(time_ms, None)) is not None:
            window.answered(now - sent)
            self._sent = {said: at for said, at in self._sent.items() if said > time_ms}
        if interval is not None:
            window.located += 1
        truth_mm = self._truth_mm(time_ms)
        if told["vehicle"] != self.name or (interval is not None and not interval[0] <= truth_mm <= interval[1]):
            window.missed(f"{self.name}: truth {truth_mm} mm, told {json.dumps(told)}")

    def _truth_mm(self, time_ms: int) -> int:
        trip = self._trip if time_ms > self._trip.begin_ms else self._before
        return trip.truth_mm(time_ms)


def _under_way(planned: Iterator[Trip], begin_ms: int) -> Trip:
    return next(trip for trip in planned if trip.end_ms > begin_ms)
