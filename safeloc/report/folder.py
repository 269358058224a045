"""The report folder: page, data, JUnit XML, certificates and traces. Only this module writes it.

index.html     the page; page/: parts that it loads when they are opened
run.html       the page that steps through runs
report.json    the data; large parts are in separate files (safeloc.report.stored)
certificates/  one packed file for each machine (safeloc.report.certificates)
traces/        one script for each machine: the runs of its results, in columns (safeloc.runtime.streams.columns)
machines/      one packed file for each machine: its content on the page
junit.xml      for continuous integration
results.sarif  what does not hold, for editors and code hosts (safeloc.report.sarif)
SHA256SUMS     the digests of all these files (safeloc.report.digests)
"""

from __future__ import annotations

import tempfile
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from functools import partial
from pathlib import Path
from typing import Any

from jinja2 import UndefinedError

from safeloc.assurance.mutation.strength import Strengths
from safeloc.catalogue import Target
from safeloc.errors import InputError
from safeloc.language.trace import Trace
from safeloc.proof.results import Finding
from safeloc.report import certificates, stored
from safeloc.report.changes import changes
from safeloc.report.data import NOT_ASKED, SCHEMA, OfTarget, of_target, pictures_of, report_data, run_of, schema
from safeloc.report.digests import SUMS, misfits, renew_digests, write_digests
from safeloc.report.junit import to_junit
from safeloc.report.kept_pieces import NOTHING_KEPT, KeptPieces, of_results_key, of_target_key, of_texts_key
from safeloc.report.page import PARTS, to_pages
from safeloc.report.pieces import Piece, made_pieces
from safeloc.report.run_page import RUN_PAGE, machine_script
from safeloc.report.sarif import to_sarif
from safeloc.runtime.locked_folder import locked
from safeloc.runtime.packed import packed
from safeloc.runtime.streams.columns import Shown, runs_file

PAGE, JUNIT, SARIF = "index.html", "junit.xml", "results.sarif"
_OWN = (
    (certificates.FOLDER, f"*{certificates.SUFFIX}"),
    (certificates.FOLDER, f"*{certificates.FORMER}"),
    (stored.TRACES, f"*{stored.RUNS}"),
    (stored.MACHINES, f"*{stored.SUFFIX}"),
    (stored.MACHINES, f"*{stored.RUNS}"),
    (PARTS, "*.js"),
)
"""Folders of a report, and the pattern of its files in each."""
_OLD = (("certificates", "*.smt2"), ("traces", "*.jsonl"), ("traces", "*.json.xz"))
"""Files of reports before safeloc-report/5."""


def usable(folder: Path) -> None:
    """Raise InputError if no report can be written here; called before the proofs, so that they are not made in vain."""
    try:
        existing = next(place for place in (folder, *folder.absolute().parents) if place.exists())
        with tempfile.TemporaryFile(
            dir=existing
        ):  # the folder itself is made with the report, not before a wrong name is told
            pass
    except OSError as error:
        raise InputError(f"{folder}: the report cannot be written here: {error.strerror or error}.") from error


def write_folder(
    folder: Path,
    findings: Sequence[Finding],
    targets: Sequence[Target],
    *,
    evidence: Mapping[str, Any] = NOT_ASKED,
    single: bool = False,
    strengths: Strengths | None = None,
    made: Mapping[str, Any] | None = None,
    margins: Mapping[str, Any] = NOT_ASKED,
    scores: Mapping[str, Any] = NOT_ASKED,
    on_written: Callable[[Mapping[str, Any]], None] = lambda _: None,
    jobs: int = 1,
    kept: KeptPieces = NOTHING_KEPT,
) -> Path:
    """Write the report and return the path of the page. Files of an earlier report in this folder are removed.

    evidence    target's name -> proof cores and effects of broken clauses (safeloc.report.proof_evidence), if available
    single      write one self-contained page, whatever its size
    strengths   strength of the evidence for each requirement, as far as it was measured
    made        command, limits, seed and commit (safeloc.report.made_by), if a command writes the report
    margins     target's name -> how far its figures may move, where that was found
    scores      target's name -> how many wrong machines a proof notices, where that was measured
    on_written  called with the data of the report after everything is written, before another run can write here
    jobs        processes in which what belongs to single machines is made
    kept        where that is kept from run to run

    If two runs write into one folder at once, the second one waits, so that a report is always of one run.
    InputError if the folder cannot be written.
    """
    archives = certificates.archives(findings)
    runs = _runs(findings)
    files = stored.names_of_files((one.name for one in targets), (one.machine for one in findings))
    made_of = made_pieces(dict(_pieces(targets, findings, runs, archives, files)), jobs, kept)
    of_targets = {one.name: OfTarget(**made_of["target", one.name]) for one in targets}
    pictures = {one.name: made_of["pictures", one.name] for one in targets}
    everything = report_data(findings, targets, evidence, strengths, made, margins, scores, of_targets, pictures)
    steps = {result: one.trace.length for own in runs.values() for one in own for result in one.results}
    names = {file: list(texts) for file, texts in archives.items()}
    small, machine_texts = stored.split_data(everything, names, steps)
    machines = made_pieces(dict(_packs(machine_texts)), jobs, kept)
    scripts = {one.name: text for one in targets if (text := made_of.get(("script", one.name)))}
    contents: dict[str, str | bytes] = {
        stored.DATA: stored.report_text(small),
        JUNIT: to_junit(findings),
        SARIF: to_sarif(findings, targets),
        **{f"{certificates.FOLDER}/{file}": made_of["certificates", file] for file in archives},
        **{f"{stored.TRACES}/{files[name]}{stored.RUNS}": made_of["runs", name] for name in runs},
        **{f"{stored.MACHINES}/{file}": content for file, content in machines.items()},
        **{f"{stored.MACHINES}/{files[name]}{stored.RUNS}": text for name, text in scripts.items()},
    }
    data = {**everything, "certificates": names, "runs": steps, "scripts": list(scripts)}
    try:
        folder.mkdir(parents=True, exist_ok=True)
        with locked(folder):
            _clear(folder)
            _write(folder, contents)
            page = _write_page(folder, data, single=single)
            write_digests(folder, _present(folder))
            on_written(everything)
            return page
    except OSError as error:
        raise InputError(f"{folder}: the report cannot be written here: {error.strerror or error}.") from error


def _write(folder: Path, contents: Mapping[str, str | bytes]) -> None:
    """Write files by their names in the folder."""
    for name in (certificates.FOLDER, stored.TRACES, stored.MACHINES):
        (folder / name).mkdir(exist_ok=True)
    for file, content in contents.items():
        (folder / file).write_bytes(content.encode() if isinstance(content, str) else content)


def _pieces(
    targets: Sequence[Target],
    findings: Sequence[Finding],
    runs: Mapping[str, Sequence[Shown]],
    archives: certificates.Archives,
    files: Mapping[str, str],
) -> Iterator[tuple[tuple[str, str], Piece]]:
    """Yield what belongs to single machines, by kind and name."""
    for one in targets:
        own = [finding for finding in findings if finding.machine == one.name]
        yield ("target", one.name), Piece(partial(_plain, one), of_target_key(one, "target"))
        yield ("pictures", one.name), Piece(partial(pictures_of, one, own), of_results_key(one, own, "pictures"))
        if one.name in runs:
            file = files[one.name]
            yield ("script", one.name), Piece(partial(machine_script, file, one), of_target_key(one, "script", file))
            shown = partial(runs_file, runs[one.name], file)
            yield ("runs", one.name), Piece(shown, of_results_key(one, own, "runs", file))
    for name in sorted(runs.keys() - {one.name for one in targets}):
        yield ("runs", name), Piece(partial(runs_file, runs[name], files[name]))
    for file, texts in archives.items():
        yield ("certificates", file), Piece(partial(certificates.packed_texts, texts), of_texts_key(texts))


def _packs(texts: Mapping[str, str]) -> Iterator[tuple[str, Piece]]:
    """Yield the packed file of each machine, by its name."""
    for file, text in texts.items():
        yield file, Piece(partial(packed, text.encode()), of_texts_key({file: text}))


def _plain(target: Target) -> dict[str, Any]:
    made = of_target(target)
    return {"machine": made.machine, "shared": made.shared}


def files_of(folder: Path) -> list[str]:
    """Return the names of a report's files within its folder, report.json last: without it there is no report."""
    return [SUMS, *_present(folder)]


def _present(folder: Path) -> list[str]:
    """Return the names of the files of the report that are there, without that of the digests."""
    own = [path for name, pattern in _OWN for path in sorted((folder / name).glob(pattern))]
    single = [folder / name for name in (RUN_PAGE, JUNIT, SARIF, PAGE, stored.DATA)]
    return [path.relative_to(folder).as_posix() for path in (*own, *single) if path.is_file()]


def unfit(folder: Path) -> list[str]:
    """Return what in a folder does not fit the digests of its report, file by file; nothing for a report as it was written."""
    return misfits(folder, _present(folder))


@contextmanager
def cleared(folder: Path) -> Iterator[None]:
    """Lock the folder against other runs, and remove the report in it."""
    folder.mkdir(parents=True, exist_ok=True)
    with locked(folder):
        _clear(folder)
        yield


def render_folder(folder: Path, *, single: bool = False, since: Path | None = None) -> Path:
    """Write the page again from the data in the folder; InputError if they are no report of this version.

    since  folder of an earlier report: the page says what changed since then
    """
    path = folder / stored.DATA
    data = stored.read_report(folder)
    try:
        stored.checked(path, lambda: _refuse_unknown_verdicts(path, data))
        everything = stored.read_for_page(folder)
        if since is not None:
            everything["changed"] = _changed(stored.read_for_page(since), everything, folder)
        with locked(folder):
            page_path = _write_page(folder, everything, single=single)
            renew_digests(folder, _present(folder))
            return page_path
    except UndefinedError as error:
        raise InputError(f"{path}: does not fit schema {SCHEMA}: {error}") from error
    except OSError as error:
        raise InputError(f"{folder}: the page cannot be written here: {error.strerror or error}.") from error


def _changed(old: Mapping[str, Any], new: Mapping[str, Any], folder: Path) -> dict[str, Any]:
    """Return what changed between two reports, for the page."""
    found = stored.checked(folder / stored.DATA, lambda: changes(old, new))
    return {"since": old["made"], "worse": found.worse, "sections": found.sections}


def _refuse_unknown_verdicts(path: Path, data: Mapping[str, Any]) -> None:
    """Raise InputError for a verdict that does not exist: the page must not show it as one."""
    known: list[str] = schema()["$defs"]["verdict"]["enum"]
    verdicts = [("the report", data["verdict"]), *((row["id"], row["verdict"]) for row in data["results"])]
    verdicts += [(row["id"], row["verdict"]) for row in data["requirements"] if row["verdict"] != ""]
    for what, verdict in verdicts:
        if verdict not in known:
            raise InputError(
                f"{path}: does not fit schema {SCHEMA}: the verdict of {what} is {verdict!r}; "
                f"there are {', '.join(known)}."
            )


def _write_page(folder: Path, data: Mapping[str, Any], *, single: bool) -> Path:
    runs = [path.read_text(encoding="utf-8") for path in _runs_of(folder, data)] if single else []
    pages = to_pages(data, single=single, runs=runs)
    for path in (*(folder / PARTS).glob("*.js"), *folder.glob(RUN_PAGE)):
        path.unlink()
    for name, text in pages.parts.items():
        (folder / PARTS).mkdir(exist_ok=True)
        (folder / PARTS / name).write_text(text, encoding="utf-8")
    if pages.runs:
        (folder / RUN_PAGE).write_text(pages.runs, encoding="utf-8")
    (folder / PAGE).write_text(pages.page, encoding="utf-8")
    return folder / PAGE


def _runs_of(folder: Path, data: Mapping[str, Any]) -> list[Path]:
    """Return the scripts of runs and machines that belong to the report."""
    having = {row["machine"] for row in data["results"] if row["id"] in data["runs"]}
    files = stored.runs_files(data)
    runs = [folder / stored.TRACES / file for name, file in files.items() if name in having]
    return [*runs, *(folder / stored.MACHINES / files[name] for name in data["scripts"])]


def _clear(folder: Path) -> None:
    """Remove the files of an earlier report, if there is one."""
    if not (folder / stored.DATA).is_file():
        return
    for name, pattern in (*_OWN, *_OLD):
        for path in (folder / name).glob(pattern):
            path.unlink()


def _runs(findings: Sequence[Finding]) -> dict[str, list[Shown]]:
    """Return the runs that show the results of each machine; a run shared by several results occurs once."""
    found: dict[str, dict[tuple[int, tuple[int | None, ...]], tuple[Trace, list[str]]]] = {}
    for finding in findings:
        trace = run_of(finding)
        if trace is not None:
            own = found.setdefault(finding.machine, {})
            own.setdefault((id(trace), finding.truth_mm), (trace, []))[1].append(finding.id)
    return {
        machine: [Shown(results, trace, truth_mm) for (_, truth_mm), (trace, results) in own.items()]
        for machine, own in found.items()
    }
