"""Tests and replays of a machine for the page: a row for each recording, and a row for each statement with where it held.

A table with a column for each recording is wider than a sheet of paper and than a phone.
"""

from __future__ import annotations

import json
from collections.abc import Callable, Collection, Iterable, Iterator, Mapping, Sequence
from pathlib import PurePath
from typing import Any

from safeloc.runtime.streams.gzipped import name_of

_TESTS = "property tests"
_NOT_APPLICABLE = "not applicable"
_Data = Mapping[str, Any]


def recordings(rows: Sequence[_Data], counted: Callable[[Sequence[_Data]], str]) -> list[dict[str, Any]]:
    """Return a row for the tests and for each recording: steps, verdicts, and the names of what did not hold.

    counted  says how many results have which verdict
    """
    sources: dict[str, list[_Data]] = {}
    for row in rows:
        sources.setdefault(_source(row), []).append(row)
    return [
        {
            "source": source,
            "steps": max(row["depth"] for row in found),
            "found": counted(found),
            "others": [row["name"] for row in found if row["verdict"] != "held"],
        }
        for source, found in sources.items()
    ]


def statements(rows: Sequence[_Data]) -> list[dict[str, Any]]:
    """Return a row for each statement: in which runs it has which verdict, with what the replays note, and where it is not applicable.

    It has the places of its results that did not hold: pages lead to each of them.
    """
    every = list(dict.fromkeys(_source(row) for row in rows))
    found: dict[str, dict[str, Any]] = {}
    for row in rows:
        source = _source(row)
        name = row["name"].removeprefix(f"{name_of(PurePath(source))}: ")
        one = found.setdefault(name, {"name": name, "statement": row["statement"], "by_source": {}})
        one["by_source"][source] = row
    return [
        {**one, "found": list(_alike(one["by_source"], every)), "places": _places(one["by_source"].values())}
        for one in found.values()
    ]


def _places(rows: Iterable[_Data]) -> list[str]:
    return [row["at"] for row in rows if row["verdict"] != "held"]


def _alike(by_source: Mapping[str, _Data], every: Sequence[str]) -> Iterator[dict[str, Any]]:
    """Yield verdict and notes that several runs have in common, each with the names of the runs."""
    groups: dict[str, dict[str, Any]] = {}
    for source, row in by_source.items():
        notes = {} if source == _TESTS else row["notes"]  # those of the tests stand once, below
        key = json.dumps([row["verdict"], notes])
        groups.setdefault(key, {"verdict": row["verdict"], "notes": notes, "sources": []})["sources"].append(source)
    left = [source for source in every if source not in by_source]
    if left:
        groups[""] = {"verdict": _NOT_APPLICABLE, "notes": {}, "sources": left}
    for group in groups.values():
        yield {**group, "where": _where(group["sources"], every)}


def _where(sources: Collection[str], every: Sequence[str]) -> str:
    """Return the names of the runs; if they are most of many, the names of the others."""
    others = [source for source in every if source not in sources]
    if not others and len(every) > 1:
        return f"all {len(every)}"
    if len(others) < len(every) / 3:
        return f"all {len(every)} but {', '.join(others)}"
    return ", ".join(sources)


def _source(row: _Data) -> str:
    return str(row["method"]).removeprefix("replay of ") if row["kind"] == "replay" else _TESTS
