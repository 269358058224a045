"""The report folder: the page, the data, JUnit XML, certificates and traces. The only place that writes it."""

from __future__ import annotations

import fcntl
import json
import os
import tempfile
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any, assert_never

from jinja2 import UndefinedError

from safeloc.catalogue import Target
from safeloc.errors import InputError
from safeloc.report.data import SCHEMA, report_data, schema
from safeloc.report.junit import to_junit
from safeloc.report.page import file_names, to_html
from safeloc.results import Finding
from safeloc.streams.steps import write_steps
from safeloc.trace import Trace
from safeloc.verdict import Held, NotAsked, Proved, Unknown, Vacuous, Violated

DATA = "report.json"
EVIDENCE = {"certificates": "*.smt2", "traces": "*.jsonl"}


def usable(folder: Path) -> None:
    """InputError if no report can be written here: better told before the proofs than after."""
    try:
        folder.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryFile(dir=folder):
            pass
    except OSError as error:
        raise InputError(f"{folder}: the report cannot be written here: {error}") from error


def write_folder(folder: Path, findings: Sequence[Finding], targets: Sequence[Target]) -> Path:
    """Write everything and return the path of the page. Evidence of an earlier report in this folder is removed.

    Of two runs that write into one folder at once the second waits, so that the report is always of one run.
    Raises InputError where the folder cannot be written.
    """
    data = report_data(findings, targets)
    try:
        folder.mkdir(parents=True, exist_ok=True)
        with _alone(folder):
            _clear(folder)
            for name in EVIDENCE:
                (folder / name).mkdir(exist_ok=True)
            (folder / DATA).write_text(json.dumps(data, indent=1), encoding="utf-8")
            (folder / "junit.xml").write_text(to_junit(findings), encoding="utf-8")
            _write_evidence(folder, findings)
            return _write_page(folder, data)
    except OSError as error:
        raise InputError(f"{folder}: the report cannot be written here: {error}") from error


@contextmanager
def _alone(folder: Path) -> Iterator[None]:
    """While no other run writes here. The folder itself is what is locked: nothing is left behind, even by a crash."""
    handle = os.open(folder, os.O_RDONLY)
    try:
        fcntl.flock(handle, fcntl.LOCK_EX)
        yield
    finally:
        os.close(handle)


def render_folder(folder: Path) -> Path:
    """Write the page again from the report.json in the folder; InputError where that is no report of this version."""
    path = folder / DATA
    try:
        data = json.loads(path.read_text(encoding="utf-8"))
    except RecursionError as error:
        raise InputError(f"{path}: nested too deeply to be a report.") from error
    except (OSError, ValueError) as error:
        raise InputError(f"{path}: cannot be read as a report: {error}") from error
    if not isinstance(data, dict) or data.get("schema") != SCHEMA:
        raise InputError(f"{path}: not a report of schema {SCHEMA}; write it with `safeloc verify --out {folder}`.")
    try:
        _refuse_unknown_verdicts(path, data)
        with _alone(folder):
            return _write_page(folder, data)
    except (KeyError, TypeError, UndefinedError) as error:
        raise InputError(f"{path}: does not keep to schema {SCHEMA}: {error}") from error


def _refuse_unknown_verdicts(path: Path, data: Mapping[str, Any]) -> None:
    """A page must never show a word that is no verdict as if it were one."""
    known: list[str] = schema()["$defs"]["verdict"]["enum"]
    said = [("the report", data["verdict"]), *((row["id"], row["verdict"]) for row in data["results"])]
    said += [(row["id"], row["verdict"]) for row in data["requirements"] if row["verdict"] != ""]
    for what, verdict in said:
        if verdict not in known:
            raise InputError(
                f"{path}: does not keep to schema {SCHEMA}: the verdict of {what} is {verdict!r}; "
                f"there are {', '.join(known)}."
            )


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


def _write_evidence(folder: Path, findings: Sequence[Finding]) -> None:
    """Certificates under the names that they refer to each other by; a name given twice is told, never overwritten."""
    files = file_names([finding.id for finding in findings])
    written: dict[str, str] = {}
    for finding in findings:
        if isinstance(finding.result, Proved):
            for name, text in finding.result.certificates.items():
                if written.setdefault(name.casefold(), text) != text:
                    raise InputError(f"{finding.id}: another certificate is called {name}; rename machine or property.")
                (folder / "certificates" / name).write_text(text, encoding="utf-8")
        _save_trace(folder / "traces" / f"{files[finding.id]}.jsonl", _run_of(finding), finding.truth_mm)


def _run_of(finding: Finding) -> Trace | None:
    match finding.result:
        case Proved(witness=trace) | Violated(trace=trace) | Vacuous(trace=trace):
            return trace
        case Held() | Unknown() | NotAsked():
            return None
        case _:
            assert_never(finding.result)


def _save_trace(path: Path, trace: Trace | None, truth_mm: Sequence[int | None]) -> None:
    """A trace as a stream that `replay` takes, with the recorded truth where there is one."""
    if trace is None:
        return
    steps = [dict(step) for step in trace.stream()]
    for step, truth in zip(steps, truth_mm, strict=False):
        if truth is not None:
            step["truth_mm"] = truth
    write_steps(path, steps, machine=trace.system.name, first=trace.initial)
