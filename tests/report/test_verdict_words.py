"""What a reader is told: what always holds and what one run shows are two things, and no requirement is proved as such."""

from __future__ import annotations

import json
from typing import Any
from xml.etree import ElementTree

import jsonschema

from safeloc.cli.finding_lines import finding_line
from safeloc.cli.show import summed_up
from safeloc.language.spec import reachable
from safeloc.language.verdict import SHOWN, told, word
from safeloc.proof.provers import antecedents
from safeloc.proof.provers.limits import Limits
from safeloc.proof.provers.portfolio import prove
from safeloc.proof.results import Finding, Findings
from safeloc.report.data import report_data, schema
from safeloc.report.junit import to_junit
from safeloc.report.page import to_html
from safeloc.report.verdict_words import requirement_lines, requirement_verdict, told_of
from tests.report import lamp

REACHED = reachable(
    "lit once", lamp.machine.mode.eq(lamp.LIT), statement="the lamp can be lit", requirements=("MRK-1",)
)


def found() -> list[Finding]:
    """Of the lamp: a claim about all runs that is proved, and one that a run shows."""
    always, *_ = lamp.findings()
    [reached] = prove(lamp.target().system, (REACHED,), Limits(depth=8, seconds=20))
    return [always, reached]


def row(verdict: str, kind: str = "property", rechecked: str = "yices 2.6.5") -> dict[str, Any]:
    """A result of a report."""
    return {"id": f"m/{kind}/one", "verdict": verdict, "kind": kind, "rechecked": [rechecked]}


def test_a_run_that_shows_it_is_no_proof_of_what_always_holds() -> None:
    """The stored verdict of both is `proved`; a terminal, a notebook and the counts tell them apart."""
    always, reached = found()
    assert ("proved", "proved") == (word(always.result), word(reached.result))
    assert ("proved", SHOWN) == (told(always.result), told(reached.result))
    assert finding_line(always).startswith("proved    lamp/property/new  [")
    assert finding_line(reached).startswith("shown     lamp/property/lit once  [")
    assert "all holds: 1 proved, 1 shown by a run" == summed_up([always, reached])
    assert Findings([always, reached])._repr_html_().startswith("<p>1 proved, 1 shown by a run</p>")
    assert "<b>shown by a run</b>" in reached.result._repr_html_()


def test_the_data_tell_them_apart_as_the_results_do() -> None:
    """By what confirmed the result, so that reports from before are told alike."""
    both = found()
    data = report_data(both, [lamp.target()])
    assert [told(one.result) for one in both] == [told_of(one) for one in data["results"]]


def test_the_page_says_which_is_which() -> None:
    """In the headline, in the table of the machine, and at the requirement."""
    page = to_html(report_data(found(), [lamp.target()]))
    assert "1 proved, 1 shown by a run, 0 held in tests and replays" in page
    assert '<td><span class="verdict shown-by-a-run">shown by a run</span></td><td class="says"><b>lit once</b>' in page
    assert "1 property proved</span>" in page
    assert "1 property shown by a run</span>" in page
    assert '<span class="verdict proved">proved</span></td></tr>' not in page


def test_a_requirement_says_what_stands_behind_it() -> None:
    """How many results of which kind have which verdict; never a bare `proved`."""
    proofs = [row("proved")] * 2 + [row("proved", rechecked="interpreter"), row("held", "replay")]
    assert [
        ("2 properties proved", "proved"),
        ("1 property shown by a run", SHOWN),
        ("1 replay held", "held"),
    ] == list(requirement_lines(proofs))
    assert "properties proved" == requirement_verdict("proved", ["proved", SHOWN, "held"])
    assert SHOWN == requirement_verdict("proved", [SHOWN, "held"])
    assert "violated" == requirement_verdict("violated", ["proved", "violated"])
    assert "" == requirement_verdict("", [])


def test_that_every_case_occurs_is_shown_by_runs() -> None:
    """Runs are all its evidence, though none is kept with it: each is a recording, or stands with a result of its own."""
    target = lamp.target()
    asked = antecedents.all_cases(target.properties)
    outcomes = antecedents.search(target.system, asked, Limits(depth=8, seconds=20))
    cases = antecedents.Found(target.system, tuple(map(antecedents.Case, asked, outcomes)))
    every, *_ = cases.obligation()
    finding = Finding(
        "lamp/obligation/antecedents", "lamp", "obligation", every.statement, every.verdict, every.method, 0.1
    )
    assert ("proved", SHOWN) == (word(finding.result), told(finding.result))
    assert finding_line(finding).startswith("shown ")
    data = report_data([finding], [target])
    assert ("proved", SHOWN) == (data["results"][0]["verdict"], data["results"][0]["told"])
    assert "0 proved, 1 shown by a run" in to_html(data)
    earlier = {key: value for key, value in data["results"][0].items() if key != "told"}
    assert SHOWN == told_of(earlier)
    assert SHOWN in to_junit([finding])


def test_the_data_say_beside_the_verdict_what_the_page_says() -> None:
    """Only where the word is another; the verdict itself stays what the checker reads. So does JUnit, and the schema knows it."""
    data = report_data(found(), [lamp.target()])
    assert [("proved", None), ("proved", SHOWN)] == [(one["verdict"], one.get("told")) for one in data["results"]]
    assert ["properties proved"] == [one["told"] for one in data["requirements"] if one["verdict"] == "proved"]
    jsonschema.validate(json.loads(json.dumps(data)), schema())
    cases = ElementTree.fromstring(to_junit(found()).partition("\n")[2]).iter("testcase")
    assert [("new", None), ("lit once", SHOWN)] == [(one.get("name"), one.findtext("system-out")) for one in cases]
