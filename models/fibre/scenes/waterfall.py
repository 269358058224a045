"""Picture data of a scene: the loudness of each piece of fibre at each time, reduced, with the truth.

Levels are steps of 3 dB over the fibre's quiet, one hexadecimal digit each: 0 is quiet, f is 45 dB and more, a dot
is a block without readings. Rows are pieces of fibre from its beginning on, each as loud as its loudest channel.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from safeloc.language.units import MM_PER_M
from safeloc.models.fibre.scenes.scene import Moment, Scene

Numbers = NDArray[np.float64]
SCHEMA = "safeloc-waterfall/1"
LEVEL_CDB, LEVELS = 300, 16
MOST_COLUMNS, MOST_ROWS = 360, 200
REFUSED = "."
_DIGITS = "0123456789abcdef"
_QUIET_PERCENT = 20


def waterfall(scene: Scene, moments: Sequence[Moment], begin: int, marks: Mapping[str, int]) -> dict[str, Any]:
    """Return the picture data of the moments from number `begin` on; `marks` are further places on the line, mm, by name."""
    levels = _levels(moments)[begin:]
    rows, columns = _group(levels.shape[1], MOST_ROWS), _group(len(levels), MOST_COLUMNS)
    shown = _pooled(levels, columns, rows)
    last = [min(number + columns, len(levels)) - 1 for number in range(0, len(levels), columns)]
    truths = [moments[begin + number].truth for number in last]
    return {
        "schema": SCHEMA,
        "first_ms": moments[begin].time_ms,
        "step_ms": moments[1].time_ms - moments[0].time_ms,
        "steps_per_column": columns,
        "row_mm": rows * scene.config.interrogator.channel_mm,
        "level_cdb": LEVEL_CDB,
        "rows": ["".join(_digit(level) for level in row) for row in shown.T],
        "trains": [
            {
                "low_mm": [round(MM_PER_M * truth[number].low_m) for truth in truths],
                "high_mm": [round(MM_PER_M * truth[number].high_m) for truth in truths],
            }
            for number in range(len(scene.trains))
        ],
        "sections": [
            {"low_mm": one.low_mm, "high_mm": one.high_mm, "name": _name(one.symbol.rises, one.symbol.long)}
            for one in scene.sections
        ],
        "marks": {**(scene.points or {}), **marks},
    }


def _group(count: int, most: int) -> int:
    return -(-count // most)


def _name(rises: bool, long: bool) -> str:
    return f"{'raised' if rises else 'lowered'}, {'long' if long else 'short'}"


def _levels(moments: Sequence[Moment]) -> Numbers:
    """Return steps over quiet, [blocks, channels]; NaN if a block gave no readings."""
    channels = max(len(moment.energy) for moment in moments)
    energy = np.full((len(moments), channels), np.nan)
    for number, moment in enumerate(moments):
        if len(moment.energy) and not _silenced(moment):
            energy[number] = moment.energy
    quiet = np.median(np.nanpercentile(energy, _QUIET_PERCENT, axis=0))
    with np.errstate(invalid="ignore"):
        return np.asarray(10 * np.log10(np.maximum(energy / quiet, 1)) * 100 / LEVEL_CDB)


def _silenced(moment: Moment) -> bool:
    """Return whether a block was refused for more than an unknown quiet of the fibre."""
    return bool(moment.refused) and "quiet" not in moment.refused


def _pooled(levels: Numbers, columns: int, rows: int) -> Numbers:
    """Return the loudest of each group, [columns, rows]; NaN if nothing in it has a level."""
    made = np.full((_group_count(len(levels), columns), _group_count(levels.shape[1], rows)), np.nan)
    for column in range(made.shape[0]):
        block = levels[column * columns : (column + 1) * columns]
        for row in range(made.shape[1]):
            piece = block[:, row * rows : (row + 1) * rows]
            if not np.isnan(piece).all():
                made[column, row] = np.nanmax(piece)
    return made


def _group_count(count: int, size: int) -> int:
    return -(-count // size)


def _digit(level: float) -> str:
    return REFUSED if np.isnan(level) else _DIGITS[min(int(level), LEVELS - 1)]
