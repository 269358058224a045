"""The report folder: the page, the data, JUnit XML, certificates and traces. The only place that writes it."""

from __future__ import annotations

import json
from collections.abc import Sequence
from pathlib import Path

from safeloc.catalogue import Target
from safeloc.report.data import report_data
from safeloc.report.junit import to_junit
from safeloc.report.page import file_name, to_html
from safeloc.results import Finding
from safeloc.streams.steps import write_steps
from safeloc.trace import Trace
from safeloc.verdict import Proved, Violated


def write_folder(folder: Path, findings: Sequence[Finding], targets: Sequence[Target]) -> Path:
    """Write everything and return the path of the page. Files of an earlier run with other names stay."""
    data = report_data(findings, targets)
    for name in ("certificates", "traces"):
        (folder / name).mkdir(parents=True, exist_ok=True)
    (folder / "report.json").write_text(json.dumps(data, indent=1), encoding="utf-8")
    (folder / "junit.xml").write_text(to_junit(findings), encoding="utf-8")
    page = folder / "index.html"
    page.write_text(to_html(data, findings, targets), encoding="utf-8")
    for finding in findings:
        _evidence(folder, finding)
    return page


def _evidence(folder: Path, finding: Finding) -> None:
    match finding.result:
        case Proved(certificates=certificates, witness=witness):
            for name, text in certificates.items():
                (folder / "certificates" / name).write_text(text, encoding="utf-8")
            save_trace(folder, finding.id, witness)
        case Violated(trace=trace):
            save_trace(folder, finding.id, trace)
        case _:
            pass


def save_trace(folder: Path, name: str, trace: Trace | None) -> None:
    """A trace as a stream that `replay` takes."""
    if trace is not None:
        path = folder / "traces" / f"{file_name(name)}.jsonl"
        write_steps(path, trace.stream(), machine=trace.system.name, first=trace.initial)
