"""Findings as SARIF 2.1.0 (OASIS), for editors and code hosts that show results beside the source line.

Violated is an error; unknown and vacuous are warnings; not asked is a note. What is proved or held is not listed.
"""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from importlib import metadata
from typing import Any, get_args

from safeloc.catalogue import Target
from safeloc.language.verdict import Held, NotAsked, Proved, Result, Unknown, Vacuous, Violated, word
from safeloc.proof.results import Finding, Kind
from safeloc.report.declared import place

SCHEMA = "https://json.schemastore.org/sarif-2.1.0.json"
_RULES: Mapping[Kind, str] = {
    "property": "A claim about the machine",
    "obligation": "A check that every machine gets",
    "lemma": "A fact that proofs use",
    "test": "A property test: drawn runs",
    "replay": "A recording, run through the machine",
}


def to_sarif(findings: Sequence[Finding], targets: Sequence[Target]) -> str:
    """Return JSON with a result for each finding that does not hold, at the declaration of its claim, else of its machine."""
    sources = _sources(targets)
    rules = [{"id": kind, "shortDescription": {"text": _RULES[kind]}} for kind in get_args(Kind)]
    driver = {"name": "safeloc", "version": metadata.version("safeloc"), "rules": rules}
    results = [_result(one, sources) for one in findings if not isinstance(one.result, (Proved, Held))]
    log = {"$schema": SCHEMA, "version": "2.1.0", "runs": [{"tool": {"driver": driver}, "results": results}]}
    return json.dumps(log, indent=1) + "\n"


def _sources(targets: Sequence[Target]) -> dict[tuple[str, str], str]:
    """Return `file:line` of each property, by target and name, and of each target's first machine, by the target's name alone."""
    found = {(target.name, ""): target.machines[0].src for target in targets if target.machines}
    return found | {(target.name, prop.name): prop.src for target in targets for prop in target.properties}


def _result(finding: Finding, sources: Mapping[tuple[str, str], str]) -> dict[str, Any]:
    name = finding.id.removeprefix(f"{finding.machine}/{finding.kind}/")
    src = sources.get((finding.machine, name)) or sources.get((finding.machine, ""), "")
    return {
        "ruleId": finding.kind,
        "level": _level(finding.result),
        "message": {"text": _message(finding)},
        "locations": [_location(src)] if src else [],
        "partialFingerprints": {"safelocId/v1": finding.id},
    }


def _level(result: Result) -> str:
    match result:
        case Violated():
            return "error"
        case Unknown() | Vacuous():
            return "warning"
        case _:
            return "note"


def _message(finding: Finding) -> str:
    result = finding.result
    said = f"{word(result)}: {finding.id}: {finding.statement or finding.method}"
    reason = result.reason if isinstance(result, (Violated, Unknown, Vacuous, NotAsked)) else ""
    trace = result.trace if isinstance(result, (Violated, Vacuous)) else None
    run = "" if trace is None else f"traces/ of the report holds its run of {trace.length} steps"
    return "; ".join(part for part in (said, reason, run) if part)


def _location(src: str) -> dict[str, Any]:
    file, _, line = place(src).rpartition(":")
    region = {"region": {"startLine": int(line)}} if line.isdigit() else {}
    return {"physicalLocation": {"artifactLocation": {"uri": file, "uriBaseId": "%SRCROOT%"}, **region}}
