"""The report as one self-contained HTML page, from the report's data alone: text in, text out."""

from __future__ import annotations

import json
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from itertools import count
from pathlib import Path, PurePath
from typing import Any

from jinja2 import Environment, StrictUndefined
from markupsafe import Markup

from safeloc.report.headline import ALWAYS_COUNTED, BEST_FIRST, Said, counted, headline
from safeloc.report.traces import trace_charts, trace_rows

TEMPLATE = Path(__file__).with_name("page.html.jinja")
LONGEST_NAME = 150
LONGEST_RUN, LAST_STEPS = 40, 20
"""A longer run is folded but for its last steps."""
SUMMARY: Mapping[str, tuple[str, ...]] = {
    "properties": ("property",),
    "obligations and lemmas": ("obligation", "lemma"),
    "property tests": ("test",),
    "replayed recordings": ("replay",),
}
Data = Mapping[str, Any]


def to_html(data: Data) -> str:
    """The page of what `report_data` returned, or of a report.json that was read back."""
    environment = Environment(autoescape=True, undefined=StrictUndefined, trim_blocks=True, lstrip_blocks=True)
    template = environment.from_string(TEMPLATE.read_text(encoding="utf-8"))
    results = data["results"]
    machines = {machine["name"]: machine for machine in data["machines"]}
    files = file_names([row["id"] for row in results])
    shown = _shown_before(data["machines"])
    return template.render(
        data=data,
        headline=headline(_said(results)),
        counted=counted(_said(results), ALWAYS_COUNTED),
        machines=[_machine(machine, results, shown) for machine in data["machines"]],
        undecided=[row for row in results if row["verdict"] == "unknown"],
        empty=[row for row in results if row["verdict"] in ("vacuous", "not asked")],
        violated=[_violated(row, machines[row["machine"]], files) for row in results if row["verdict"] == "violated"],
        requirements=_requirements(data),
    )


def file_names(finding_ids: Sequence[str]) -> dict[str, str]:
    """A file name for each finding's trace: readable, and never the same for two, also where case does not count."""
    names: dict[str, str] = {}
    taken: set[str] = set()
    for one in dict.fromkeys(finding_ids):
        plain = "".join(letter if letter.isascii() and letter.isalnum() else "-" for letter in one)[:LONGEST_NAME]
        name = next(name for name in _numbered(plain) if name.casefold() not in taken)
        taken.add(name.casefold())
        names[one] = name
    return names


def _numbered(plain: str) -> Iterator[str]:
    yield plain
    yield from (f"{plain}-{number}" for number in count(2))


def _shown_before(machines: Sequence[Data]) -> dict[tuple[str, int], str]:
    """(target, number of its part) -> the target under which the very same machine is shown already."""
    first: dict[str, str] = {}
    again: dict[tuple[str, int], str] = {}
    for machine in machines:
        for number, part in enumerate(machine["parts"]):
            where = first.setdefault(json.dumps(part, sort_keys=True), machine["name"])
            if where != machine["name"]:
                again[machine["name"], number] = where
    return again


def _machine(machine: Data, results: Sequence[Data], shown: Mapping[tuple[str, int], str]) -> dict[str, Any]:
    own = [_named(row) for row in results if row["machine"] == machine["name"]]
    evidence = [row for row in own if row["kind"] in ("test", "replay")]
    return {
        **machine,
        "rows": [row for row in own if row["kind"] == "property"],
        "evidence": runs_table(evidence),
        "pictures": [{**one, "svg": Markup(one["svg"])} for one in machine["pictures"]],  # labels are escaped
        "tests": [row for row in evidence if row["kind"] == "test"],
        "obligations": [row for row in own if row["kind"] in ("obligation", "lemma")],
        "counts": [(name, _counted(own, kinds)) for name, kinds in SUMMARY.items()],
        "parts": [
            {
                **part,
                "svg": Markup(part["svg"]),
                "shown": shown.get((machine["name"], number), ""),
            }  # labels are escaped
            for number, part in enumerate(machine["parts"])
        ],
    }


def _said(rows: Sequence[Data]) -> list[Said]:
    return [Said(row["kind"], row["verdict"]) for row in rows]


def _counted(rows: Sequence[Data], kinds: Sequence[str]) -> str:
    """Such as `21 proved, 1 unknown`."""
    found = Counter(row["verdict"] for row in rows if row["kind"] in kinds)
    return ", ".join(f"{found[verdict]} {verdict}" for verdict in BEST_FIRST if found[verdict]) or "none"


def _named(row: Data) -> dict[str, Any]:
    """`notes_text` groups tests that were made in the same runs."""
    return {**row, "name": row["id"].split("/", 2)[-1], "notes_text": json.dumps(row["notes"])}


def runs_table(rows: Sequence[Data]) -> dict[str, Any]:
    """Tests and replays as one table: a row a statement, a column a campaign or recording, a cell its result."""
    sources = list(dict.fromkeys(_source(row) for row in rows))
    statements: dict[str, dict[str, Any]] = {}
    for row in rows:
        source = _source(row)
        name = row["name"].removeprefix(f"{PurePath(source).stem}: ")
        line = statements.setdefault(name, {"name": name, "statement": row["statement"], "cells": {}})
        line["cells"][source] = row
    steps = {source: max(row["depth"] for row in rows if _source(row) == source) for source in sources}
    return {"sources": [(source, steps[source]) for source in sources], "rows": list(statements.values())}


def _source(row: Data) -> str:
    return str(row["method"]).removeprefix("replay of ") if row["kind"] == "replay" else "property tests"


def _requirements(data: Data) -> dict[str, Any]:
    """Rows of the machines in this report, and of those that something in it names; the others are only counted."""
    present = {
        name for machine in data["machines"] for name in (machine["name"], *(p["name"] for p in machine["parts"]))
    }
    rows = [row for row in data["requirements"] if row["transitions"] or row["results"] or row["machine"] in present]
    results = {row["id"]: row for row in data["results"]}
    return {
        "rows": [{**row, "shown": _shown_by([results[name] for name in row["results"]])} for row in rows],
        "known": {row["id"] for row in rows},
        "others": len(data["requirements"]) - len(rows),
    }


def _shown_by(rows: Sequence[Data]) -> list[tuple[str, str]]:
    """(what, verdict): each property, and whatever did not hold; tests and replays that held as a number."""
    single = [row for row in rows if row["kind"] == "property" or row["verdict"] not in ("proved", "held")]
    listed = [(row["id"].replace("/property/", ": "), row["verdict"]) for row in single]
    for kind, word in (("test", "property tests"), ("replay", "replays")):
        number = sum(row["kind"] == kind and row not in single for row in rows)
        listed += [(f"{number} {word}", "held")] if number else []
    return listed


def _violated(row: Data, machine: Data, files: Mapping[str, str]) -> dict[str, Any]:
    trace = row["trace"]
    charts = "" if trace is None else trace_charts(trace, machine)
    steps = [] if trace is None else trace_rows(trace, machine["signals"])
    return {
        "row": row,
        "charts": Markup(charts),  # our own text, every label in it is escaped
        "steps": steps,
        "groups": [steps] if len(steps) <= LONGEST_RUN else [steps[:-LAST_STEPS], steps[-LAST_STEPS:]],
        "file": f"traces/{files[row['id']]}.jsonl",
    }
