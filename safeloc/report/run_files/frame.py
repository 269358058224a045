"""A run as a data frame of pandas (extra `notebook`)."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from safeloc.errors import InputError
from safeloc.language.trace import Trace
from safeloc.report.run_files.columns import run_columns
from safeloc.report.run_files.tables import rows_of, types_of

if TYPE_CHECKING:
    import pandas

_TYPES = {"int64": "Int64", "bool_": "boolean", "string": "string"}
"""Type of a column in Arrow -> in pandas: each of these has a value for "absent"."""


def data_frame(trace: Trace, *, period_ms: int | None = None, truth_mm: Sequence[int | None] = ()) -> pandas.DataFrame:
    """Return a run with a row for each step, from 1 (the index), and a column for each input, transition, state variable and output.

    Columns carry their units: `input.front_wheel_distance_mm`, `output.speed [mm/s]`. Absent values are `pandas.NA`.

    period_ms  time from one step to the next: adds the column `time_ms`
    truth_mm   recorded true position after each step, such as `Finding.truth_mm`: adds the column `truth_mm`

    InputError without pandas, or for truths of another number of steps.
    """
    try:
        import pandas
    except ImportError as error:
        raise InputError("a data frame needs pandas: pip install 'safeloc[notebook]'.") from error
    if truth_mm and len(truth_mm) != len(trace.steps):
        raise InputError(
            f"truth_mm: {len(truth_mm)} values for a run of {len(trace.steps)} steps; give one for each step."
        )
    run = run_columns(trace, period_ms=period_ms, truth_mm=truth_mm)
    rows = list(rows_of(run))
    columns = {
        name: pandas.array([row[name] for row in rows], dtype=_TYPES[kind]) for name, kind in types_of(run).items()
    }
    return pandas.DataFrame(columns).set_index("step")
