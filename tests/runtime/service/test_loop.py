"""The loop rests between turns, and longer the more it has to do, but not without bound. The clock is one that is set."""

from __future__ import annotations

import os
import selectors
import sys
from collections.abc import Iterator, Mapping
from types import SimpleNamespace
from typing import Any

import pytest

from safeloc.runtime.service import loop as module
from safeloc.runtime.service.feeds import Event
from safeloc.runtime.service.journal import Journal
from safeloc.runtime.service.loop import Loop
from safeloc.runtime.service.station import Work
from tests.runtime.service.processes import nowhere

TURNS = 20


class Clock:
    """A clock that goes on when it is told to, and what was slept."""

    def __init__(self) -> None:
        self.now, self.slept = 100.0, 0.0

    def monotonic(self) -> float:
        """Its time."""
        return self.now

    def sleep(self, seconds: float) -> None:
        """Sleep."""
        self.now += seconds
        self.slept += seconds


class Busy(Work):
    """Work that takes some time in each turn, and is over after some turns."""

    machine = "busy"

    def __init__(self, clock: Clock, gather_s: float, takes_s: float) -> None:
        self.gather_s, self._clock, self._takes_s = gather_s, clock, takes_s
        self.begun: list[float] = []

    def open(self, selector: selectors.BaseSelector) -> None:
        """There is always something to read."""
        self.pipe = os.pipe()
        os.write(self.pipe[1], b"x")
        selector.register(self.pipe[0], selectors.EVENT_READ, lambda _mask: iter(()))

    def take(self, events: Iterator[Event]) -> None:
        """Nothing is read."""

    def turn(self) -> None:
        """Take the time."""
        self.begun.append(self._clock.now)
        self._clock.now += self._takes_s
        self.over = len(self.begun) == TURNS

    def patience_s(self) -> float | None:
        """No time."""
        return 0.0

    def finish(self) -> None:
        """Nothing."""

    def end(self, *, failed: bool) -> None:
        """Give the pipe back."""
        assert not failed
        for one in self.pipe:
            os.close(one)

    def sums(self) -> Mapping[str, int]:
        """Nothing to count."""
        return {}

    def gauges(self) -> Mapping[str, int]:
        """Nothing to show."""
        return {}


def _nothing() -> None:
    """Collect and freeze nothing: the objects are those of all tests."""


def between(monkeypatch: pytest.MonkeyPatch, gather_s: float, takes_s: float) -> tuple[set[Any], float]:
    """The times from turn to turn, in ms, and what was slept."""
    clock = Clock()
    monkeypatch.setattr(module, "time", SimpleNamespace(monotonic=clock.monotonic, sleep=clock.sleep))
    monkeypatch.setattr(module, "gc", SimpleNamespace(collect=_nothing, freeze=_nothing))
    work = Busy(clock, gather_s, takes_s)
    switching_s = sys.getswitchinterval()
    try:
        with selectors.DefaultSelector() as selector:
            Loop(work, selector, Journal(nowhere())).run()
    finally:
        sys.setswitchinterval(switching_s)
    steps = zip(work.begun[1:], work.begun[2:], strict=False)
    return {round((b - a) * 1_000, 6) for a, b in steps}, clock.slept


@pytest.mark.parametrize(
    ("takes_ms", "between_ms"),
    [
        (0.0, 5.0), (1.0, 5.0), (1.6, 5.0),  # little to do: the least rest
        (2.0, 6.0), (5.0, 15.0),  # a third of the time is work
        (7.0, 20.0), (15.0, 20.0),  # no more than four times the least
        (20.0, 20.0), (50.0, 50.0),  # so much that there is no rest at all
    ],
)  # fmt: skip
def test_how_long_a_process_rests(monkeypatch: pytest.MonkeyPatch, takes_ms: float, between_ms: float) -> None:
    """From the beginning of a turn to that of the next."""
    found, slept = between(monkeypatch, 0.005, takes_ms / 1_000)
    assert found == {between_ms}
    assert (slept == 0.0) == (takes_ms >= 20.0)


def test_no_rest_at_all(monkeypatch: pytest.MonkeyPatch) -> None:
    """Where none is wanted, however much there is to do."""
    assert between(monkeypatch, 0.0, 0.03) == ({30.0}, 0.0)
