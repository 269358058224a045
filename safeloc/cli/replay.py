"""A recorded stream through a machine: one row a step, and every property on the whole of it."""

from __future__ import annotations

import json
import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from safeloc.catalogue import Target
from safeloc.errors import InputError, StreamError
from safeloc.expr import Num, Var
from safeloc.interpret import read_inputs, run
from safeloc.monitor import check_all
from safeloc.nodes import Value
from safeloc.results import Finding
from safeloc.spec import Property
from safeloc.streams.steps import StepStream, read_steps
from safeloc.system import TransitionSystem, without_ghosts
from safeloc.terms import variables
from safeloc.trace import Trace, shown
from safeloc.units import Enumeration
from safeloc.verdict import Held, Result, Violated


@dataclass(frozen=True)
class Row:
    """One replayed step."""

    number: int
    modes: Mapping[str, str]
    fired: Mapping[str, str]
    outputs: Mapping[str, Value | str]
    truth: str

    def as_json(self) -> str:
        """One JSON line."""
        return json.dumps(
            {
                "step": self.number,
                "mode": dict(self.modes),
                "fired": dict(self.fired),
                **self.outputs,
                "truth": self.truth,
            }
        )

    def heading(self) -> str:
        """Column names of `as_text`."""
        return "step  " + "  ".join([*self.modes, *self.outputs, "fired", "truth"])

    def as_text(self) -> str:
        """One plain line."""
        values = [
            *self.modes.values(),
            *(str(value) for value in self.outputs.values()),
            ", ".join(self.fired.values()),
        ]
        return f"{self.number:4}  " + "  ".join([*values, self.truth]).rstrip()


def replay_stream(target: Target, path: Path) -> tuple[list[Row], list[Finding]]:
    """Rows and findings. StreamError with file and line for a step the machine cannot take.

    A stream with the ghosts of the machine in it is checked against every property. One without them (a real
    recording) is checked against those that do not speak of the truth; `truth_mm`, where the stream has it, is
    compared with the reported interval, if the machine reports one.
    """
    started = time.monotonic()
    stream = read_steps(path)
    system = target.system if _is_whole(target, stream) else without_ghosts(target.system)
    truth = [_truth_mm(path, stream, index) for index in range(len(stream.steps))]
    trace = _run(system, path, stream)
    rows = [_row(target, trace, number, truth[number]) for number in range(len(trace.steps))]
    properties = [prop for prop in _applicable(target, system) if prop.kind != "reachable"]
    verdicts = check_all(trace, properties)
    findings = [_finding(target, path, *pair, started) for pair in zip(properties, verdicts, strict=True)]
    if target.reported is not None and any(value is not None for value in truth):
        findings.append(_containment(target, path, rows, trace, truth, started))
    return rows, findings


def whole_run(target: Target, path: Path) -> Trace | None:
    """A stream with the ghosts of the machine in it, as a run of the machine; None for a stream without them."""
    stream = read_steps(path)
    return _run(target.system, path, stream) if _is_whole(target, stream) else None


def _is_whole(target: Target, stream: StepStream) -> bool:
    ghosts = {var.name for var in target.system.ghosts if var in set(target.system.inputs)}
    return bool(stream.steps) and ghosts <= set(stream.steps[0])


def _run(system: TransitionSystem, path: Path, stream: StepStream) -> Trace:
    names = {var.name for var in system.inputs}
    known = {var.name for var in system.state}
    first = {name: value for name, value in stream.first.items() if name in known}
    rows = [{name: value for name, value in step.items() if name in names} for step in stream.steps]
    _refuse_unknown(system, path, stream)
    try:
        return run(system, rows, first=first)
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
    """A column nobody reads is a misspelt name, unless it is a remark."""
    for line, step in zip(stream.lines, stream.steps, strict=True):
        strange = [name for name in step if name not in _names(system) and name not in REMARKS]
        if strange:
            raise StreamError(
                f"{path}:{line}: {system.name} has no input {strange[0]!r}; it has {sorted(_names(system))}."
            )


REMARKS = ("truth_mm", "time_ms")


def _names(system: TransitionSystem) -> set[str]:
    every = {var.name for var in system.inputs}
    return every | {var.name for machine in system.machines for var in machine.ghost_inputs}


def _row(target: Target, trace: Trace, index: int, truth_mm: int | None) -> Row:
    step = trace.steps[index]
    by_name = {var.name: var for var in trace.system.state}
    modes = {name: shown(by_name[name], value) for name, value in step.state.items() if name.split(".")[-1] == "mode"}
    outputs = {name: _shown(trace.system, name, value) for name, value in step.outputs.items()}
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


def _applicable(target: Target, system: TransitionSystem) -> list[Property]:
    known: set[Var] = {*system.state, *system.inputs, *system.fired}
    return [
        prop
        for prop in target.properties
        if all(
            (var if var.before is None else var.before) in known
            for var in variables([prop.term, prop.response, prop.given])
        )
    ]


def _finding(target: Target, path: Path, prop: Property, verdict: Result, started: float) -> Finding:
    seconds = time.monotonic() - started
    name = f"{target.name}/replay/{path.stem}: {prop.name}"
    return Finding(name, target.name, "replay", prop.statement, verdict, f"replay of {path.name}", seconds, prop.trace)


def _containment(
    target: Target, path: Path, rows: Sequence[Row], trace: Trace, truth: Sequence[int | None], started: float
) -> Finding:
    wrong = [row.number for row in rows if row.truth == "WRONG"]
    invalid = sum(row.truth == "INVALID" for row in rows)
    notes = {"contained": str(sum(row.truth == "contained" for row in rows)), "not reported": str(invalid)}
    outcome: Result = Held("replay", 1, len(rows), notes)
    seen: tuple[int | None, ...] = ()
    if wrong:
        part = Trace(trace.system, trace.initial, trace.steps[: wrong[0]])
        steps = ", ".join(map(str, wrong[:10])) + (f" and {len(wrong) - 10} more" if len(wrong) > 10 else "")
        outcome = Violated(part, "replay", f"the reported interval misses truth_mm at steps {steps}")
        seen = tuple(truth[: wrong[0]])
    return Finding(
        f"{target.name}/replay/{path.stem}: truth",
        target.name,
        "replay",
        "the reported interval holds the truth of the recording",
        outcome,
        f"replay of {path.name}",
        time.monotonic() - started,
        truth_mm=seen,
    )
