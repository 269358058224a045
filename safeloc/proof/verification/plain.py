"""Findings as plain data (what JSON can hold), to be sent between processes and kept in files.

Runs are stored with states and outputs, so that nothing has to be run again. Steps that several runs share, such as those of a
recording on which many witnesses lie, are stored once, as a course (safeloc.proof.verification.courses). So is each
certificate: most proofs of a machine rest on the same ones, which would take fifty times the space otherwise. The invariant of a
proof is left out: the certificates hold it.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import fields, replace
from typing import Any, TypeAlias

from safeloc.language.system import TransitionSystem, without_ghosts
from safeloc.language.trace import Step, Trace
from safeloc.language.verdict import Held, NotAsked, Proved, Result, Unknown, Vacuous, Violated
from safeloc.proof.results import Finding, Replayed
from safeloc.proof.verification.courses import Course, KeptCourse, KeptTrace

Plain: TypeAlias = dict[str, Any]
_RESULTS: Mapping[str, type[Result]] = {
    kind.__name__: kind for kind in (Proved, Violated, Unknown, Vacuous, NotAsked, Held)
}
_TRACES = ("witness", "trace", "escape")
_OWN = ("result", "replayed")


def pack_findings(findings: Sequence[Finding], system: TransitionSystem) -> Plain:
    """Return findings about one system as plain data; ValueError for a run of another system."""
    packing = _Packing(system)
    rows = [packing.finding(one) for one in findings]
    return {
        "courses": [one.text for one in packing.courses],
        "traces": packing.traces,
        "replays": packing.replays,
        "certificates": packing.certificates,
        "findings": rows,
    }


def unpack_findings(packed: Plain, system: TransitionSystem) -> list[Finding]:
    """Rebuild the findings; KeyError, TypeError or ValueError for data that `pack_findings` did not make."""
    systems = {"whole": system, "board": without_ghosts(system)}
    systems |= {f"part {part.name}": part.alone for part in system.parts}
    courses = [KeptCourse(text) for text in packed["courses"]]
    traces = [
        KeptTrace(systems[one["system"]], one["initial"], courses[one["course"]], one["steps"])
        for one in packed["traces"]
    ]
    replays = [Replayed(one["name"], traces[one["trace"]], tuple(one["truth_mm"])) for one in packed["replays"]]
    return [_unpacked(row, traces, replays, packed["certificates"]) for row in packed["findings"]]


class _Packing:
    """The runs and replays packed so far, each with its index in the data, and the certificates by the names of their files."""

    def __init__(self, system: TransitionSystem) -> None:
        self.courses: list[Course] = []
        self._begun: dict[int, int] = {}  # id of a first step -> the number of its course, which holds the step
        self.traces: list[Plain] = []
        self.replays: list[Plain] = []
        self.certificates: dict[str, str] = {}
        self._names = {
            frozenset(var.name for var in one.inputs): kind
            for kind, one in (("board", without_ghosts(system)), ("whole", system))
        }
        self._met: dict[int, tuple[object, int]] = {}  # holds each object, so that no other gets its id

    def finding(self, finding: Finding) -> Plain:
        """Return one row; shared runs and replays are given by index."""
        row = {field.name: getattr(finding, field.name) for field in fields(finding) if field.name not in _OWN}
        replayed = finding.replayed
        return {
            **row,
            "requirements": list(finding.requirements),
            "truth_mm": list(finding.truth_mm),
            "notes": dict(finding.notes),
            "result": self._result(finding.result),
            "replayed": None if replayed is None else self._once(replayed, self.replays, self._replayed),
        }

    def _result(self, result: Result) -> Plain:
        values = {field.name: getattr(result, field.name) for field in fields(result) if field.name != "invariant"}
        for name in _TRACES:
            if values.get(name) is not None:
                values[name] = self._once(values[name], self.traces, self._trace)
        if isinstance(result, Proved):  # files of one name have the same content
            self.certificates.update(result.certificates)
            values["certificates"] = list(result.certificates)
        return {"kind": type(result).__name__, **{name: _plain(value) for name, value in values.items()}}

    def _once(self, thing: Any, among: list[Plain], packed: Any) -> int:
        if id(thing) not in self._met:
            among.append(packed(thing))
            self._met[id(thing)] = (thing, len(among) - 1)
        return self._met[id(thing)][1]

    def _replayed(self, one: Replayed) -> Plain:
        trace = self._once(one.trace, self.traces, self._trace)
        return {"name": one.name, "trace": trace, "truth_mm": list(one.truth_mm)}

    def _trace(self, trace: Trace) -> Plain:
        kind = self._names.get(frozenset(var.name for var in trace.system.inputs))
        if trace.system.composition:
            kind = f"part {trace.system.machines[0].name}"
        if kind is None:
            raise ValueError(f"a run of {trace.system.name} with other inputs cannot be packed")
        return {
            "system": kind,
            "initial": dict(trace.initial),
            "course": self._course(trace.steps),
            "steps": len(trace.steps),
        }

    def _course(self, steps: Sequence[Step]) -> int:
        """Return the number of the course that these steps begin, or of a new one."""
        begun = self._begun.get(id(steps[0])) if steps else None
        if begun is not None and self.courses[begun].shares(steps):
            self.courses[begun].extend(steps)
            return begun
        self.courses.append(Course(steps))
        if steps:
            self._begun[id(steps[0])] = len(self.courses) - 1
        return len(self.courses) - 1


def _plain(value: Any) -> Any:
    if isinstance(value, Mapping):
        return dict(value)
    return list(value) if isinstance(value, tuple) else value


def _unpacked(
    row: Plain, traces: Sequence[Trace], replays: Sequence[Replayed], certificates: Mapping[str, str]
) -> Finding:
    made = Finding(**{**row, "result": _unpacked_result(row["result"], traces, certificates), "replayed": None})
    replayed = None if row["replayed"] is None else replays[row["replayed"]]
    return replace(made, requirements=tuple(row["requirements"]), truth_mm=tuple(row["truth_mm"]), replayed=replayed)


def _unpacked_result(packed: Plain, traces: Sequence[Trace], certificates: Mapping[str, str]) -> Result:
    values = {name: value for name, value in packed.items() if name != "kind"}
    for name in _TRACES:
        if values.get(name) is not None:
            values[name] = traces[values[name]]
    if packed["kind"] == "Proved":
        texts = {name: certificates[name] for name in values["certificates"]}
        return Proved(None, **{**values, "rechecked": tuple(values["rechecked"]), "certificates": texts})
    return _RESULTS[packed["kind"]](**values)
