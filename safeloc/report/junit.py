"""Findings as JUnit XML, for continuous integration servers.

Violated is a failure; unknown, vacuous and not asked are errors. A test case that passes was proved if it is a property, obligation or lemma, and
held if it is a test or a replay; one that runs alone show says so, since servers have one word for all that passes.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import assert_never
from xml.etree import ElementTree

from safeloc.language.verdict import SHOWN, Held, NotAsked, Proved, Unknown, Vacuous, Violated
from safeloc.proof.results import Finding


def to_junit(findings: Sequence[Finding]) -> str:
    """Return XML with one test case for each finding, grouped by machine; its class is `machine.kind`, its name the rest of the id."""
    root = ElementTree.Element("testsuites", name="safeloc")
    for machine in dict.fromkeys(finding.machine for finding in findings):
        of_machine = [finding for finding in findings if finding.machine == machine]
        failed = sum(isinstance(finding.result, Violated) for finding in of_machine)
        unsure = sum(isinstance(finding.result, (Unknown, Vacuous, NotAsked)) for finding in of_machine)
        counts = {"tests": str(len(of_machine)), "failures": str(failed), "errors": str(unsure)}
        suite = ElementTree.SubElement(root, "testsuite", {"name": machine, **counts})
        for finding in of_machine:
            _case(suite, finding)
    ElementTree.indent(root, space="")
    return '<?xml version="1.0" encoding="utf-8"?>\n' + ElementTree.tostring(root, encoding="unicode") + "\n"


def _case(suite: ElementTree.Element, finding: Finding) -> None:
    time, name = f"{finding.seconds:.3f}", finding.id.removeprefix(f"{finding.machine}/{finding.kind}/")
    case = ElementTree.SubElement(
        suite, "testcase", classname=f"{finding.machine}.{finding.kind}", name=name, time=time
    )
    match finding.result:
        case Violated(trace, engine, reason):
            failure = ElementTree.SubElement(case, "failure", message=f"{finding.statement} ({engine}) {reason}")
            failure.text = "" if trace is None else trace.table()
        case Unknown(reason) as unknown:
            ElementTree.SubElement(case, "error", message=f"undecided: {reason} ({unknown.searched})")
        case Vacuous(reason, trace):
            error = ElementTree.SubElement(case, "error", message=f"vacuous: {reason}")
            error.text = "" if trace is None else trace.table()
        case NotAsked(reason):
            ElementTree.SubElement(case, "error", message=f"not asked: {reason}")
        case Proved() if finding.result.is_shown_by_runs:
            ElementTree.SubElement(case, "system-out").text = SHOWN
        case Proved() | Held():
            pass
        case _:
            assert_never(finding.result)
