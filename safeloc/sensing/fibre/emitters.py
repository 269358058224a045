"""Detects patterns of test emitters in the backscatter (FVA-8), with their place. Foreign patterns are never accepted.

A pattern lies between silences longer than any within it. Each bit has to be clearly on or off, except in the windows in which
it may change. The received bits are compared one by one, without correction.
"""

from __future__ import annotations

from collections import deque
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from safeloc.sensing.array_types import Flags, Singles
from safeloc.sensing.fibre.figures import SILENT_BITS, FibreConfig


@dataclass(frozen=True)
class Heard:
    """A pattern that ended.

    emitter   emitter of this pattern at this place; None: a foreign pattern, or a known one at a wrong place
    bits      received bits
    fibre_mm  measured place of the loudest channel (its middle)
    begin_ms  time of the first bit, to a window
    """

    emitter: str | None
    bits: str
    fibre_mm: int
    begin_ms: int


class Listener:
    """Listens to the tone of the emitters in all channels."""

    def __init__(self, config: FibreConfig) -> None:
        self._config, self._rules = config, config.emission
        self._bits = len(self._rules.emitters[0].bits) if self._rules.emitters else 0
        windows = (self._bits + 2 * SILENT_BITS) * self._rules.bit_windows
        self._tones: deque[Singles] = deque(maxlen=windows)

    def reset(self) -> None:
        """Forget what was received, after missing frames: a pattern with a gap is not accepted."""
        self._tones.clear()

    def listen(self, tone: Singles, time_ms: float) -> list[Heard]:
        """Process one window's energy at the tone over its quiet level, [channels]; return patterns that ended with silence."""
        self._tones.append(tone)
        if len(self._tones) < (self._tones.maxlen or 0):
            return []
        start = SILENT_BITS * self._rules.bit_windows
        threshold = 10 ** (self._rules.contrast_cdb / 1_000)
        begins = (self._tones[start] > threshold) & (self._tones[start - 1] <= threshold)
        channels = np.flatnonzero(begins)
        if not len(channels):
            return []
        return self._received(np.stack([tone[channels] for tone in self._tones]), channels, time_ms)

    def _received(self, level: Singles, channels: NDArray[np.intp], time_ms: float) -> list[Heard]:
        """Return the patterns in channels where a bit began after silence; neighbouring channels receive one emitter."""
        loud, threshold = level.max(axis=0), 10 ** (self._rules.contrast_cdb / 1_000)
        picture = level > np.maximum(threshold, loud * 10 ** (-self._rules.fall_cdb / 1_000))
        made: list[Heard] = []
        apart = self._rules.place_mm // self._config.interrogator.channel_mm + 1
        for group in np.split(np.arange(len(channels)), np.flatnonzero(np.diff(channels) > apart) + 1):
            loudest = int(group[np.argmax(loud[group])])
            bits = self._read(picture[:, loudest])
            if bits is not None:
                made.append(self._named(bits, int(channels[loudest]), time_ms))
        return made

    def _read(self, on: Flags) -> str | None:
        """Return the bits between silences; None if a bit is not clear or a silence is missing."""
        per = self._rules.bit_windows
        bits = on.reshape(-1, per)
        inner = bits[:, 1:-1] if per > 2 else bits[:, :1]
        clear = (inner == inner[:, :1]).all()
        if not inner[SILENT_BITS, 0]:
            return None
        quiet = not on[: SILENT_BITS * per].any() and not inner[-SILENT_BITS:].any()
        if not clear or not quiet:
            return None
        return "".join("1" if bit else "0" for bit in inner[SILENT_BITS:-SILENT_BITS, 0])

    def _named(self, bits: str, channel: int, time_ms: float) -> Heard:
        inter = self._config.interrogator
        place = channel * inter.channel_mm + inter.span_mm // 2
        known = [one for one in self._rules.emitters if one.bits == bits]
        near = [one.id for one in known if abs(one.fibre_mm - place) <= self._rules.place_mm]
        duration = (self._bits + SILENT_BITS) * self._rules.bit_windows * self._config.window_ms
        return Heard(near[0] if near else None, bits, place, round(time_ms - duration))
