"""Detects position signals So: a rise or fall of the amplitude of a train's pattern (FWG-1, FWG-8).

A watcher follows the amplitude of the pattern's first metres from an end of the train, over its run, and compares it with the
earlier level. A return to that level ends the section and is no second one. The time of flight is not used, so its drift does
not matter. A louder vehicle moves with the train and changes nothing, while a section is fixed.
"""

from __future__ import annotations

import math
from collections import deque
from dataclasses import dataclass
from enum import Enum
from statistics import median

import numpy as np

from safeloc.sensing.array_types import Flags, Singles
from safeloc.sensing.fibre.figures import FibreConfig

_MEDIAN_WINDOWS = 9
_SAMPLE_MM = 1_000
_CDB_PER_DECADE = 1_000


class Effect(Enum):
    """Effects of a section on the amplitude."""

    RAISES = "raises"
    LOWERS = "lowers"


class Edge(Enum):
    """Changes of the amplitude."""

    RISE = "rise"
    FALL = "fall"


@dataclass(frozen=True)
class Change:
    """An edge in the amplitude at one end of a train.

    entering      True: away from the normal level; False: back to it
    length_mm     on leaving, the run of the end since entering; None: on entering, if it went back the way it came, or if
                  the amplitude lasted so long that it is the new normal level
    size_cdb      difference of the amplitude from the normal level
    """

    effect: Effect
    edge: Edge
    entering: bool
    length_mm: float | None
    size_cdb: int


class Watcher:
    """Watches the amplitude at one end of one train. `change_cdb` is its last difference from the normal level."""

    def __init__(self, config: FibreConfig) -> None:
        self._rules = config.sections
        self._normal: deque[tuple[float, float]] = deque()
        self._recent: deque[float] = deque(maxlen=_MEDIAN_WINDOWS)
        self._inside: Effect | None = None
        self._reported = False
        self.change_cdb: float | None = None
        self._entered_mm = self._towards = 0.0

    def follow(self, place_mm: float, amplitude_cdb: float) -> Change | None:
        """Process the end's place along the fibre and the amplitude of the pattern there; return a change of level, if any."""
        self._recent.append(amplitude_cdb)
        level = median(self._recent)
        normal = self._level_of_normal()
        self.change_cdb = None if normal is None else level - normal
        if normal is None:
            self._learn(place_mm, level)
            return None
        change = level - normal
        return self._outside(place_mm, level, change) if self._inside is None else self._within(place_mm, level, change)

    def _level_of_normal(self) -> float | None:
        if not self._normal or abs(self._normal[-1][0] - self._normal[0][0]) < self._rules.least_baseline_mm:
            return None
        return median(level for _, level in self._normal)

    def _learn(self, place_mm: float, level: float) -> None:
        """Add a sample to the normal level, at most one a metre: a train at rest adds none."""
        if self._normal and abs(place_mm - self._normal[-1][0]) < _SAMPLE_MM:
            return
        self._normal.append((place_mm, level))
        while abs(place_mm - self._normal[0][0]) > self._rules.baseline_mm:
            self._normal.popleft()

    def _outside(self, place_mm: float, level: float, change: float) -> Change | None:
        if abs(change) < self._rules.change_cdb:
            self._learn(place_mm, level)
            return None
        self._inside, self._reported = Effect.RAISES if change > 0 else Effect.LOWERS, False
        self._entered_mm, self._towards = place_mm, place_mm - self._normal[-1][0] or place_mm - self._normal[0][0]
        return None

    def _within(self, place_mm: float, level: float, change: float) -> Change | None:
        assert self._inside is not None
        run = abs(place_mm - self._entered_mm)
        signed = change if self._inside is Effect.RAISES else -change
        endless = run > self._rules.longest_mm
        if signed > self._rules.return_cdb and not endless:
            return self._lasting(run, change)
        effect, self._inside = self._inside, None
        if endless:
            self._start_again(place_mm, level)
        else:
            self._carry_over(place_mm)
        if not self._reported:
            return None
        crossed = (place_mm - self._entered_mm) * self._towards > 0 and not endless
        edge = Edge.FALL if effect is Effect.RAISES else Edge.RISE
        return Change(effect, edge, False, run if crossed else None, round(change))

    def _lasting(self, run: float, change: float) -> Change | None:
        """Return the change once, as soon as it has lasted long enough."""
        assert self._inside is not None
        if self._reported or run < self._rules.persist_mm:
            return None
        self._reported = True
        edge = Edge.RISE if self._inside is Effect.RAISES else Edge.FALL
        return Change(self._inside, edge, True, None, round(change))

    def _carry_over(self, place_mm: float) -> None:
        """Shift the samples of the normal level behind the section, so that its length does not count as run."""
        shift = place_mm - self._normal[-1][0]
        self._normal = deque((place + shift, level) for place, level in self._normal)

    def _start_again(self, place_mm: float, level: float) -> None:
        """Learn a new normal level, since the amplitude has changed for longer than any section."""
        self._normal.clear()
        self._learn(place_mm, level)


def amplitude(
    energy: Singles, low_mm: float, high_mm: float, outward: int, config: FibreConfig, faded: Flags | None
) -> float | None:
    """Return the mean level in cdB of the pattern's first metres inward of an end, for a train between two places of the fibre.

    The outermost metres are left out, since the end is not known exactly. None if no usable channel is left.
    """
    rules, inter = config.sections, config.interrogator
    end = high_mm if outward > 0 else low_mm
    near, far = end - outward * rules.inset_mm, end - outward * (rules.inset_mm + rules.window_mm)
    low, high = max(min(near, far), low_mm) - inter.span_mm / 2, min(max(near, far), high_mm) - inter.span_mm / 2
    first, last = (
        max(0, math.ceil(low / inter.channel_mm)),
        min(inter.channels - 1, math.floor(high / inter.channel_mm)),
    )
    part = energy[first : last + 1]
    if faded is not None:
        part = part[~faded[first : last + 1]]
    part = part[part > 0]
    return _CDB_PER_DECADE * float(np.log10(part).mean()) if len(part) else None
