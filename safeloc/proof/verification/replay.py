"""Replay of a recorded stream through a machine: one row per step, and a check of every property."""

from __future__ import annotations

import json
import time
import weakref
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import chain
from pathlib import Path

from safeloc.errors import InputError, StreamError
from safeloc.language.absence import stand_ins, without_absent
from safeloc.language.expr import Num
from safeloc.language.interpret import read_inputs
from safeloc.language.monitor import Checks
from safeloc.language.nodes import Value
from safeloc.language.renamed import hint
from safeloc.language.spec import Property, speaks_of
from safeloc.language.system import TransitionSystem, without_ghosts
from safeloc.language.trace import Trace, shown
from safeloc.language.units import Enumeration
from safeloc.language.verdict import Held, NotAsked, Result, Unknown, Violated
from safeloc.proof.drawn_runs.quick import Quick, quick_run
from safeloc.proof.results import Finding, Replayed
from safeloc.proof.verification.broken_laws import with_laws
from safeloc.proof.verification.recordings import counted, recorded_steps
from safeloc.proof.verification.unasked import reason
from safeloc.runtime.border import Fault
from safeloc.runtime.outside import quoted
from safeloc.runtime.streams.columns import read_runs
from safeloc.runtime.streams.gzipped import name_of
from safeloc.runtime.streams.steps import StepStream, read_steps
from safeloc.target import Target


@dataclass(frozen=True)
class Row:
    """One replayed step; None is an output that is absent."""

    number: int
    modes: Mapping[str, str]
    fired: Mapping[str, str]
    outputs: Mapping[str, Value | str | None]
    truth: str

    def as_json(self) -> str:
        """Return one JSON line."""
        return json.dumps(
            {
                "step": self.number,
                "mode": dict(self.modes),
                "fired": dict(self.fired),
                **self.outputs,
                "truth": self.truth,
            }
        )

    def cells(self) -> dict[str, str]:
        """Return the text of each cell by its column."""
        outputs = {
            name: "" if value is None else str(value).lower() if isinstance(value, bool) else str(value)
            for name, value in self.outputs.items()
        }
        fired = {"fired": ", ".join(self.fired.values())}
        return {"step": str(self.number), **self.modes, **outputs, **fired, "truth": self.truth}


def as_table(rows: Sequence[Row]) -> list[str]:
    """Return the rows as lines of a table under a heading; all rows have the same columns."""
    cells = [row.cells() for row in rows]
    widths = {name: max(len(name), *(len(row[name]) for row in cells)) for name in cells[0]}
    lines = [{name: name for name in widths}, *cells]
    return ["  ".join(line[name].ljust(width) for name, width in widths.items()).rstrip() for line in lines]


def replay_stream(
    target: Target, path: Path, *, period_ms: int | None = None, run: str | None = None
) -> tuple[list[Row], list[Finding]]:
    """Replay a stream; return rows and findings.

    With `period_ms` the file holds single records, and a finding of its own counts those that the border refused. With `run`,
    the id of a result, the file holds traces of a report, and the run of that result is replayed.

    A stream with the ghosts of the machine is checked against every property. One without them (a real recording) is checked
    against the properties that do not read the truth; its `truth_mm`, if it has that, is compared with the reported interval, if
    the machine reports one. StreamError, with file and line, for a step that the machine cannot take and for a stream without
    steps.
    """
    started = time.monotonic()
    stream, faults = read_recording(target, path, period_ms=period_ms, run=run)
    asked = _asked(target, with_truth=has_truth(target, stream))
    system, properties = asked.system, asked.properties
    truth = [_truth_mm(path, stream, index) for index in range(len(stream.steps))]
    trace = run_of(system, path, stream)
    rows = [_row(target, trace, number, truth[number]) for number in range(len(trace.steps))]
    verdicts = [_told(verdict, trace, stream) for verdict in asked.checks(trace)]
    findings = [_finding(target, path, *pair, started) for pair in zip(properties, verdicts, strict=True)]
    if target.reported is not None and any(value is not None for value in truth):
        findings.append(_containment(target, path, rows, trace, truth, started))
    unchecked = asked.unchecked
    if not findings:
        findings.append(_nothing_checked(target, path, unchecked, started))
    if faults is not None:
        findings.append(_border(target, path, len(rows), faults, started))
    replayed = Replayed(name_of(path), trace, tuple(truth))
    findings = [replace(finding, replayed=replayed) for finding in findings]
    return rows, _noted(findings, unchecked)


def read_recording(
    target: Target, path: Path, *, period_ms: int | None = None, run: str | None = None
) -> tuple[StepStream, Sequence[Fault] | None]:
    """Return the steps of a recording for this target, and the faults of single records (None without `period_ms`).

    The arguments are those of `replay_stream`. StreamError for a recording without steps, or of another machine.
    """
    stream, faults = (_steps(path, run), None) if period_ms is None else recorded_steps(target, path, period_ms)
    if not stream.steps:
        raise StreamError(f"{path}: the stream has no steps.")
    _refuse_other(target, path, stream)
    return stream, faults


def _steps(path: Path, run: str | None) -> StepStream:
    """Read a recording, or the requested run of a file of runs."""
    return read_steps(path) if run is None else read_runs(path).stream(run)


def _told(verdict: Result, trace: Trace, stream: StepStream) -> Result:
    return with_laws(verdict, trace, stream.first) if isinstance(verdict, Unknown) else verdict


@dataclass(frozen=True, eq=False)
class _Asked:
    """The checks on a target's recordings: the system to run, and the properties that apply."""

    system: TransitionSystem
    properties: Sequence[Property]
    unchecked: Sequence[Property]
    checks: Checks


_ASKED: weakref.WeakKeyDictionary[Target, dict[bool, _Asked]] = weakref.WeakKeyDictionary()


def _asked(target: Target, *, with_truth: bool) -> _Asked:
    """Return the checks on the whole system, or on the system on board; made once for all recordings of a target."""
    known = _ASKED.setdefault(target, {})
    if with_truth not in known:
        system = target.system if with_truth else without_ghosts(target.system)
        every = [prop for prop in target.properties if prop.kind != "reachable"]
        properties = [prop for prop in every if speaks_of(system, prop)]
        unchecked = [prop for prop in every if prop not in properties]
        known[with_truth] = _Asked(system, properties, unchecked, Checks(system, properties, Quick))
    return known[with_truth]


def _noted(findings: Sequence[Finding], unchecked: Sequence[Property]) -> list[Finding]:
    """Return the findings; the first one gets a note of the properties that were not checked."""
    if not unchecked:
        return list(findings)
    names = "; ".join(prop.name for prop in unchecked)
    note = {"not checked": f"{_number(unchecked)} ({names}), the stream has no ghosts"}
    return [replace(findings[0], notes={**findings[0].notes, **note}), *findings[1:]]


def _nothing_checked(target: Target, path: Path, unchecked: Sequence[Property], started: float) -> Finding:
    """Return the finding that neither a property nor the true position could be checked, which is no success."""
    ghosts = "every property reads ghosts, and the stream has none; simulate a stream, or record the true position as truth_mm"
    statement, name = (
        "the replay checks a property or the true position",
        f"{target.name}/replay/{name_of(path)}: nothing checked",
    )
    why, seconds = NotAsked(ghosts if unchecked else reason(target)), time.monotonic() - started
    return Finding(name, target.name, "replay", statement, why, f"replay of {path.name}", seconds)


def _number(unchecked: Sequence[Property]) -> str:
    return "1 property" if len(unchecked) == 1 else f"{len(unchecked)} properties"


def _refuse_other(target: Target, path: Path, stream: StepStream) -> None:
    """Refuse a stream whose header names another machine."""
    if stream.machine not in ("", target.name):
        raise StreamError(
            f"{path}:1: the stream is for machine {stream.machine!r}, not for {target.name!r}; "
            "replay it with that machine, or remove `machine` from the header."
        )


def run_recorded(target: Target, path: Path) -> Trace:
    """Run a recording of steps, with its ghosts if it has them; StreamError, with file and line, if the machine cannot take it."""
    stream, _ = read_recording(target, path)
    return run_of(_asked(target, with_truth=has_truth(target, stream)).system, path, stream)


def run_with_truth(target: Target, path: Path) -> Trace | None:
    """Return a stream with the ghosts of the machine, as a run of the machine; None for a stream without them."""
    stream = read_steps(path)
    _refuse_other(target, path, stream)
    return run_of(target.system, path, stream) if has_truth(target, stream) else None


def recorded_run(target: Target, path: Path, prop: Property) -> Trace | None:
    """Return a recording as a run of the machine, on board if it has no ghosts; None if the property reads what the recording lacks."""
    stream, _ = read_recording(target, path)
    system = target.system if has_truth(target, stream) else without_ghosts(target.system)
    return run_of(system, path, stream) if speaks_of(system, prop) else None


def has_truth(target: Target, stream: StepStream) -> bool:
    """Return whether a recording has the ghosts of the machine, and with them the truth."""
    ghosts = {var.name for var in target.system.ghosts if var in set(target.system.inputs)}
    return bool(stream.steps) and ghosts <= set(stream.steps[0])


def run_of(system: TransitionSystem, path: Path, stream: StepStream) -> Trace:
    """Run the system on a recording; StreamError with file and line for a step that it cannot take."""
    names = {var.name for var in system.inputs}
    known = {var.name for var in system.state}
    first = {name: value for name, value in stream.first.items() if name in known}
    rows = [{name: value for name, value in step.items() if name in names} for step in stream.steps]
    _refuse_unknown(system, path, stream)
    try:
        return quick_run(system, rows, first=first)
    except InputError as error:
        raise StreamError(f"{path}: {error} ({_first_bad(system, stream, rows)})") from error


def _first_bad(system: TransitionSystem, stream: StepStream, rows: Sequence[Mapping[str, object]]) -> str:
    for line, row in zip(stream.lines, rows, strict=True):
        try:
            read_inputs(system, row)
        except InputError:
            return f"line {line}"
    return "in the first state"


def _refuse_unknown(system: TransitionSystem, path: Path, stream: StepStream) -> None:
    """Refuse a column that no input reads, even an empty one: it is a misspelt name, unless it is a remark."""
    known = _names(system)
    steps = ((name, line) for line, step in zip(stream.lines, stream.steps, strict=True) for name in step)
    for name, line in chain(stream.columns.items(), steps):
        if name not in known and name not in _REMARKS:
            if name == _OF_A_RECORD:
                raise StreamError(
                    f"{path}:{line}: these are single records, not steps: say how long a cycle is, --period-ms 100 (docs/records.md)."
                )
            inputs = sorted(one for one in known if not one.endswith(".present"))
            raise StreamError(
                f"{path}:{line}: {system.name} has no input {quoted(name)}; it has {inputs}.{hint(name, known)}"
            )


_REMARKS = ("truth_mm", "time_ms")
_OF_A_RECORD = "kind"
"""The field that every record has, and no step."""


def _names(system: TransitionSystem) -> set[str]:
    every = {var.name for var in system.inputs}
    return every | {var.name for machine in system.machines for var in machine.world.choices}


def _row(target: Target, trace: Trace, index: int, truth_mm: int | None) -> Row:
    step = trace.steps[index]
    by_name = {var.name: var for var in trace.system.state}
    modes = {name: shown(by_name[name], value) for name, value in step.state.items() if name.split(".")[-1] == "mode"}
    there = without_absent(step.outputs, stand_ins(trace.system))
    outputs = {name: None if value is None else _shown(trace.system, name, value) for name, value in there.items()}
    return Row(index + 1, modes, step.fired, outputs, _standing(target, step.outputs, truth_mm))


def _shown(system: TransitionSystem, name: str, value: Value) -> Value | str:
    term = system.outputs[name]
    if isinstance(term, Num) and isinstance(term.unit, Enumeration):
        return term.unit.members[value]
    return value


def _standing(target: Target, outputs: Mapping[str, Value], truth_mm: int | None) -> str:
    if truth_mm is None or target.reported is None:
        return ""
    return target.reported.standing(outputs, truth_mm)


def _truth_mm(path: Path, stream: StepStream, index: int) -> int | None:
    truth = stream.steps[index].get("truth_mm")
    if truth is None or (isinstance(truth, int) and not isinstance(truth, bool)):
        return truth
    raise StreamError(f"{path}:{stream.lines[index]}: truth_mm is {truth!r}; give whole mm, or leave it out.")


def _finding(target: Target, path: Path, prop: Property, verdict: Result, started: float) -> Finding:
    seconds = time.monotonic() - started
    name = f"{target.name}/replay/{name_of(path)}: {prop.name}"
    return Finding(
        name, target.name, "replay", prop.statement, verdict, f"replay of {path.name}", seconds, prop.requirements
    )


def _border(target: Target, path: Path, steps: int, faults: Sequence[Fault], started: float) -> Finding:
    return Finding(
        f"{target.name}/replay/{name_of(path)}: border",
        target.name,
        "replay",
        "every record is used unchanged, or refused with a reason",
        Held("replay", 1, steps, counted(faults)),
        f"replay of {path.name}",
        time.monotonic() - started,
    )


def _containment(
    target: Target, path: Path, rows: Sequence[Row], trace: Trace, truth: Sequence[int | None], started: float
) -> Finding:
    wrong = [row.number for row in rows if row.truth == "WRONG"]
    invalid = sum(row.truth == "INVALID" for row in rows)
    notes = {"contained": str(sum(row.truth == "contained" for row in rows)), "INVALID": str(invalid)}
    outcome: Result = Held("replay", 1, len(rows), notes)
    seen: tuple[int | None, ...] = ()
    if wrong:
        part = Trace(trace.system, trace.initial, trace.steps[: wrong[0]])
        steps = ", ".join(map(str, wrong[:10])) + (f" and {len(wrong) - 10} more" if len(wrong) > 10 else "")
        outcome = Violated(part, "replay", f"the reported interval does not contain truth_mm at steps {steps}")
        seen = tuple(truth[: wrong[0]])
    return Finding(
        f"{target.name}/replay/{name_of(path)}: truth",
        target.name,
        "replay",
        "the reported interval contains the true position of the recording",
        outcome,
        f"replay of {path.name}",
        time.monotonic() - started,
        truth_mm=seen,
    )
