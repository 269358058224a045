"""Unpacking of a report folder into plain files: certificates for any solver, runs for `safeloc replay`."""

from __future__ import annotations

from pathlib import Path

from safeloc.errors import InputError
from safeloc.report import certificates, stored
from safeloc.report.file_names import file_names
from safeloc.runtime.streams.columns import read_runs
from safeloc.runtime.streams.steps import write_steps


def extract(folder: Path, to: Path) -> tuple[int, int]:
    """Write `certificates/NAME.smt2` and `traces/RESULT.jsonl` below `to`; return the number of each.

    InputError if a file of the report is damaged or missing, or a file cannot be written.
    """
    data = stored.read_report(folder)
    read = certificates.read_archives(folder / certificates.FOLDER, data["certificates"])
    if read.damaged:
        raise InputError("\n".join(read.damaged.values()))
    try:
        for name in (certificates.FOLDER, stored.TRACES):
            (to / name).mkdir(parents=True, exist_ok=True)
        for name, text in read.texts.items():
            (to / certificates.FOLDER / name).write_text(text, encoding="utf-8")
        return len(read.texts), _runs(folder, data, to / stored.TRACES)
    except OSError as error:
        raise InputError(f"{to}: cannot be written to: {error.strerror or error}.") from error


def _runs(folder: Path, data: stored.Data, to: Path) -> int:
    """Write every run, one file for each result; return their number."""
    files = file_names([row["id"] for row in data["results"]])
    places = stored.runs_files(data)
    shown = [row for row in data["results"] if row["trace"] is not None]
    for machine in dict.fromkeys(row["machine"] for row in shown):
        runs = read_runs(folder / stored.TRACES / places[machine])
        for row in shown:
            if row["machine"] == machine:
                one = runs.stream(row["id"])
                write_steps(to / f"{files[row['id']]}.jsonl", one.steps, machine=one.machine, first=one.first)
    return len(shown)
