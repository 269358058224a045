"""SARIF: what does not hold, with its level, its reason and the line of its declaration; what holds is not listed."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from safeloc.language.verdict import NotAsked, Proved, Result, Vacuous, Violated
from safeloc.proof.results import Finding
from safeloc.report.sarif import to_sarif
from tests.report.lamp import UNDECIDED, findings, target

LAMP = Path(__file__).with_name("lamp.py")


def results(found: list[Finding]) -> list[dict[str, Any]]:
    """The results of a log with one run of one tool."""
    log = json.loads(to_sarif(found, [target()]))
    assert log["version"] == "2.1.0"
    (run,) = log["runs"]
    rules = {rule["id"] for rule in run["tool"]["driver"]["rules"]}
    assert {one["ruleId"] for one in run["results"]} <= rules
    return list(run["results"])


def test_what_holds_is_not_listed() -> None:
    """The lamp has one violated and one undecided property; the proved ones have no result."""
    found = results(list(findings()))
    assert any(isinstance(one.result, Proved) for one in findings())
    assert [(one["level"], one["partialFingerprints"]["safelocId/v1"]) for one in found] == [
        ("error", "lamp/property/wears & tears"),
        ("warning", "lamp/property/later"),
    ]


def test_a_violated_property_points_to_its_declaration() -> None:
    """File and line are those of the claim, relative to the working folder; the message says how long its run is."""
    (violated, _) = results(list(findings()))
    (location,) = violated["locations"]
    at = location["physicalLocation"]
    line = LAMP.read_text(encoding="utf-8").splitlines()[at["region"]["startLine"] - 1]
    assert at["artifactLocation"] == {"uri": "tests/report/lamp.py", "uriBaseId": "%SRCROOT%"}
    assert line.strip().startswith("never(")
    result = next(one.result for one in findings() if isinstance(one.result, Violated))
    assert result.trace is not None
    assert violated["message"]["text"] == (
        "violated: lamp/property/wears & tears: never <b>twice</b>; "
        f"traces/ of the report holds its run of {len(result.trace.steps)} steps"
    )


@pytest.mark.parametrize(
    ("result", "level"), [(Vacuous("never so"), "warning"), (NotAsked("none is declared"), "note")]
)
def test_what_says_nothing_is_listed(result: Result, level: str) -> None:
    """With its reason, and for want of a declaration of its own at the machine's."""
    (one,) = results([replace(UNDECIDED, id="lamp/test/runs", kind="test", result=result)])
    assert one["level"] == level
    assert result.reason in one["message"]["text"]  # type: ignore[union-attr]
    line = one["locations"][0]["physicalLocation"]["region"]["startLine"]
    assert LAMP.read_text(encoding="utf-8").splitlines()[line - 1].startswith("machine = Machine(")
