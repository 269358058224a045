"""A report as plain data: `report.json`, schema `safeloc-report/5` (report.schema.json beside this file)."""

from __future__ import annotations

import json
import platform
import time
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import asdict, dataclass
from importlib import metadata
from pathlib import Path
from types import MappingProxyType
from typing import Any, assert_never

from safeloc import yices
from safeloc.assurance.independence import shared_terms
from safeloc.assurance.mutation.strength import Strengths, as_text
from safeloc.assurance.requirements import Link, traceability
from safeloc.catalogue import Target
from safeloc.language.absence import stand_ins, without_absent
from safeloc.language.trace import Trace, present_inputs
from safeloc.language.verdict import Held, NotAsked, Proved, Unknown, Vacuous, Violated, told, word, worst
from safeloc.proof.cache.engine import source_digest
from safeloc.proof.results import Finding
from safeloc.report.conditions import conditions, counts
from safeloc.report.machines import machine_data
from safeloc.report.verdict_words import requirement_verdict

SCHEMA = "safeloc-report/5"
_SCHEMA_FILE = Path(__file__).with_name("report.schema.json")
VERSIONED = ("safeloc", "z3-solver", "cvc5", "hypothesis", "numpy", "transitions", "pydantic")
NOT_ASKED: Mapping[str, Any] = MappingProxyType({})
MOST_CELLS = 10_000  # most values of a witness in the data; the localizer has 500 in every step


@dataclass(frozen=True, eq=False)
class OfTarget:
    """The part of a report that follows from the declaration of a target alone.

    machine  all that the page shows of it, except verdicts
    shared   id of a claim -> the sizes of the sub-terms that it shares with the machine
    """

    machine: Mapping[str, Any]
    shared: Mapping[str, str]


def of_target(target: Target) -> OfTarget:
    """Return what the declaration of a target says; with many targets it takes as long as all the rest of the data."""
    return OfTarget(machine_data(target), _shared(target))


def schema() -> dict[str, Any]:
    """Return the published JSON schema."""
    loaded: dict[str, Any] = json.loads(_SCHEMA_FILE.read_text(encoding="utf-8"))
    return loaded


def report_data(
    findings: Sequence[Finding],
    targets: Iterable[Target],
    evidence: Mapping[str, Any] = NOT_ASKED,
    strengths: Strengths | None = None,
    made: Mapping[str, Any] | None = None,
    margins: Mapping[str, Any] = NOT_ASKED,
    scores: Mapping[str, Any] = NOT_ASKED,
    of_targets: Mapping[str, OfTarget] = NOT_ASKED,
    pictures: Mapping[str, list[dict[str, Any]]] = NOT_ASKED,
) -> dict[str, Any]:
    """Return the complete report as JSON-ready data.

    evidence   target's name -> proof cores and effects of broken clauses (safeloc.report.proof_evidence), if available
    strengths  strength of the evidence for each requirement, if available
    made       command, limits, seed and commit (safeloc.report.made_by), if a command makes the report
    margins    target's name -> how far its figures may move (safeloc.assurance.margins.kept_margins), where that was found
    scores     target's name -> how many wrong machines a proof notices (safeloc.assurance.mutation.kept_score), where that was measured
    of_targets  target's name -> what its declaration alone says (`of_target`), where that was made before
    pictures   target's name -> the pictures of its recordings (`pictures_of`), where they were made before
    """
    targets = list(targets)
    own = {target.name: of_targets.get(target.name) or of_target(target) for target in targets}
    traced = traceability(targets)
    machines = [
        {
            **own[target.name].machine,
            "pictures": pictures[target.name] if target.name in pictures else pictures_of(target, findings),
            "evidence": evidence.get(target.name),
            "margins": margins.get(target.name),
            "mutation": scores.get(target.name),
        }
        for target in targets
    ]
    return {
        "schema": SCHEMA,
        "made": time.strftime("%Y-%m-%dT%H:%M:%SZ", time.gmtime()),
        "verdict": worst(word(finding.result) for finding in findings),
        **({} if made is None else {"made_by": dict(made)}),
        "versions": versions(),
        "kept": {one.machine: one.kept_since for one in findings if one.kept_since},
        "conditions": counts(conditions(machines)),
        "machines": machines,
        "results": _results(findings, {name: one.shared for name, one in own.items()}),
        "requirements": [_requirement(link, findings, strengths) for link in traced.links],
        "items": [{**asdict(item), "requirements": list(item.requirements)} for item in traced.items],
    }


def pictures_of(target: Target, findings: Sequence[Finding]) -> list[dict[str, Any]]:
    """Return the pictures of a target's recordings; with many recordings they take as long as all the rest of the data."""
    if not target.pictures:
        return []
    from safeloc.report.pictures import pictures_data  # a machine without pictures needs none of the railway

    return pictures_data(target, findings)


def _results(findings: Sequence[Finding], shared: Mapping[str, Mapping[str, str]]) -> list[dict[str, Any]]:
    """Return every finding; that of a property also notes the sub-terms that it shares with its machine, by target and claim."""
    rows = _with_statistics_once([result_data(finding) for finding in findings])
    for row in rows:
        if row["kind"] == "property" and (note := shared.get(row["machine"], {}).get(row["id"])):
            row["notes"] = {**row["notes"], "shared with the machine": note}
    return rows


def _with_statistics_once(rows: list[dict[str, Any]]) -> list[dict[str, Any]]:
    """Leave out of each test what the first test of its machine notes too, since one run of the tests serves many properties.

    A test of another run notes what differs; the next tests of that run only name it.
    """
    runs: dict[str, dict[str, Mapping[str, str]]] = {}
    for row in rows:
        if row["kind"] == "test":
            known = runs.setdefault(row["machine"], {})
            row["notes"] = _noted_once(row["id"].split("/", 2)[-1], row["notes"], known)
    return rows


def _noted_once(name: str, notes: Mapping[str, str], known: dict[str, Mapping[str, str]]) -> Mapping[str, str]:
    """Return what a test still has to note; `known` are the notes of the first test of each run, by the test's name."""
    like = next((other for other, others in known.items() if others == notes), "")
    if not known or not like:
        known[name] = notes
        first = next(iter(known.values()))
        return notes if first is notes else {key: text for key, text in notes.items() if first.get(key) != text}
    return {} if known[like] is next(iter(known.values())) else {"statistics as of": like}


def _shared(target: Target) -> dict[str, str]:
    """Return, by the id of a claim, the sizes of the sub-terms that it shares with the machine."""
    sizes: dict[str, list[int]] = {}
    for one in shared_terms(target):
        sizes.setdefault(one.of, []).append(one.nodes)
    return {
        f"{target.name}/property/{prop.name}": f"terms of {', '.join(map(str, sorted(found, reverse=True)))} nodes"
        for prop in target.properties
        if (found := sizes.get(f"property {prop.name}"))
    }


def versions() -> dict[str, str]:
    """Return the versions of all packages that a verdict depends on, and a digest of safeloc's own files."""
    found = {"python": platform.python_version(), "platform": platform.platform(), "source digest": source_digest()}
    for name in VERSIONED:
        try:
            found[name] = metadata.version(name)
        except metadata.PackageNotFoundError:
            found[name] = "not installed as a package"
    found["yices"] = yices.version() or "not installed"
    return found


def result_data(finding: Finding) -> dict[str, Any]:
    """Return one finding as data."""
    return {
        "id": finding.id,
        "machine": finding.machine,
        "kind": finding.kind,
        "statement": finding.statement,
        "verdict": word(finding.result),
        **({} if (shown := told(finding.result)) == word(finding.result) else {"told": shown}),
        "method": finding.method,
        "depth": _depth(finding),
        "seconds": round(finding.seconds, 3),
        **_confirmation(finding),
        "requirements": list(finding.requirements),
        "assumption": finding.assumption,
        "reason": _reason(finding),
        "notes": {
            **(finding.result.notes if isinstance(finding.result, Held) else {}),
            **finding.notes,
            **_left(finding),
        },
        "trace": None if _left(finding) else trace_data(run_of(finding), finding.truth_mm),
    }


def _confirmation(finding: Finding) -> dict[str, Any]:
    """Return the confirming solvers, the files of certificates, and the reason if it is proved by construction."""
    proof = finding.result if isinstance(finding.result, Proved) else None
    return {
        "rechecked": [] if proof is None else list(proof.rechecked),
        "certificates": [] if proof is None else sorted(proof.certificates),
        "by_construction": "" if proof is None else proof.by_construction,
    }


def _left(finding: Finding) -> dict[str, str]:
    """Return a note that replaces a long witness, or one of a single machine, whose variables the page does not know.

    Such a witness is only in the folder of traces.
    """
    trace = finding.result.witness if isinstance(finding.result, Proved) else None
    if trace is not None and trace.system.composition:
        alone = f"{trace.system.machines[0].name} by itself"
        return {"witness": f"a run of {trace.length} steps of {alone}, in the folder of traces only"}
    if trace is None or trace.length * len(trace.initial) <= MOST_CELLS:
        return {}
    return {"witness": f"a run of {trace.length} steps, in the folder of traces only"}


def _depth(finding: Finding) -> int:
    match finding.result:
        case Proved(depth=depth) | Unknown(depth=depth):
            return depth
        case Violated(trace=trace) | Vacuous(trace=trace):
            return 0 if trace is None else trace.length
        case Held(steps=steps):
            return steps
        case NotAsked():
            return 0
        case _:
            assert_never(finding.result)


def _reason(finding: Finding) -> str:
    return finding.result.reason if isinstance(finding.result, (Violated, Unknown, Vacuous, NotAsked)) else ""


def run_of(finding: Finding) -> Trace | None:
    """Return the run that is the evidence of a verdict: a witness, a violation, or a counterexample to induction."""
    match finding.result:
        case Violated(trace=trace) | Vacuous(trace=trace) | Unknown(escape=trace):
            return trace
        case Proved(witness=witness):
            return witness
        case Held() | NotAsked():
            return None
        case _:
            assert_never(finding.result)


def trace_data(trace: Trace | None, truth_mm: Sequence[int | None] = ()) -> dict[str, Any] | None:
    """Return first state and steps: inputs that were present, transitions, state, and outputs (null if absent)."""
    if trace is None:
        return None
    steps = [
        {
            "inputs": present_inputs(trace.system, step.inputs),
            "fired": dict(step.fired),
            "state": dict(step.state),
            "outputs": without_absent(step.outputs, stand_ins(trace.system)),
        }
        for step in trace.steps
    ]
    return {"first": dict(trace.initial), "steps": steps, "truth_mm": list(truth_mm)}


def _verdict_of(findings: Sequence[Finding]) -> str:
    """Return the verdict of a requirement: that of its properties, unless a test or a replay did not hold; nothing if none."""
    if not findings:
        return ""
    found = worst(word(one.result) for one in findings)
    proofs = [word(one.result) for one in findings if one.kind not in ("test", "replay")]
    return worst(proofs) if found == "held" and proofs else found


def _requirement(link: Link, findings: Sequence[Finding], strengths: Strengths | None) -> dict[str, Any]:
    one = link.requirement
    about_it = [finding for finding in findings if one.id in finding.requirements]
    verdict = _verdict_of(about_it)
    shown = requirement_verdict(verdict, [told(finding.result) for finding in about_it])
    return {
        "id": one.id,
        "kind": one.kind,
        "machine": one.machine,
        "status": one.status,
        "text": one.text,
        "source": one.source,
        "carried_by": one.carried_by,
        "transitions": list(link.transitions),
        "results": [finding.id for finding in about_it],
        "verdict": verdict,
        **({} if shown == verdict else {"told": shown}),
        "strength": as_text(strengths.get(one.id, ())) if link.transitions and strengths is not None else [],
    }
