"""Data for the search of the report's page: every result, requirement, assumption and transition, in one script.

Words that occur in many rows are kept once: a row names them by number.
"""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping
from typing import Any

from safeloc.report.conditions import needs
from safeloc.report.links import Links, anchor
from safeloc.report.verdict_words import requirement_verdict, told_of
from safeloc.runtime.scripts import script

RESULTS = "results.js"
_FUNCTION = "safelocResults"
_Data = Mapping[str, Any]
_Row = list[Any]


def results_text(data: _Data, links: Links) -> str:
    """Return the data as JSON: the words, and the rows that name them."""
    words = dict[str, int]()
    rows = [
        [*(words.setdefault(word, len(words)) for word in row[:8]), *row[8:]]
        for row in (*_results(data, links), *_requirements(data), *_laws(data, links), *_transitions(data, links))
    ]
    return json.dumps({"words": list(words), "rows": rows}, separators=(",", ":"))


def results_script(text: str, made: str) -> str:
    """Return the script with these data (`results_text`); `made` is the digest of the report that it belongs to."""
    return script(_FUNCTION, "all", data=f'{{"made":{json.dumps(made)},{text[1:]}'.encode())


def _row(
    words: tuple[str, str, str, str],
    *,
    statement: str = "",
    method: str = "",
    assumption: str = "",
    reason: str = "",
    requirements: list[str] | None = None,
    laws: list[str] | None = None,
    certificates: list[tuple[str, str]] | None = None,
    steps: int | None = None,
    at: str = "",
    declared: str = "",
    source: str = "",
) -> _Row:
    """Return a row: machine, kind, verdict and name; what is said of it; and where its evidence is found.

    steps   of its run, if it has one
    at      its place on the page; `source` that of its source lines
    """
    said = [statement, method, assumption, reason, requirements or [], laws or []]
    return [*words, *said, certificates or [], steps, at, declared, source]


def _results(data: _Data, links: Links) -> Iterator[_Row]:
    needed = {machine["name"]: needs(machine) for machine in data["machines"]}
    for row in data["results"]:
        name, to = row["id"].split("/", 2)[-1], links.of(row)
        shown = row["kind"] not in ("test", "replay") or row["verdict"] != "held"  # one that held is a cell of a table
        yield _row(
            (row["machine"], row["kind"], told_of(row), name),
            statement=row["statement"],
            method=row["method"],
            assumption=row["assumption"],
            reason=row["reason"],
            requirements=row["requirements"],
            laws=list(needed.get(row["machine"], {}).get(name) or []),
            certificates=[one for one in to["evidence"] if not one[0].startswith("#")],
            steps=data.get("runs", {}).get(row["id"]),
            at=to["at"] if shown else row["machine"],
            declared=to["declared"],
            source=to["source"],
        )


def _requirements(data: _Data) -> Iterator[_Row]:
    results = {row["id"]: row for row in data["results"]}
    for one in data["requirements"]:
        if one["transitions"] or one["results"]:
            verdict = requirement_verdict(one["verdict"], {told_of(results[name]) for name in one["results"]})
            words = (one["machine"], "requirement", verdict, one["id"])
            yield _row(words, statement=one["text"], method=one["source"], at=one["id"])


def _laws(data: _Data, links: Links) -> Iterator[_Row]:
    for machine in data["machines"]:
        places = links.sources(machine, ())["laws"]
        for part in machine["parts"]:
            for law in part["clauses"]:
                yield _row(
                    (machine["name"], "assumption", "", f"{law['id']} {law['name']}"),
                    statement=law["statement"],
                    method=", ".join(filter(None, [law["owner"], law["source"]])),
                    at=anchor("law", machine["name"], law["id"]),
                    declared=law.get("declared", ""),
                    source=places.get((part["name"], law["name"]), ""),
                )


def _transitions(data: _Data, links: Links) -> Iterator[_Row]:
    for machine in data["machines"]:
        places = links.sources(machine, ())["transitions"]
        for part in machine["parts"]:
            for row in part["table"]:
                yield _row(
                    (machine["name"], "transition", "", row["name"]),
                    statement=f"{part['name']}: {row['source']} to {row['target']}",
                    requirements=row["requirements"],
                    declared=row["declared"],
                    source=places.get((part["name"], row["name"]), ""),
                )
