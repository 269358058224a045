"""The report as one self-contained HTML page: text in, text out."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from jinja2 import Environment, StrictUndefined
from markupsafe import Markup

from safeloc.backends.diagram import to_svg, to_table
from safeloc.catalogue import Target
from safeloc.checks import input_variables
from safeloc.expr import NumVar, Var
from safeloc.machine import Machine
from safeloc.render import infix
from safeloc.report.plot import line_chart
from safeloc.results import Finding
from safeloc.trace import Trace, present_inputs, shown
from safeloc.units import Enumeration
from safeloc.verdict import Violated

TEMPLATE = Path(__file__).with_name("page.html.jinja")


def to_html(data: Mapping[str, Any], findings: Sequence[Finding], targets: Sequence[Target]) -> str:
    """The page. `data` is what `report_data` returned for the same findings and targets."""
    environment = Environment(autoescape=True, undefined=StrictUndefined, trim_blocks=True, lstrip_blocks=True)
    template = environment.from_string(TEMPLATE.read_text(encoding="utf-8"))
    counts = {
        key: sum(row["verdict"] == key for row in data["results"]) for key in ("proved", "held", "unknown", "violated")
    }
    rows = {row["id"]: row for row in data["results"]}
    return template.render(
        data=data,
        counts=counts,
        machines=[_machine(target, data["results"]) for target in targets],
        violated=[_violated(finding, rows[finding.id]) for finding in findings if isinstance(finding.result, Violated)],
    )


def file_name(finding_id: str) -> str:
    """A file name for a finding's trace or certificate."""
    return "".join(letter if letter.isalnum() else "-" for letter in finding_id)


def _machine(target: Target, results: Sequence[Mapping[str, Any]]) -> dict[str, Any]:
    own = [{**row, "name": row["id"].split("/", 2)[-1]} for row in results if row["machine"] == target.name]
    configuration = None if target.config is None else json.dumps(target.config.model_dump(mode="json"), indent=2)
    return {
        "name": target.name,
        "doc": target.doc,
        "rows": [row for row in own if row["kind"] in ("property", "replay")],
        "tests": [row for row in own if row["kind"] == "test"],
        "obligations": [row for row in own if row["kind"] in ("obligation", "lemma")],
        "parts": [_part(machine) for machine in target.machines],
        "configuration": configuration,
    }


def _part(machine: Machine) -> dict[str, Any]:
    kinds: list[tuple[str, Sequence[Var]]] = [
        ("input", input_variables(machine)),
        ("state", list(machine.state)),
        ("ghost", [*machine.ghosts, *machine.ghost_inputs]),
    ]
    return {
        "name": machine.name,
        "svg": Markup(to_svg(machine)),  # noqa: S704 # our own text, every label in it is escaped
        "table": to_table(machine),
        "variables": [_variable(kind, var) for kind, variables in kinds for var in variables],
        "assumption": infix(machine.assumption, 4000),
    }


def _variable(kind: str, var: Var) -> dict[str, str]:
    if not isinstance(var, NumVar):
        return {"name": var.name, "kind": kind, "unit": "", "range": "true, false"}
    if isinstance(var.unit, Enumeration):
        return {"name": var.name, "kind": kind, "unit": "", "range": ", ".join(var.unit.members)}
    return {"name": var.name, "kind": kind, "unit": var.unit.name, "range": f"{var.low} .. {var.high}"}


# ------------------------------------------------------------------ violated properties


def _violated(finding: Finding, row: Mapping[str, Any]) -> dict[str, Any]:
    assert isinstance(finding.result, Violated)
    trace = finding.result.trace
    charts = "" if trace is None else _charts(trace)
    return {
        "row": row,
        "charts": Markup(charts),  # noqa: S704 # our own text, every label in it is escaped
        "steps": [] if trace is None else _steps(trace),
        "file": f"traces/{file_name(finding.id)}.jsonl",
    }


def _steps(trace: Trace) -> list[dict[str, Any]]:
    before = dict(trace.initial)
    rows = [{"number": 0, "fired": "start", "inputs": "", "changed": _values(trace, before)}]
    for number, step in enumerate(trace.steps, 1):
        changed = {name: value for name, value in step.state.items() if before[name] != value}
        inputs = _values(trace, present_inputs(trace.system, step.inputs))
        fired = ", ".join(step.fired.values())
        rows.append({"number": number, "fired": fired, "inputs": inputs, "changed": _values(trace, changed)})
        before = dict(step.state)
    return rows


def _values(trace: Trace, values: Mapping[str, Any]) -> str:
    return "  ".join(f"{name}={shown(trace.system.variable(name), value)}" for name, value in values.items())


def _charts(trace: Trace) -> str:
    """Truth, reported position and margins where the machine has them; otherwise what changed most."""
    if {"position_mm", "over_mm", "under_mm"} <= set(trace.system.outputs):
        return _position_chart(trace)
    names = [
        var.name for var in trace.system.state if isinstance(var, NumVar) and not isinstance(var.unit, Enumeration)
    ]
    moving = sorted(names, key=lambda name: -_spread(trace, name))[:3]
    return "".join(
        line_chart(name, trace.system.variable(name).unit.name, {name: _series(trace, name)})  # type: ignore[union-attr]
        for name in moving
        if _spread(trace, name)
    )


def _series(trace: Trace, name: str) -> list[float | None]:
    return [float(trace.initial[name]), *(float(step.state[name]) for step in trace.steps)]


def _spread(trace: Trace, name: str) -> float:
    values = [value for value in _series(trace, name) if value is not None]
    return max(values) - min(values)


def _position_chart(trace: Trace) -> str:
    truth = [value / 1e6 if value is not None else None for value in _series(trace, "truth_nm")]
    valid = [False, *(bool(step.outputs.get("valid", True)) for step in trace.steps)]
    outs = [None, *(step.outputs for step in trace.steps)]
    position, low, high = list[float | None](), list[float | None](), list[float | None]()
    for ok, out in zip(valid, outs, strict=True):
        usable = ok and out is not None
        position.append(float(out["position_mm"]) if usable and out else None)
        low.append(float(out["position_mm"] - out["under_mm"]) if usable and out else None)
        high.append(float(out["position_mm"] + out["over_mm"]) if usable and out else None)
    origin = next((value for value in truth if value is not None), 0.0)
    lines = {"truth": _shift(truth, origin), "reported position": _shift(position, origin)}
    chart = line_chart("truth and interval", "mm", lines, (_shift(low, origin), _shift(high, origin)))
    margins = {"over": _gap(high, position), "under": _gap(position, low)}
    return chart + line_chart("margins", "mm", margins)


def _shift(series: Sequence[float | None], origin: float) -> list[float | None]:
    return [None if value is None else value - origin for value in series]


def _gap(upper: Sequence[float | None], lower: Sequence[float | None]) -> list[float | None]:
    return [None if a is None or b is None else a - b for a, b in zip(upper, lower, strict=True)]
