"""The data of a report in files: splitting them for the report folder, and reading them again.

report.json               verdicts, requirements, and the certificates of each result, by number
machines/MACHINE.json.xz  content of the page on a machine: transitions, variables, terms, pictures (`xz -dc FILE`)
machines/MACHINE.js       the machine itself as a script, with which the page explains its runs
traces/MACHINE.js         runs in columns, in a script (safeloc.runtime.streams.columns)
certificates/             safeloc.report.certificates
"""

from __future__ import annotations

import json
from collections.abc import Callable, Iterable, Mapping, Sequence
from itertools import chain
from pathlib import Path
from typing import Any, TypeVar

from safeloc.errors import InputError, SafelocError
from safeloc.report.data import SCHEMA
from safeloc.report.file_names import file_names
from safeloc.runtime.outside import shortened
from safeloc.runtime.packed import read_packed
from safeloc.runtime.streams.columns import Runs, read_runs

DATA = "report.json"
MACHINES, TRACES = "machines", "traces"
SUFFIX, RUNS = ".json.xz", ".js"
_BULKY = ("parts", "pictures", "signals", "figures", "evidence", "declared")
_SAID_ONCE: Mapping[str, type] = {"statement": str, "method": str, "assumption": str, "requirements": list}
"""Words of a result, and lists of ids, that others have as well: report.json has them once."""
_OMITTED: Mapping[str, Any] = {
    "by_construction": "", "reason": "", "notes": {}, "rechecked": [], "certificates": [], "requirements": [], "assumption": "", "trace": None,
}  # fmt: skip
"""Fields of a result that report.json has only where they say something, and what they are elsewhere."""
Data = dict[str, Any]
_T = TypeVar("_T")
_Said = str | list[str]


def split_data(
    data: Data, certificates: Mapping[str, Sequence[str]], runs: Mapping[str, int]
) -> tuple[Data, dict[str, str]]:
    """Return the content of report.json, and that of the files of machines by name, before it is packed.

    certificates  file -> names of the texts in it
    runs          id of a result -> number of steps of its run in the folder of traces
    """
    numbers = {name: number for number, name in enumerate(chain.from_iterable(certificates.values()))}
    places = {row["id"]: number for number, row in enumerate(data["results"])}
    said: dict[str, dict[str, int]] = {field: {} for field in _SAID_ONCE}
    files = _machine_files(data)
    small = {
        **data,
        "machines": [{key: part for key, part in one.items() if key not in _BULKY} for one in data["machines"]],
        "results": [
            _telling(
                {
                    **row,
                    **{field: _once(said[field], row[field], number) for field in _SAID_ONCE},
                    "certificates": [numbers[name] for name in row["certificates"]],
                    "trace": {"steps": runs[row["id"]]} if row["id"] in runs else None,
                }
            )
            for number, row in enumerate(data["results"])
        ],
        "requirements": [{**one, "results": [places[name] for name in one["results"]]} for one in data["requirements"]],
        "certificates": {file: list(names) for file, names in certificates.items()},
    }
    bulky = {files[one["name"]]: _text({key: one[key] for key in _BULKY}) for one in data["machines"]}
    return small, bulky


def _telling(row: Data) -> Data:
    """Return a result without the fields that say nothing; 0 is the number of a result, and says something."""
    return {key: value for key, value in row.items() if key not in _OMITTED or value != _OMITTED[key]}


def _once(said: dict[str, int], words: _Said, number: int) -> _Said | int:
    """Return the words of a result; in place of those that an earlier result has as well, the number of that result."""
    first = said.setdefault(json.dumps(words), number) if words else number
    return words if first == number else first


def _text(data: Any) -> str:
    return json.dumps(data, separators=(",", ":"))


def report_text(small: Data) -> str:
    """Return the text of report.json, with a line for each machine, result, requirement and item."""
    lines = (f"{json.dumps(key)}:{_listed(value)}" for key, value in small.items())
    return "{" + ",\n".join(lines) + "}\n"


def _listed(value: Any) -> str:
    if not isinstance(value, list):
        return json.dumps(value, separators=(",", ":"))
    return "[" + ",\n".join(json.dumps(one, separators=(",", ":")) for one in value) + "]"


def machine_names(data: Mapping[str, Any]) -> dict[str, str]:
    """Return the name of the files of each machine, which is the same in all folders, without suffix."""
    return names_of_files((one["name"] for one in data["machines"]), (row["machine"] for row in data["results"]))


def names_of_files(targets: Iterable[str], of_results: Iterable[str]) -> dict[str, str]:
    """Return the same for the names of targets and of the machines that results are of."""
    return file_names([*targets, *of_results])


def _machine_files(data: Mapping[str, Any]) -> dict[str, str]:
    """Return the name of each machine's file of data."""
    return {name: file + SUFFIX for name, file in machine_names(data).items()}


def runs_files(data: Mapping[str, Any]) -> dict[str, str]:
    """Return the name of each machine's file of runs."""
    return {name: file + RUNS for name, file in machine_names(data).items()}


# ------------------------------------------------------------------ read


def read_report(folder: Path) -> Data:
    """Return the content of report.json, with names and words instead of numbers.

    InputError if it is no report of this version.
    """
    path = folder / DATA
    try:
        data = json.loads(path.read_text(encoding="utf-8"))
    except RecursionError as error:
        raise InputError(f"{path}: nested too deeply to be a report.") from error
    except (OSError, ValueError) as error:
        raise InputError(f"{path}: cannot be read as a report: {error}") from error
    if not isinstance(data, dict) or data.get("schema") != SCHEMA:
        raise InputError(f"{path}: not a report of schema {SCHEMA}; write it with `safeloc verify --out {folder}`.")
    return checked(path, lambda: _named(data))


def checked(path: Path, read: Callable[[], _T]) -> _T:
    """Return the result of `read`; InputError if it fails on data that do not fit the schema."""
    try:
        return read()
    except SafelocError:
        raise
    except (KeyError, TypeError, ValueError, IndexError, AttributeError) as error:
        raise InputError(f"{path}: does not fit schema {SCHEMA}: {shortened(error)}") from error


def _named(data: Data) -> Data:
    """Return the data with names instead of numbers."""
    names = list(chain.from_iterable(data["certificates"].values()))
    ids = [row["id"] for row in data["results"]]
    rows = [{**_OMITTED, **row} for row in data["results"]]
    said = {field: [row[field] for row in rows] for field in _SAID_ONCE}
    return {
        **data,
        "results": [
            {
                **row,
                **{field: _said(said[field], row[field], kind) for field, kind in _SAID_ONCE.items()},
                "certificates": _at(names, row["certificates"]),
            }
            for row in rows
        ],
        "requirements": [{**row, "results": _at(ids, row["results"])} for row in data["requirements"]],
    }


def _said(said: Sequence[_Said | int], words: _Said | int, kind: type) -> _Said:
    """Return words, or a list of ids, that stand here or with an earlier result."""
    found = said[words] if type(words) is int and words >= 0 else words
    if isinstance(found, int) or not isinstance(found, kind):
        raise ValueError(f"no result {words} with words of its own")
    return found


def _at(names: Sequence[str], places: Sequence[int]) -> list[str]:
    """Return the names at these places; IndexError for a place out of range, also below 0."""
    if any(place < 0 for place in places):
        raise IndexError("a place below 0")
    return [names[place] for place in places]


def read_for_page(folder: Path) -> Data:
    """Return all data of the page: the report, its machines, and the runs of violated results."""
    data = read_report(folder)
    return checked(folder / DATA, lambda: _put_together(folder, data))


def _put_together(folder: Path, data: Data) -> Data:
    files, runs_of = _machine_files(data), runs_files(data)
    machines = [{**one, **_machine(folder / MACHINES / files[one["name"]])} for one in data["machines"]]
    read: dict[str, Runs] = {}
    rows = []
    runs = {row["id"]: row["trace"]["steps"] for row in data["results"] if row["trace"] is not None}
    for row in data["results"]:
        trace = None
        if row["trace"] is not None and row["verdict"] == "violated":
            file = runs_of[row["machine"]]
            if file not in read:
                read[file] = read_runs(folder / TRACES / file)
            trace = read[file].plain(row["id"])
        rows.append({**row, "trace": trace})
    scripts = [name for name, file in runs_files(data).items() if (folder / MACHINES / file).is_file()]
    return {**data, "machines": machines, "results": rows, "runs": runs, "scripts": scripts}


def _machine(path: Path) -> Data:
    """Read a machine's file; InputError with its name if the content is wrong."""
    content = read_packed(path)

    def read() -> Data:
        data = json.loads(content)
        return {key: data[key] for key in _BULKY}

    return checked(path, read)
