"""The report folder: the page, the data, JUnit XML, certificates and traces. The only place that writes it.

index.html     the page; page/: what it loads when it is opened there
report.json    the data; what is bulky lies beside it (safeloc.report.kept)
certificates/  one packed file a claim (safeloc.report.certificates)
traces/        one packed file a machine: the runs of its results, in columns (safeloc.runtime.streams.columns)
machines/      one packed file a machine: how the page shows it
junit.xml      for continuous integration
"""

from __future__ import annotations

import fcntl
import os
import tempfile
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any, assert_never

from jinja2 import UndefinedError

from safeloc.assurance.mutation.strength import Strengths
from safeloc.catalogue import Target
from safeloc.errors import InputError
from safeloc.language.trace import Trace
from safeloc.language.verdict import Held, NotAsked, Proved, Unknown, Vacuous, Violated
from safeloc.proof.results import Finding
from safeloc.report import certificates, kept
from safeloc.report.data import NOT_ASKED, SCHEMA, report_data, schema
from safeloc.report.junit import to_junit
from safeloc.report.page import PARTS, to_pages
from safeloc.runtime.streams.columns import Shown, runs_file

PAGE, JUNIT = "index.html", "junit.xml"
OWN = {
    certificates.FOLDER: f"*{certificates.SUFFIX}",
    kept.TRACES: f"*{kept.SUFFIX}",
    kept.MACHINES: f"*{kept.SUFFIX}",
    PARTS: "*.js",
}
"""Folders of a report, and which files in them are its own."""
OLD = {"certificates": "*.smt2", "traces": "*.jsonl"}
"""What reports before safeloc-report/3 left there."""


def usable(folder: Path) -> None:
    """InputError if no report can be written here: better told before the proofs than after."""
    try:
        folder.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryFile(dir=folder):
            pass
    except OSError as error:
        raise InputError(f"{folder}: the report cannot be written here: {error}") from error


def write_folder(
    folder: Path,
    findings: Sequence[Finding],
    targets: Sequence[Target],
    *,
    evidence: Mapping[str, Any] = NOT_ASKED,
    single: bool = False,
    strengths: Strengths | None = None,
    on_written: Callable[[], None] = lambda: None,
) -> Path:
    """Write everything and return the path of the page. Evidence of an earlier report in this folder is removed.

    evidence    target's name -> what its proofs rest on (safeloc.report.proof_evidence), where that was asked
    single      the page holds everything it shows, however large, and loads nothing
    strengths   how strongly each requirement is shown, as far as that was measured
    on_written  is called when all is written, before another run may write here

    Of two runs that write into one folder at once the second waits, so that the report is always of one run.
    Raises InputError where the folder cannot be written.
    """
    whole = report_data(findings, targets, evidence, strengths)
    archives = certificates.archives(findings)
    runs = _runs(findings)
    steps = {result: len(one.trace.steps) for own in runs.values() for one in own for result in one.results}
    small, machines = kept.taken_apart(whole, {file: list(texts) for file, texts in archives.items()}, steps)
    files = kept.machine_files(whole)
    try:
        folder.mkdir(parents=True, exist_ok=True)
        with _alone(folder):
            _clear(folder)
            for name in (certificates.FOLDER, kept.TRACES, kept.MACHINES):
                (folder / name).mkdir(exist_ok=True)
            (folder / kept.DATA).write_text(kept.written(small), encoding="utf-8")
            (folder / JUNIT).write_text(to_junit(findings), encoding="utf-8")
            certificates.write_archives(folder / certificates.FOLDER, archives)
            for name, own in runs.items():
                (folder / kept.TRACES / files[name]).write_bytes(runs_file(own))
            for file, content in machines.items():
                (folder / kept.MACHINES / file).write_bytes(content)
            page = _write_page(folder, whole, single=single)
            on_written()
            return page
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


def files_of(folder: Path) -> list[str]:
    """Return the files of a report, by their names in its folder, the data last: without these there is no report."""
    own = [path for name, pattern in OWN.items() for path in sorted((folder / name).glob(pattern))]
    return [path.relative_to(folder).as_posix() for path in (*own, folder / JUNIT, folder / PAGE, folder / kept.DATA)]


@contextmanager
def cleared(folder: Path) -> Iterator[None]:
    """Within, no other run writes here, and the folder holds no report."""
    with _alone(folder):
        _clear(folder)
        yield


def render_folder(folder: Path, *, single: bool = False) -> Path:
    """Write the page again from the data in the folder; InputError where that is no report of this version."""
    path = folder / kept.DATA
    data = kept.read_report(folder)
    try:
        kept.checked(path, lambda: _refuse_unknown_verdicts(path, data))
        whole = kept.read_for_page(folder)
        with _alone(folder):
            return _write_page(folder, whole, single=single)
    except UndefinedError as error:
        raise InputError(f"{path}: does not keep to schema {SCHEMA}: {error}") from error
    except OSError as error:
        raise InputError(f"{folder}: the page cannot be written here: {error}") from error


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


def _write_page(folder: Path, data: Mapping[str, Any], *, single: bool) -> Path:
    page, parts = to_pages(data, single=single)
    for path in (folder / PARTS).glob(OWN[PARTS]):
        path.unlink()
    for name, text in parts.items():
        (folder / PARTS).mkdir(exist_ok=True)
        (folder / PARTS / name).write_text(text, encoding="utf-8")
    (folder / PAGE).write_text(page, encoding="utf-8")
    return folder / PAGE


def _clear(folder: Path) -> None:
    """Remove evidence that belongs to an earlier report; nothing where there is no report."""
    if not (folder / kept.DATA).is_file():
        return
    for name, pattern in (*OWN.items(), *OLD.items()):
        for path in (folder / name).glob(pattern):
            path.unlink()


def _runs(findings: Sequence[Finding]) -> dict[str, list[Shown]]:
    """Machine -> the runs that its results are shown by, each once, however many results share it."""
    found: dict[str, dict[tuple[int, tuple[int | None, ...]], tuple[Trace, list[str]]]] = {}
    for finding in findings:
        trace = _run_of(finding)
        if trace is not None:
            own = found.setdefault(finding.machine, {})
            own.setdefault((id(trace), finding.truth_mm), (trace, []))[1].append(finding.id)
    return {
        machine: [Shown(results, trace, truth_mm) for (_, truth_mm), (trace, results) in own.items()]
        for machine, own in found.items()
    }


def _run_of(finding: Finding) -> Trace | None:
    match finding.result:
        case Proved(witness=trace) | Violated(trace=trace) | Vacuous(trace=trace):
            return trace
        case Held() | Unknown() | NotAsked():
            return None
        case _:
            assert_never(finding.result)
