"""Findings as plain data (what JSON can hold), to be sent between processes and kept in files.

Runs are stored with states and outputs, so that nothing has to be run again; a run that several findings share is stored
once. The invariant of a proof is left out: the certificates hold it.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import fields, replace
from typing import Any, TypeAlias

from safeloc.language.system import TransitionSystem, without_ghosts
from safeloc.language.trace import Step, Trace
from safeloc.language.verdict import Held, NotAsked, Proved, Result, Unknown, Vacuous, Violated
from safeloc.proof.results import Finding, Replayed

Plain: TypeAlias = dict[str, Any]
_RESULTS: Mapping[str, type[Result]] = {
    kind.__name__: kind for kind in (Proved, Violated, Unknown, Vacuous, NotAsked, Held)
}
_TRACES = ("witness", "trace")
_MAPPINGS = ("inputs", "fired", "state", "outputs")
_OWN = ("result", "replayed")


def pack_findings(findings: Sequence[Finding], system: TransitionSystem) -> Plain:
    """Return findings about one system as plain data; ValueError for a run of another system."""
    packing = _Packing(system)
    rows = [packing.finding(one) for one in findings]
    return {"traces": packing.traces, "replays": packing.replays, "findings": rows}


def unpack_findings(packed: Plain, system: TransitionSystem) -> list[Finding]:
    """Rebuild the findings; KeyError, TypeError or ValueError for data that `pack_findings` did not make."""
    systems = {"whole": system, "board": without_ghosts(system)}
    systems |= {f"part {part.name}": part.alone for part in system.parts}
    traces = [_unpacked_trace(one, systems[one["system"]]) for one in packed["traces"]]
    replays = [Replayed(one["name"], traces[one["trace"]], tuple(one["truth_mm"])) for one in packed["replays"]]
    return [_unpacked(row, traces, replays) for row in packed["findings"]]


class _Packing:
    """The runs and replays packed so far, each with its index in the data."""

    def __init__(self, system: TransitionSystem) -> None:
        self.traces: list[Plain] = []
        self.replays: list[Plain] = []
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
        names = [list(getattr(trace.steps[0], each)) for each in _MAPPINGS] if trace.steps else []
        rows = [
            [[getattr(step, each)[name] for name in columns] for each, columns in zip(_MAPPINGS, names, strict=True)]
            for step in trace.steps
        ]
        return {"system": kind, "initial": dict(trace.initial), "names": names, "rows": rows}


def _plain(value: Any) -> Any:
    if isinstance(value, Mapping):
        return dict(value)
    return list(value) if isinstance(value, tuple) else value


def _unpacked_trace(packed: Plain, system: TransitionSystem) -> Trace:
    names = packed["names"]
    steps = (
        Step(*(dict(zip(columns, values, strict=True)) for columns, values in zip(names, row, strict=True)))
        for row in packed["rows"]
    )
    return Trace(system, packed["initial"], tuple(steps))


def _unpacked(row: Plain, traces: Sequence[Trace], replays: Sequence[Replayed]) -> Finding:
    made = Finding(**{**row, "result": _unpacked_result(row["result"], traces), "replayed": None})
    replayed = None if row["replayed"] is None else replays[row["replayed"]]
    return replace(made, requirements=tuple(row["requirements"]), truth_mm=tuple(row["truth_mm"]), replayed=replayed)


def _unpacked_result(packed: Plain, traces: Sequence[Trace]) -> Result:
    values = {name: value for name, value in packed.items() if name != "kind"}
    for name in _TRACES:
        if values.get(name) is not None:
            values[name] = traces[values[name]]
    if packed["kind"] == "Proved":
        return Proved(None, **{**values, "rechecked": tuple(values["rechecked"])})
    return _RESULTS[packed["kind"]](**values)
