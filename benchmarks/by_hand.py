"""The odometer as a careful programmer would write it by hand: a slotted class, and a C loop."""

from __future__ import annotations

import ctypes
import subprocess
from collections.abc import Callable
from pathlib import Path

import numpy as np

from benchmarks.odometer import TOLERANCE_MM, Last, Row
from tests.examples import LINE_MM

TRACKING, DELOCALIZED = 0, 1
TOLERANCE_NM = TOLERANCE_MM * 10**6
RATE_PPM = 50_000


class HandWritten:
    """The unit of all ratios: one method call a step, attributes in slots."""

    __slots__ = ("margin", "mode", "position")

    def __init__(self) -> None:
        self.mode = TRACKING
        self.position = 0
        self.margin = 0

    def step(self, movement: int, present: bool, reference: int) -> int:
        """One step; the number of the rule that applied."""
        if present:
            self.mode = TRACKING
            self.position = reference
            self.margin = 0
            return 1
        if self.mode != TRACKING:
            return 0
        grown = self.margin + abs(movement) * RATE_PPM
        if grown > TOLERANCE_NM:
            self.mode = DELOCALIZED
            return 2
        position = self.position + movement
        if not -LINE_MM <= position <= LINE_MM:
            self.mode = DELOCALIZED
            return 3
        self.position = position
        self.margin = grown
        return 4


def run_hand_written(rows: list[Row]) -> Last:
    """The stream through the class."""
    odometer = HandWritten()
    for movement, present, reference in rows:
        odometer.step(movement, present, reference)
    return odometer.mode, odometer.position, odometer.margin


BORDER = f"""
        if (movement[n] < -5000 || movement[n] > 5000 || present[n] > 1
                || (present[n] && (reference[n] < 0 || reference[n] > {LINE_MM}))) {{
            break;
        }}
"""
"""The check that generated code makes of every row: it stops before the first one with an input out of its range."""

C_SOURCE = f"""
#include <stdint.h>

void run(int64_t steps, const int64_t *movement, const uint8_t *present, const int64_t *reference, int64_t *state)
{{
    int64_t mode = state[0], position = state[1], margin = state[2];
    for (int64_t n = 0; n < steps; n++) {{
        /* border */
        int64_t way = movement[n] < 0 ? -movement[n] : movement[n];
        int64_t grown = margin + way * {RATE_PPM}, moved = position + movement[n];
        if (present[n]) {{
            mode = {TRACKING}; position = reference[n]; margin = 0;
        }} else if (mode == {TRACKING}) {{
            if (grown > {TOLERANCE_NM}LL || moved < -{LINE_MM} || moved > {LINE_MM}) {{
                mode = {DELOCALIZED};
            }} else {{
                position = moved; margin = grown;
            }}
        }}
    }}
    state[0] = mode; state[1] = position; state[2] = margin;
}}
"""


def compiled_c(compiler: str, folder: Path, *, border: bool) -> Callable[[list[Row]], Callable[[], Last]]:
    """The C loop, compiled now: rows -> a function that runs them and gives the last state."""
    source, library = folder / f"by_hand_{border}.c", folder / f"by_hand_{border}.so"
    source.write_text(C_SOURCE.replace("/* border */", BORDER if border else ""))
    subprocess.run([compiler, "-O2", "-Wall", "-Werror", "-shared", "-fPIC", source, "-o", library], check=True)
    run = ctypes.CDLL(str(library)).run
    run.argtypes = [ctypes.c_int64, *[ctypes.c_void_p] * 4]
    run.restype = None

    def prepared(rows: list[Row]) -> Callable[[], Last]:
        movement, present, reference = (np.array(column) for column in zip(*rows, strict=True))
        state = np.zeros(3, dtype=np.int64)

        def once() -> Last:
            state[:] = 0
            run(len(rows), movement.ctypes.data, present.ctypes.data, reference.ctypes.data, state.ctypes.data)
            return int(state[0]), int(state[1]), int(state[2])

        return once

    return prepared
