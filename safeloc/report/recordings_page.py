"""One page, with everything in it, that steps through recorded runs of a machine: what `safeloc open` shows of a stream."""

from __future__ import annotations

import hashlib
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from jinja2 import Environment, FileSystemLoader, StrictUndefined

from safeloc.language.verdict import Violated, word, worst
from safeloc.proof.results import Finding, Replayed
from safeloc.proof.verification.replay import replay_stream
from safeloc.report.file_names import file_names
from safeloc.report.machines import machine_data
from safeloc.report.run_page import RUNS, claim_of, island, machine_script, scripts, view_script
from safeloc.runtime.streams.columns import Shown, runs_file
from safeloc.target import Target


def recordings_page(target: Target, streams: Sequence[Path], *, made: str) -> str:
    """Replay the streams and return the page; the first is shown first. `made` is the time, for the foot of printed pages.

    StreamError, with file and line, for a stream that the machine cannot take.
    """
    shown, results = list[Shown](), dict[str, Any]()
    for path in streams:
        _, findings = replay_stream(target, path)
        replayed = findings[0].replayed
        assert replayed is not None  # every finding of a replay has its run
        name = f"{target.name}/recording/{replayed.name}"
        shown.append(Shown([name], replayed.trace, replayed.truth_mm))
        results[name] = _result(findings, replayed)
    file = file_names([target.name])[target.name]
    runs = runs_file(shown, file)
    digest = hashlib.sha256(runs.encode()).hexdigest()[:16]
    machine = machine_script(file, target, ghosts=shown[0].trace.system is target.system)
    known = {
        "made": digest,
        "report": "",
        "alone": True,
        "first": next(iter(results)),
        "machines": {
            target.name: {"file": file, "runs": "the page", "view": "the page", "script": "the page" if machine else ""}
        },
    }
    calls = [runs, view_script(file, machine_data(target), results, digest), machine]
    environment = Environment(
        loader=FileSystemLoader(Path(__file__).parent), autoescape=True, undefined=StrictUndefined, trim_blocks=True
    )
    given: Mapping[str, Any] = {"data": {"made": made}, "machines": [], "run": island(known)}
    return environment.get_template("run_page.html.jinja").render(script=scripts(RUNS, calls=calls), **given)


def _result(findings: Sequence[Finding], replayed: Replayed) -> dict[str, Any]:
    """Return the verdict on a recording: the worst of its findings, and every statement that it breaks."""
    broken = [
        [one.statement, step, claim_of(one.id)] for one in findings if (step := _broken_at(one, replayed)) is not None
    ]
    held = sum(word(one.result) == "held" for one in findings)
    return {
        "verdict": worst(word(one.result) for one in findings),
        "statement": f"recording {replayed.name}: {held} of {len(findings)} checks held",
        "at": "",
        "broken": sorted(broken, key=lambda one: one[1]),
    }


def _broken_at(finding: Finding, replayed: Replayed) -> int | None:
    """Return the step that breaks the statement of a finding; None if it is not violated."""
    if not isinstance(finding.result, Violated):
        return None
    trace = finding.result.trace
    return replayed.trace.length if trace is None else trace.length
