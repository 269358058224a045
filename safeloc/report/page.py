"""The report as one self-contained HTML page, from the report's data alone: text in, text out."""

from __future__ import annotations

import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from jinja2 import Environment, StrictUndefined
from markupsafe import Markup

from safeloc.report.traces import trace_charts, trace_rows

TEMPLATE = Path(__file__).with_name("page.html.jinja")
VERDICTS = ("proved", "held", "unknown", "violated")
Data = Mapping[str, Any]


def to_html(data: Data) -> str:
    """The page of what `report_data` returned, or of a report.json that was read back."""
    environment = Environment(autoescape=True, undefined=StrictUndefined, trim_blocks=True, lstrip_blocks=True)
    template = environment.from_string(TEMPLATE.read_text(encoding="utf-8"))
    results = data["results"]
    machines = {machine["name"]: machine for machine in data["machines"]}
    return template.render(
        data=data,
        verdicts={row["id"]: row["verdict"] for row in results},
        counts={verdict: sum(row["verdict"] == verdict for row in results) for verdict in VERDICTS},
        machines=[_machine(machine, data) for machine in data["machines"]],
        undecided=[row for row in results if row["verdict"] == "unknown"],
        violated=[_violated(row, machines[row["machine"]]) for row in results if row["verdict"] == "violated"],
    )


def file_name(finding_id: str) -> str:
    """A file name for a finding's trace or certificate."""
    return "".join(letter if letter.isalnum() else "-" for letter in finding_id)


def _machine(machine: Data, data: Data) -> dict[str, Any]:
    own = [_named(row) for row in data["results"] if row["machine"] == machine["name"]]
    configuration = machine["configuration"]
    return {
        **machine,
        "rows": [row for row in own if row["kind"] == "property"],
        "replays": [row for row in own if row["kind"] == "replay"],
        "tests": [row for row in own if row["kind"] == "test"],
        "obligations": [row for row in own if row["kind"] in ("obligation", "lemma")],
        "parts": [{**part, "svg": Markup(part["svg"])} for part in machine["parts"]],  # labels are escaped
        "configuration": None if configuration is None else json.dumps(configuration, indent=2),
    }


def _named(row: Data) -> dict[str, Any]:
    """`notes_text` groups tests that were made in the same runs."""
    return {**row, "name": row["id"].split("/", 2)[-1], "notes_text": json.dumps(row["notes"])}


def _violated(row: Data, machine: Data) -> dict[str, Any]:
    trace = row["trace"]
    charts = "" if trace is None else trace_charts(trace, machine)
    return {
        "row": row,
        "charts": Markup(charts),  # our own text, every label in it is escaped
        "steps": [] if trace is None else trace_rows(trace, machine["signals"]),
        "file": f"traces/{file_name(row['id'])}.jsonl",
    }
