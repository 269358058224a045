"""`safeloc audit`: check the layout of a line against the assumptions of the proofs."""

from __future__ import annotations

from typing import Annotated

import typer

from safeloc.cli.console import print_json, print_line
from safeloc.railway.audit import audit
from safeloc.railway.audit.findings import AuditReport, as_folded_text
from safeloc.railway.audit.vehicle import find_layout
from safeloc.railway.map.toml_files import find_line

_VIOLATED = 1
_SHOWN = 5
"""Findings of a rule; a real network may have thousands."""


def audit_line(
    line: Annotated[
        str, typer.Argument(help="file (TOML or JSON, see docs/line.md), or a shipped line: fig1, fig2, fig3")
    ],
    vehicles: Annotated[
        list[str] | None,
        typer.Option(
            "--vehicle",
            help="file with \\[localization], or a shipped vehicle (repeatable); by default, default figures",
        ),
    ] = None,
    every: Annotated[
        bool, typer.Option("--all", help=f"print every finding; by default, the {_SHOWN} heaviest of each rule")
    ] = False,
    as_json: Annotated[bool, typer.Option("--json", help="print JSON only: a list of safeloc-audit/1")] = False,
) -> None:
    """Check that the layout of a line satisfies the assumptions of the proofs. Exit code 1 where a rule is violated."""
    checked = find_line(line)
    reports = [audit(checked, find_layout(name), name) for name in vehicles] if vehicles else [audit(checked)]
    if as_json:
        print_json([report.as_data() for report in reports])
    else:
        for text in (text for report in reports for text in _lines(report, every)):
            print_line(text)
    raise typer.Exit(_VIOLATED if any(report.violated for report in reports) else 0)


def _lines(report: AuditReport, every: bool) -> list[str]:
    elements = ", ".join(f"{kind.replace('_', ' ')} {count}" for kind, count in report.elements.items())
    routes = "too many routes to compare each pair" if report.routes is None else f"{report.routes} routes"
    advice = len(report.findings) - len(report.violated)
    return [
        f"{report.line} version {report.version} for {report.vehicle}, {report.checksum}",
        f"{elements}; {routes}",
        *as_folded_text(report.findings, len(report.findings) if every else _SHOWN),
        *(
            ["", "routes, and missed or misread reflectors that make one look like another:"]
            if report.route_pairs
            else []
        ),
        *(f"  {pair.as_text()}" for pair in report.route_pairs),
        "",
        *(f"{count:7} x {rule}" for rule, count in report.cases.items()),
        f"{sum(report.cases.values())} cases, {len(report.violated)} violated, {advice} advice",
    ]
