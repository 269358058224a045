"""Runs of one machine in columns, in one packed file. A report stores its witnesses and counterexamples in this form.

The file is JSON packed with xz (`xz -dc FILE | python -m json.tool`):

    {"schema": "safeloc-runs/1",
     "names": {"inputs": [...], "fired": [...], "state": [...], "outputs": [...]},
     "runs": [{"results": [ID, ...], "machine": NAME, "steps": NUMBER, "first": [VALUE, ...],
               "inputs": [COLUMN, ...], "fired": [...], "state": [...], "outputs": [...], "truth_mm": COLUMN}, ...]}

A COLUMN is [value, count, value, count, ...] over the steps, and there is one for each name, in order; null stands for an
absent input or output. `first` are the values before the first step, in the order of `state`. `results` are the ids of
all results that the run shows, `machine` is the name of the machine that ran.
"""

from __future__ import annotations

import json
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from itertools import chain, islice, repeat
from pathlib import Path
from typing import Any

from safeloc.errors import SafelocError, StreamError
from safeloc.language.absence import stand_ins, without_absent
from safeloc.language.nodes import Value
from safeloc.language.trace import Step, Trace, present_inputs
from safeloc.runtime.outside import quoted, refuse_beyond, shortened
from safeloc.runtime.packed import SMALL, packed, read_packed
from safeloc.runtime.streams.files import MOST_CELLS, MOST_ROWS, existing, streaming
from safeloc.runtime.streams.steps import Cell, StepStream

_SCHEMA = "safeloc-runs/1"
KINDS = ("inputs", "fired", "state", "outputs")
_Column = list[Any]
_Plain = dict[str, Any]
_ABSENT = object()


@dataclass(frozen=True, eq=False)
class Shown:
    """A run, the ids of the results that it shows, and the recorded true position after each step (None: unknown)."""

    results: Sequence[str]
    trace: Trace
    truth_mm: Sequence[int | None] = ()


def runs_file(runs: Sequence[Shown]) -> bytes:
    """Return the content of a file with these runs."""
    rows = [[_row(one.trace, number) for number in range(len(one.trace.steps))] for one in runs]
    names = _names(runs, rows)
    data = {
        "schema": _SCHEMA,
        "names": names,
        "runs": [_packed_run(one, rows_of_run, names) for one, rows_of_run in zip(runs, rows, strict=True)],
    }
    return packed(json.dumps(data, separators=(",", ":")).encode(), SMALL)


def _row(trace: Trace, number: int) -> Sequence[Mapping[str, Cell]]:
    """Return the values of a step, by kind in the order of KINDS."""
    step = trace.steps[number]
    return present_inputs(trace.system, step.inputs), step.fired, step.state, _outputs(trace, step)


def _outputs(trace: Trace, step: Step) -> Mapping[str, Cell]:
    outputs = without_absent(step.outputs, stand_ins(trace.system))
    return {name: value for name, value in outputs.items() if value is not None}


def _names(runs: Sequence[Shown], rows: Sequence[Sequence[Sequence[Mapping[str, Cell]]]]) -> dict[str, Sequence[str]]:
    """Return the names in all runs, by kind: inputs in the order of the declaration, others in order of appearance."""
    found = {kind: dict[str, None]() for kind in KINDS}
    for one, steps in zip(runs, rows, strict=True):
        found["state"].update(dict.fromkeys(one.trace.initial))
        for step in steps:
            for kind, values in zip(KINDS, step, strict=True):
                if not found[kind].keys() >= values.keys():
                    found[kind].update(dict.fromkeys(values))
    declared = dict.fromkeys(var.name for one in runs for var in one.trace.system.inputs)
    names = {kind: list(of_a_kind) for kind, of_a_kind in found.items()}
    return {**names, "inputs": [name for name in declared if name in found["inputs"]]}


def _packed_run(one: Shown, rows: Sequence[Sequence[Mapping[str, Cell]]], names: Mapping[str, Sequence[str]]) -> _Plain:
    columns = {kind: _columns([row[at] for row in rows], names[kind]) for at, kind in enumerate(KINDS)}
    truth = [*one.truth_mm][: len(rows)]
    truth += [None] * (len(rows) - len(truth))
    return {
        "results": list(one.results),
        "machine": one.trace.system.name,
        "steps": len(rows),
        "first": [one.trace.initial.get(name) for name in names["state"]],
        **columns,
        "truth_mm": _columns([{"truth_mm": value} for value in truth], ["truth_mm"])[0],
    }


def _columns(rows: Sequence[Mapping[str, Any]], names: Sequence[str]) -> list[_Column]:
    """Return the column of each name: values, and how often each is repeated; 1 and true differ."""
    columns: list[_Column] = [[] for _ in names]
    since = [0] * len(names)
    before: Sequence[Any] = [_ABSENT] * len(names)
    for number, row in enumerate(rows):
        now = list(map(row.get, names))
        for at, (old, new) in enumerate(zip(before, now, strict=True)):
            if old is not new and (old != new or type(old) is not type(new)):
                if number:
                    columns[at].append(number - since[at])
                columns[at].append(new)
                since[at] = number
        before = now
    for column, begun in zip(columns, since, strict=True):
        if column:
            column.append(len(rows) - begun)
    return columns


# ------------------------------------------------------------------ read


@contextmanager
def _flawless(path: Path) -> Iterator[None]:
    """Raise StreamError with the file's name if its content does not fit the schema."""
    with streaming(path):
        try:
            yield
        except SafelocError:
            raise
        except (KeyError, TypeError, ValueError, AttributeError, RecursionError) as error:
            raise StreamError(f"{path}: does not fit schema {_SCHEMA}: {shortened(error)}.") from error


def read_runs(path: Path) -> Runs:
    """Return the runs of a file. StreamError with its name if it is missing, damaged, or of another kind."""
    with _flawless(path):
        data = json.loads(read_packed(existing(path)))
        if data["schema"] != _SCHEMA:
            raise StreamError(f"{path}: schema is {quoted(data['schema'])}; this version reads {_SCHEMA!r}.")
        return Runs(path, data)


class Runs:
    """The runs of a file, by the ids of the results that they show; a run is unpacked only when it is used."""

    def __init__(self, path: Path, data: Mapping[str, Any]) -> None:
        self._path, self._names = path, data["names"]
        self._runs: Mapping[str, _Plain] = {result: run for run in data["runs"] for result in run["results"]}
        if not all(isinstance(self._names[kind], list) for kind in KINDS):
            raise TypeError("lists of the names of columns were expected")

    def __contains__(self, result: str) -> bool:
        return result in self._runs

    def __iter__(self) -> Iterator[str]:
        """Iterate over the ids of all results that have a run."""
        return iter(self._runs)

    def plain(self, result: str) -> _Plain:
        """Return the run of a result in the form of reports: first values, and each step by kind; StreamError as `stream`."""
        with _flawless(self._path):
            run = self._found(result)
            kinds = [self._rows(run, kind) for kind in KINDS]
            steps = [dict(zip(KINDS, step, strict=True)) for step in zip(*kinds, strict=True)]
            return {"first": self._first(run), "steps": steps, "truth_mm": self._truth_mm(run)}

    def stream(self, result: str) -> StepStream:
        """Return the inputs of the run of a result as a stream for `replay`. StreamError if the file has no run of it."""
        with _flawless(self._path):
            run = self._found(result)
            truth = self._truth_mm(run) or repeat(None, run["steps"])
            steps = tuple(
                step if value is None else {**step, "truth_mm": value}
                for step, value in zip(self._rows(run, "inputs"), truth, strict=True)
            )
            columns = {name: 1 for step in steps for name in step}
            return StepStream(steps, tuple(range(1, len(steps) + 1)), self._first(run), str(run["machine"]), columns)

    def _found(self, result: str) -> _Plain:
        if result not in self._runs:
            known = ", ".join(map(repr, islice(self, 5))) + (", ..." if len(self._runs) > 5 else "")
            raise StreamError(f"{self._path}: no run of {quoted(result)}; it holds {len(self._runs)}: {known}.")
        run = self._runs[result]
        refuse_beyond(self._path, run["steps"], MOST_ROWS, "steps")
        refuse_beyond(self._path, run["steps"] * sum(map(len, self._names.values())), MOST_CELLS, "cells")
        return run

    def _first(self, run: _Plain) -> dict[str, Value]:
        pairs = zip(self._names["state"], run["first"], strict=True)
        return {name: value for name, value in pairs if value is not None}

    def _truth_mm(self, run: _Plain) -> list[int | None]:
        """Return the true positions; an empty list if none is known."""
        values = _unfolded(run["truth_mm"], run["steps"])
        return [] if all(value is None for value in values) else values

    def _rows(self, run: _Plain, kind: str) -> Iterator[dict[str, Any]]:
        names, columns = self._names[kind], run[kind]
        if len(columns) != len(names):
            raise ValueError(f"{len(columns)} columns of {len(names)} {kind}")
        unfolded = [_unfolded(column, run["steps"]) for column in columns]
        rows: Iterable[Sequence[Any]] = zip(*unfolded, strict=True) if names else repeat((), run["steps"])
        return ({name: cell for name, cell in zip(names, row, strict=True) if cell is not None} for row in rows)


def _unfolded(column: _Column, steps: int) -> list[Any]:
    counts = column[1::2]
    if len(column) % 2 or any(type(count) is not int or count < 1 for count in counts) or sum(counts) != steps:
        raise ValueError(f"a column of {sum(counts)} steps where there are {steps}")
    return list(chain.from_iterable(map(repeat, column[::2], counts)))
