"""The report folder: the page, the data, JUnit XML, certificates and traces. The only place that writes it."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from jinja2 import UndefinedError

from safeloc.catalogue import Target
from safeloc.errors import InputError
from safeloc.report.data import SCHEMA, report_data
from safeloc.report.junit import to_junit
from safeloc.report.page import file_name, to_html
from safeloc.results import Finding
from safeloc.streams.steps import write_steps
from safeloc.trace import Trace
from safeloc.verdict import Proved, Violated

DATA = "report.json"
EVIDENCE = {"certificates": "*.smt2", "traces": "*.jsonl"}


def write_folder(folder: Path, findings: Sequence[Finding], targets: Sequence[Target]) -> Path:
    """Write everything and return the path of the page. Evidence of an earlier report in this folder is removed.

    Raises InputError where the folder cannot be written.
    """
    data = report_data(findings, targets)
    try:
        _clear(folder)
        for name in EVIDENCE:
            (folder / name).mkdir(parents=True, exist_ok=True)
        (folder / DATA).write_text(json.dumps(data, indent=1), encoding="utf-8")
        (folder / "junit.xml").write_text(to_junit(findings), encoding="utf-8")
        for finding in findings:
            _evidence(folder, finding)
        return _write_page(folder, data)
    except OSError as error:
        raise InputError(f"{folder}: the report cannot be written here: {error}") from error


def render_folder(folder: Path) -> Path:
    """Write the page again from the report.json in the folder; InputError where that is no report of this version."""
    path = folder / DATA
    try:
        data = json.loads(path.read_text(encoding="utf-8"))
    except (OSError, ValueError) as error:
        raise InputError(f"{path}: cannot be read as a report: {error}") from error
    if not isinstance(data, dict) or data.get("schema") != SCHEMA:
        raise InputError(f"{path}: not a report of schema {SCHEMA}; write it with `safeloc verify --out {folder}`.")
    try:
        return _write_page(folder, data)
    except (KeyError, TypeError, UndefinedError) as error:
        raise InputError(f"{path}: does not keep to schema {SCHEMA}: {error}") from error


def _write_page(folder: Path, data: Mapping[str, Any]) -> Path:
    page = folder / "index.html"
    page.write_text(to_html(data), encoding="utf-8")
    return page


def _clear(folder: Path) -> None:
    """Remove evidence that belongs to an earlier report; nothing where there is no report."""
    if not (folder / DATA).is_file():
        return
    for name, pattern in EVIDENCE.items():
        for path in (folder / name).glob(pattern):
            path.unlink()


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
