"""The output folder of a proof around a stream: pictures of the tube, the streams that break a claim, and certificates."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from safeloc.catalogue import ENTRIES
from safeloc.cli.console import err
from safeloc.errors import InputError
from safeloc.language.digest import full_digest
from safeloc.language.expr import Num
from safeloc.language.first_values import ANY
from safeloc.language.verdict import Proved, Violated
from safeloc.language.written_claims import signals
from safeloc.proof.around.bands import Bands, recorded_series
from safeloc.proof.around.claims import Asked
from safeloc.proof.around.given import Recorded
from safeloc.proof.around.members import as_steps
from safeloc.proof.around.shown import Decided
from safeloc.proof.results import Finding
from safeloc.report.around import deviation_picture, tube_picture
from safeloc.report.file_names import file_names
from safeloc.report.machines import configuration_of
from safeloc.runtime.streams.steps import StepStream, write_steps
from safeloc.target import Target


def drawn(loaded: Target, asked: Sequence[Asked], within: Sequence[str]) -> list[str]:
    """Return the numbers to draw: those in --within and in claims, and the reported interval."""
    reported = list(loaded.reported.outputs) if loaded.reported is not None else []
    names = dict.fromkeys([*within, *(name for one in asked for name in one.reads), *reported])
    known = signals(loaded.system)
    return [name for name in names if isinstance(known.get(name), Num)]


CERTIFICATES, CERTIFICATE, GIVEN, LAWFUL = "certificates", "around.json", "given.jsonl", "lawful.jsonl"
"""The folder of texts; the certificate of the whole question, the stream that was given, and a lawful stream of the tube."""
SCHEMA = "safeloc-around/1"


def make_folder(folder: Path) -> None:
    """Make the output folder before anything is proved; InputError where it can not be made."""
    try:
        (folder / CERTIFICATES).mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise InputError(f"{folder}: cannot be written: {error}") from error


def write_folder(
    folder: Path, loaded: Target, run: Recorded, bands: Bands, findings: Sequence[Finding], *, quiet: bool
) -> None:
    """Write a picture of each signal, the stream of each violation, and the certificates."""
    broken = [len(one.result.trace.steps) for one in findings if isinstance(one.result, Violated) and one.result.trace]
    try:
        pictures = file_names(list(bands.names))
        for name in bands.names:
            term = signals(loaded.system)[name]
            unit = term.unit.name if isinstance(term, Num) else ""
            shown = (
                name, unit, recorded_series(run.trace, loaded.system, name), bands.series(name, run.given.length),
                min(broken) if broken else None,
            )  # fmt: skip
            for kind, picture in (("", tube_picture(*shown)), ("-deviation", deviation_picture(*shown))):
                if picture:
                    _write_text(folder / f"tube-{pictures[name]}{kind}.svg", picture, quiet=quiet)
        files = file_names([one.id.rpartition("/")[2] for one in findings])
        for one in findings:
            _write_evidence(folder / files[one.id.rpartition("/")[2]], loaded, one, quiet=quiet)
    except OSError as error:
        raise InputError(f"{folder}: cannot be written: {error}") from error


def write_certificate(
    folder: Path, loaded: Target, given: tuple[str, StepStream], question: Mapping[str, Any], decided: Decided
) -> None:
    """Write what `safeloc recheck` reads: the question, the streams, and the sets of states that were handed over.

    given     the stream and its name
    question  what is asked and what decides it, as data (`decided_data`)
    """
    name, stream = given
    files = file_names([one.id.rpartition("/")[2] for one in decided.findings])
    try:
        write_steps(folder / GIVEN, stream.steps, machine=loaded.name, first=stream.first)
        if decided.witness is not None:
            first, steps = as_steps(loaded.system, decided.witness)
            write_steps(folder / LAWFUL, steps, machine=loaded.name, first=first)
        for shown in decided.shown.values():
            for file, text in shown.facts.items():
                (folder / CERTIFICATES / file).write_text(text, encoding="utf-8")
        runs = [f"{files[one['id'].rpartition('/')[2]]}.jsonl" for one in question["claims"]]
        claims = [
            {**one, "run": run if one["verdict"] == "violated" else None}
            for one, run in zip(question["claims"], runs, strict=True)
        ]
        data = {
            "schema": SCHEMA,
            "name": loaded.name,
            "spec": loaded.spec,
            "configuration": configuration_of(loaded),
            "declaration": full_digest(loaded.system),
            "stream": {
                "name": name,
                "file": GIVEN,
                "digest": hashlib.sha256((folder / GIVEN).read_bytes()).hexdigest(),
            },
            "witness": None if decided.witness is None else LAWFUL,
            **question,
            "claims": claims,
        }
        (folder / CERTIFICATE).write_text(json.dumps(data) + "\n", encoding="utf-8")
    except OSError as error:
        raise InputError(f"{folder}: cannot be written: {error}") from error


def _write_text(path: Path, text: str, *, quiet: bool) -> None:
    path.write_text(text, encoding="utf-8")
    if not quiet:
        err.print(str(path), markup=False)


def _write_evidence(file: Path, loaded: Target, finding: Finding, *, quiet: bool) -> None:
    match finding.result:
        case Violated(trace=trace) if trace is not None:
            path = file.with_name(f"{file.name}.jsonl")
            first = {
                var.name: trace.initial[var.name] for var in trace.system.state if trace.system.initial[var] is ANY
            }
            write_steps(path, trace.stream(), machine=loaded.name, first=first)
            if not quiet:
                err.print(
                    f"safeloc replay {loaded.spec or loaded.name} {path}{_with_config(file.parent, loaded)}",
                    markup=False,
                )
        case Proved(certificates=texts):
            for name, text in texts.items():
                (file.parent / CERTIFICATES / name).write_text(text, encoding="utf-8")
        case _:
            pass


def _with_config(folder: Path, loaded: Target) -> str:
    """Return the option by which a stream is replayed with the figures of its machine; those of a vehicle are written into the folder."""
    if loaded.config_file is not None:
        return f" --config {loaded.config_file}"
    if loaded.spec not in ENTRIES or loaded.config is None or loaded.config == ENTRIES[loaded.spec].config():
        return ""
    path = folder / "configuration.json"
    path.write_text(loaded.config.model_dump_json(indent=1), encoding="utf-8")
    return f" --config {path}"
