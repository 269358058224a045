"""Time and place of a reading: a reader reads some telegrams, works, and stamps the time late; and it is mounted beside its place.

    heard    telegrams x length of one: as many as it takes until enough of them are whole, or the marker is no more under the reader
    latency  heard + processing, which scatters from reading to reading and is never below 0
    place    the vehicle's place at the time stamp: speed x latency beyond the marker

So a fast vehicle has a farther error of place for the same latency, and less time to read.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from safeloc.simulation.many_runs import DrawnFigure
from safeloc.simulation.physics.gauss_markov import Floats

PROCESSING, JITTER, TELEGRAMS = "reader_processing_ms", "reader_jitter_ms", "reader_telegrams"
TELEGRAM, FAILED, CONTACT = "reader_telegram_ms", "reader_failed", "reader_contact_mm"
FIGURES = {
    PROCESSING: DrawnFigure("ms", 0, 1_000, 0, "time from the last telegram to the time stamp, beyond what the reader corrects"),
    JITTER: DrawnFigure("ms", 0, 1_000, 0, "deviation of that time from reading to reading"),
    TELEGRAMS: DrawnFigure("telegrams", 0, 100, 0, "whole telegrams that a reading takes; 0: it takes no time to read"),
    TELEGRAM: DrawnFigure("ms", 0, 100, 1.8, "length of a telegram: 1023 bits at 564 kbit/s"),
    FAILED: DrawnFigure("share", 0, 0.99, 0, "telegrams that are not whole"),
    CONTACT: DrawnFigure("mm", 0, 100_000, 0, "way over which a marker is heard: without enough telegrams there it is missed; 0: as far as it takes"),
}  # fmt: skip
"""[S] balise reader 10 +- 2 ms; up-link of 564.48 kbit/s (SUBSET-036)."""


def mounting(reader: str) -> dict[str, DrawnFigure]:
    """Return the figure of how a reader is mounted."""
    what = f"how far ahead of its place by the vehicle's data the {reader} reader is mounted"
    return {f"{reader}_mounting_mm": DrawnFigure("mm", -10_000, 10_000, 0, what)}


@dataclass(frozen=True, eq=False)
class Latencies:
    """Latencies of readings, ms, one for each marker: of each whole one, and how long it had to be within the range of the reader."""

    late_ms: Floats
    heard_ms: Floats
    contact_mm: float

    def heard(self, number: int, speed_mm_s: float) -> bool:
        """Return whether the marker of this number is read at all at a speed."""
        return self.contact_mm == 0 or self.heard_ms[number] * abs(speed_mm_s) <= self.contact_mm * 1_000


@dataclass(frozen=True)
class ReaderTiming:
    """The timing of one vehicle's reader, and how far ahead of its place it is mounted."""

    processing_ms: float
    jitter_ms: float
    telegrams: int
    telegram_ms: float
    failed: float
    contact_mm: float
    mounting_mm: float

    @property
    def plain(self) -> bool:
        """The reader stamps in time and stands at its place."""
        return not (self.processing_ms or self.jitter_ms or self.telegrams or self.mounting_mm)

    def latencies(self, rng: np.random.Generator, markers: int) -> Latencies:
        """Draw the latency of each marker's reading."""
        scattered = self.processing_ms + self.jitter_ms * rng.standard_normal(markers)
        tried = np.zeros(markers, dtype=np.int64)
        if self.telegrams:
            tried = self.telegrams + rng.negative_binomial(self.telegrams, 1 - self.failed, markers)
        heard = np.asarray(tried * self.telegram_ms, dtype=np.float64)
        late = np.asarray(heard + np.maximum(scattered, 0), dtype=np.float64)
        return Latencies(late, heard, self.contact_mm)


def timing_of(figures: Mapping[str, Floats], vehicle: int, reader: str) -> ReaderTiming:
    """Return the timing of a vehicle's reader from the figures of `FIGURES` and `mounting`, arrays [vehicle]."""
    one = {name: float(figures[name][vehicle]) for name in (*FIGURES, f"{reader}_mounting_mm")}
    return ReaderTiming(
        one[PROCESSING], one[JITTER], round(one[TELEGRAMS]), one[TELEGRAM], one[FAILED], one[CONTACT],
        one[f"{reader}_mounting_mm"],
    )  # fmt: skip


@dataclass(frozen=True, eq=False)
class Way:
    """The way of one vehicle: its place at the start, and at the end of each cycle, nm. A place that it passes twice counts the first time."""

    start_nm: int
    position_nm: NDArray[np.int64]
    period_ms: int

    @property
    def _places(self) -> NDArray[np.int64]:
        return np.concatenate([[self.start_nm], self.position_nm])

    def time_ms(self, place_nm: float) -> float | None:
        """Return when it passes a place, ms since the start; None if never."""
        places = np.maximum.accumulate(self._places)
        after = int(np.searchsorted(places, place_nm, side="left"))
        if not 0 < after < len(places):
            return None
        begin, end = int(places[after - 1]), int(places[after])
        return (after - 1 + (place_nm - begin) / (end - begin)) * self.period_ms

    def at_nm(self, time_ms: float) -> float:
        """Return its place at a time; after the last cycle that of the end."""
        return float(np.interp(time_ms, np.arange(len(self._places)) * self.period_ms, self._places))

    def speed_mm_s(self, time_ms: float) -> float:
        """Return its speed in the cycle that ends at a time or after it."""
        number = min(max(self.cycle_of(time_ms), 0), len(self.position_nm) - 1)
        return float(int(self._places[number + 1]) - int(self._places[number])) / (self.period_ms * 1_000)

    def cycle_of(self, time_ms: float) -> int:
        """Return the cycle that begins before a time and ends at it or after it."""
        return int(-(-time_ms // self.period_ms)) - 1
