"""Runs as value change dumps (VCD), for GTKWave and other viewers of waves, with pyvcd (extra `traces`).

A unit of time is a millisecond, or a step if the time from step to step is not known. An absent number or truth value is x.
"""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

from safeloc.errors import InputError
from safeloc.report.run_files.columns import Cell, Column, RunColumns

_BITS = 64
_ABSENT = "x"
_KINDS = {"number": "integer", "truth": "wire", "label": "string"}


def write_vcd(path: Path, run: RunColumns) -> None:
    """Write the run as VCD: a scope for the machine, one in it for inputs, transitions, state and outputs each.

    InputError without pyvcd, and for names that VCD cannot tell apart.
    """
    package = _vcd(path)
    per_step = run.period_ms or 1
    words = "time in ms" if run.period_ms else "time in steps"
    with (
        path.open("w", encoding="utf-8") as file,
        package.VCDWriter(file, timescale="1 ms", comment=f"{run.machine}, {words}", date="") as writer,
    ):
        variables = [(one, _registered(path, writer, run.machine, one)) for one in run.columns]
        for number in range(run.steps):
            for column, variable in variables:
                writer.change(variable, (number + 1) * per_step, _value(column, column.values[number]))
        writer.close((run.steps + 1) * per_step)


def _registered(path: Path, writer: Any, machine: str, column: Column) -> Any:
    """Register a variable; letters that the format does not allow in a name are replaced. InputError if two names become equal."""
    scope = ".".join((_plain(machine), column.group))
    size = 1 if column.kind == "truth" else _BITS
    first = "" if column.kind == "label" else _ABSENT
    name = _plain(column.heading.removeprefix(f"{column.group}."))
    try:
        return writer.register_var(
            scope, name, _KINDS[column.kind], size=None if column.kind == "label" else size, init=first
        )
    except KeyError as error:
        raise InputError(f"{path}: two variables would be called {name!r} in VCD; write .csv.") from error


def _value(column: Column, cell: Cell) -> Any:
    if column.kind == "label":
        return "" if cell is None else str(cell).replace(" ", "_")
    return _ABSENT if cell is None else int(cell)


def _plain(name: str) -> str:
    return "_".join(re.findall(r"[^\s.\[\]/]+", name))


def _vcd(path: Path) -> Any:
    try:
        import vcd
    except ImportError as error:
        raise InputError(f"{path}: VCD needs pyvcd; install safeloc[traces], or write .csv.") from error
    return vcd
