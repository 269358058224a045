"""Runs of one machine in columns, in one script that the report's page loads and programs read (safeloc.runtime.scripts).

The data in it are JSON:

    {"schema": "safeloc-runs/2",
     "names": {"inputs": [...], "fired": [...], "state": [...], "outputs": [...]},
     "runs": [{"results": [ID, ...], "machine": NAME, "steps": NUMBER, "first": [VALUE, ...], "like": [RUN, STEPS]}, ...],
     "columns": [COLUMN, ...]}

`results` are the ids of all results that the run shows, `machine` is the name of the machine that ran, `first` are the values
before the first step, in the order of `state` (one that JavaScript cannot hold as a string of digits). The first steps of a run are often those of an earlier one: `like` is the
number of that run and how many steps they share. Only the other steps are kept, those of all runs one after another.

A COLUMN is [value, count, value, count, ...] over these steps; there is one for each name, in order, and a last one for the
true position in mm. null stands for an absent value. Whole numbers are differences from the number before in their column; in
a column with numbers that JavaScript cannot hold they are strings of digits instead. A column that equals an earlier one is
the number of that.
"""

from __future__ import annotations

import json
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from functools import cached_property
from itertools import accumulate, chain, islice, repeat
from pathlib import Path
from typing import Any

from safeloc.errors import SafelocError, StreamError
from safeloc.language.absence import stand_ins, without_absent
from safeloc.language.nodes import Value
from safeloc.language.system import TransitionSystem
from safeloc.language.trace import Step, Trace, present_inputs
from safeloc.runtime.outside import quoted, refuse_beyond, shortened
from safeloc.runtime.scripts import read_script, script
from safeloc.runtime.streams.files import MOST_CELLS, MOST_ROWS, existing, streaming
from safeloc.runtime.streams.steps import Cell, StepStream

_SCHEMA = "safeloc-runs/2"
FUNCTION = "safelocRuns"
"""The function of the page that takes the runs."""
KINDS = ("inputs", "fired", "state", "outputs")
EXACT = 2**53 - 1
"""The greatest whole number that a number of JavaScript holds exactly, and all below it."""
_Column = list[Any]
_Plain = dict[str, Any]
_Table = Sequence[Sequence[Any]]


@dataclass(frozen=True, eq=False)
class Shown:
    """A run, the ids of the results that it shows, and the recorded true position after each step (None: unknown)."""

    results: Sequence[str]
    trace: Trace
    truth_mm: Sequence[int | None] = ()


def runs_file(runs: Sequence[Shown], name: str) -> str:
    """Return the text of a file with these runs, for the machine with this file name."""
    lines = _Lines(runs)
    names = lines.names
    beginnings, described, kept = _Beginnings(), list[_Plain](), list[Sequence[Any]]()
    for one in runs:
        table, first = list(lines.of(one)), [_exact(one.trace.initial.get(name)) for name in names["state"]]
        like = beginnings.add(first, [text for _, text in table])
        kept += [values for values, _ in table[like[1] :]]
        about = {"results": list(one.results), "machine": one.trace.system.name, "steps": len(table), "first": first}
        described.append({**about, "like": like})
    columns = list(zip(*kept, strict=True)) or [()] * (1 + sum(map(len, names.values())))
    data = {"schema": _SCHEMA, "names": names, "runs": described, "columns": _numbered(map(_column, columns))}
    return script(FUNCTION, name, data=json.dumps(data, separators=(",", ":")).encode())


_Row = Sequence[Mapping[str, Cell]]
"""The values of a step, by kind in the order of KINDS."""


class _Lines:
    """The steps of some runs, each as the values of all columns and as a text that tells it from others.

    Of steps that are the same object, as where several runs begin alike, each is read once.
    """

    def __init__(self, runs: Sequence[Shown]) -> None:
        self._rows = {
            (id(one.trace.system), id(step)): (step, _row(one.trace.system, step))
            for one in runs
            for step in one.trace.steps
        }
        self.names = _names(runs, [row for _, row in self._rows.values()])
        self._known = {key: self._line(row, None) for key, (_, row) in self._rows.items()}

    def of(self, one: Shown) -> Iterator[tuple[Sequence[Any], str]]:
        """Yield the lines of a run."""
        for step, now in zip(one.trace.steps, chain(one.truth_mm, repeat(None)), strict=False):
            key = (id(one.trace.system), id(step))
            yield self._known[key] if now is None else self._line(self._rows[key][1], now)

    def _line(self, row: _Row, now: int | None) -> tuple[Sequence[Any], str]:
        values = [*chain.from_iterable(map(row[at].get, self.names[kind]) for at, kind in enumerate(KINDS)), now]
        return values, repr(values)  # tells 1 and true apart


def _row(system: TransitionSystem, step: Step) -> _Row:
    outputs = without_absent(step.outputs, stand_ins(system))
    told = {name: value for name, value in outputs.items() if value is not None}
    return present_inputs(system, step.inputs), step.fired, step.state, told


def _names(runs: Sequence[Shown], rows: Iterable[_Row]) -> dict[str, Sequence[str]]:
    """Return the names in all runs, by kind: inputs in the order of the declaration, others in order of appearance."""
    found = {kind: dict[str, None]() for kind in KINDS}
    for one in runs:
        found["state"].update(dict.fromkeys(one.trace.initial))
    for row in rows:
        for kind, values in zip(KINDS, row, strict=True):
            if not found[kind].keys() >= values.keys():
                found[kind].update(dict.fromkeys(values))
    declared = dict.fromkeys(var.name for one in runs for var in one.trace.system.inputs)
    names = {kind: list(of_a_kind) for kind, of_a_kind in found.items()}
    return {**names, "inputs": [name for name in declared if name in found["inputs"]]}


class _Beginnings:
    """The beginnings of the runs so far, as a tree: a step leads on from a node, which stands for all steps before it."""

    def __init__(self) -> None:
        self._next = dict[tuple[int, str], tuple[int, int]]()
        self._runs = 0

    def add(self, first: Sequence[Any], texts: Iterable[str]) -> list[int]:
        """Add a run, by its first state and the texts of its steps; return the number of an earlier one with the same beginning, and
        how many steps they share.
        """
        node, like, run = 0, [0, 0], self._runs
        for number, text in enumerate(chain([repr(first)], texts)):
            node, of = self._next.setdefault((node, text), (len(self._next) + 1, run))
            if of != run:
                like = [of, number]
        self._runs += 1
        return like


def _column(values: Sequence[Any]) -> _Column:
    """Return values, and how often each is repeated; 1 and true differ."""
    exact = all(type(value) is not int or abs(value) <= EXACT // 2 for value in values)
    column: _Column = []
    for value in _differences(values) if exact else map(_digits, values):
        if column and column[-2] == value and type(column[-2]) is type(value):
            column[-1] += 1
        else:
            column += [value, 1]
    return column


def _differences(values: Iterable[Any]) -> Iterator[Any]:
    """Yield the values; each whole number as its difference from the one before."""
    before = 0
    for value in values:
        if type(value) is int:
            yield value - before
            before = value
        else:
            yield value


def _digits(value: Any) -> Any:
    return str(value) if type(value) is int else value


def _exact(value: Any) -> Any:
    return value if abs(value or 0) <= EXACT else _digits(value)


def _numbered(columns: Iterable[_Column]) -> list[_Column | int]:
    """Return the columns; in place of one that equals an earlier one, the number of that."""
    first = dict[str, int]()
    return [
        column if (at := first.setdefault(repr(column), number)) == number else at
        for number, column in enumerate(columns)
    ]


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
        data = json.loads(read_script(existing(path), FUNCTION))
        if data["schema"] != _SCHEMA:
            raise StreamError(f"{path}: schema is {quoted(data['schema'])}; this version reads {_SCHEMA!r}.")
        return Runs(path, data)


class Runs:
    """The runs of a file, by the ids of the results that they show; they are unfolded when one is used."""

    def __init__(self, path: Path, data: Mapping[str, Any]) -> None:
        self._path, self._names, self._columns = path, data["names"], data["columns"]
        self._runs: Sequence[_Plain] = data["runs"]
        self._shown = {result: number for number, run in enumerate(self._runs) for result in run["results"]}
        if not all(isinstance(self._names[kind], list) for kind in KINDS):
            raise TypeError("lists of the names of columns were expected")

    def __contains__(self, result: str) -> bool:
        return result in self._shown

    def __iter__(self) -> Iterator[str]:
        """Iterate over the ids of all results that have a run."""
        return iter(self._shown)

    def plain(self, result: str) -> _Plain:
        """Return the run of a result in the form of reports: first values, and each step by kind; StreamError as `stream`."""
        with _flawless(self._path):
            run, table = self._found(result)
            kinds = [self._rows(table, kind) for kind in KINDS]
            steps = [dict(zip(KINDS, step, strict=True)) for step in zip(*kinds, strict=True)]
            return {"first": self._first(run), "steps": steps, "truth_mm": _truth_mm(table)}

    def stream(self, result: str) -> StepStream:
        """Return the inputs of the run of a result as a stream for `replay`. StreamError if the file has no run of it."""
        with _flawless(self._path):
            run, table = self._found(result)
            truth = _truth_mm(table) or repeat(None, len(table))
            steps = tuple(
                step if value is None else {**step, "truth_mm": value}
                for step, value in zip(self._rows(table, "inputs"), truth, strict=True)
            )
            columns = {name: 1 for step in steps for name in step}
            return StepStream(steps, tuple(range(1, len(steps) + 1)), self._first(run), str(run["machine"]), columns)

    def _found(self, result: str) -> tuple[_Plain, _Table]:
        """Return the run of a result, and its steps as the values of all columns."""
        if result not in self._shown:
            known = ", ".join(map(repr, islice(self, 5))) + (", ..." if len(self._shown) > 5 else "")
            raise StreamError(f"{self._path}: no run of {quoted(result)}; it holds {len(self._shown)}: {known}.")
        number = self._shown[result]
        run = self._runs[number]
        refuse_beyond(self._path, run["steps"], MOST_ROWS, "steps")
        refuse_beyond(self._path, run["steps"] * self._width, MOST_CELLS, "cells")
        return run, self._table(number)

    @property
    def _width(self) -> int:
        return 1 + sum(map(len, self._names.values()))

    @cached_property
    def _places(self) -> list[int]:
        """The first place of each run's kept steps, and the end of the last run's."""
        for number, run in enumerate(self._runs):
            of, shared = run["like"]
            whole = type(of) is int and type(shared) is int and 0 <= of <= max(number - 1, 0)
            most = min(run["steps"], self._runs[of]["steps"] if number else 0) if whole else -1
            if not 0 <= shared <= most:
                raise ValueError(f"run {number} begins like run {of} for {shared} steps")
        return list(accumulate((run["steps"] - run["like"][1] for run in self._runs), initial=0))

    @cached_property
    def _kept(self) -> _Table:
        """The kept steps of all runs, each as the values of all columns."""
        steps = self._places[-1]
        refuse_beyond(self._path, steps * self._width, MOST_CELLS, "cells")
        if len(self._columns) != self._width:
            raise ValueError(f"{len(self._columns)} columns of {self._width}")
        fired = range(len(self._names["inputs"]), len(self._names["inputs"]) + len(self._names["fired"]))
        columns = [_unfolded(self._column(at), steps, words=at in fired) for at in range(self._width)]
        return list(zip(*columns, strict=True))

    def _column(self, number: int) -> _Column:
        column = self._columns[number]
        if type(column) is int:
            if not 0 <= column < number:
                raise ValueError(f"column {number} equals column {column}")
            column = self._columns[column]
        if not isinstance(column, list):
            raise TypeError(f"column {number} is no list")
        return column

    def _table(self, number: int) -> _Table:
        """Return the steps of a run: those it shares with earlier runs, and its own."""
        pieces, wanted = list[_Table](), self._runs[number]["steps"]
        while wanted:
            of, shared = self._runs[number]["like"]
            at = self._places[number]
            pieces.append(self._kept[at : at + max(wanted - shared, 0)])
            number, wanted = of, min(wanted, shared)
        return [*chain.from_iterable(reversed(pieces))]

    def _first(self, run: _Plain) -> dict[str, Value]:
        pairs = zip(self._names["state"], run["first"], strict=True)
        return {name: _whole(value) for name, value in pairs if value is not None}

    def _rows(self, table: _Table, kind: str) -> Iterator[dict[str, Any]]:
        at = sum(len(self._names[before]) for before in KINDS[: KINDS.index(kind)])
        names = self._names[kind]
        rows = (row[at : at + len(names)] for row in table)
        return ({name: cell for name, cell in zip(names, row, strict=True) if cell is not None} for row in rows)


def _truth_mm(table: _Table) -> list[int | None]:
    """Return the true positions; an empty list if none is known."""
    values = [row[-1] for row in table]
    return [] if all(value is None for value in values) else values


def _unfolded(column: _Column, steps: int, *, words: bool) -> list[Any]:
    """Return the values of a column over all kept steps; `words` are names of transitions, no digits."""
    counts = column[1::2]
    if len(column) % 2 or any(type(count) is not int or count < 1 for count in counts) or sum(counts) != steps:
        raise ValueError(f"a column of {sum(counts)} steps where there are {steps}")
    values = chain.from_iterable(map(repeat, column[::2], counts))
    return list(values) if words else list(_summed(values))


def _summed(values: Iterable[Any]) -> Iterator[Any]:
    """Yield the values again of which these are the differences."""
    now = 0
    for value in values:
        if type(value) is int:
            now += value
            yield now
        else:
            yield _whole(value)


def _whole(value: Any) -> Any:
    return int(value) if isinstance(value, str) else value
