"""What proofs rest on and what becomes of broken clauses: in the report's data, in its folder and on its page."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import jsonschema
import pytest

from safeloc.assurance.evidence.effects import Effect, Run
from safeloc.catalogue import Target, load_target
from safeloc.proof.cores.clauses import ClauseId
from safeloc.proof.cores.cores import Core
from safeloc.proof.cores.elements import Element
from safeloc.report.data import report_data, schema
from safeloc.report.folder import render_folder, write_folder
from safeloc.report.page import to_html
from safeloc.report.proof_evidence import evidence_data
from safeloc.report.stored import read_for_page
from safeloc.target import Hazard

TRUE_SENT = "a position that is sent holds the truth"
CLAUSE = Element("clause", "transmission", TRUE_SENT)
ROWS = tuple(Element("row", "transmission", f"row {number}") for number in range(5))


def transmission() -> Target:
    """The position over a radio link."""
    return load_target("transmission")


def evidence(end: Any = "wrong", **fields: Any) -> dict[str, Any]:
    """A claim that rests on a clause, on a lemma and on five rows, one that no set was found of; and the clause broken."""
    cores = [
        Core("containment", (CLAUSE, Element("lemma", "transmission", "inside <b>"), *ROWS), 2, "", (ROWS[0],)),
        Core("tolerance", (), 1),
        Core("a run", why_none="shown by a run"),
        Core("hard", why_none="not proved by induction within the limits"),
    ]
    broken = (ClauseId("transmission", TRUE_SENT),)
    effect = Effect(
        broken, ("tolerance",), {"containment": 1, "age": 2}, ("hard",), end, withdrawn_by=("sent",), **fields
    )
    return evidence_data(replace(transmission(), hazard=Hazard("it is lost", ("containment",))), cores, [effect])


def page(**told: Any) -> str:
    """The page of a report with nothing but this."""
    return to_html(report_data([], [transmission()], {"transmission": evidence(**told)}))


def test_the_page_tells_what_a_claim_rests_on() -> None:
    """Clauses by name, many rows by their number, what is undecided, what no claim needs, and no set of a claim that a run shows."""
    shown = page()
    assert f"<td>{TRUE_SENT}</td>" in shown
    assert "2-induction" in shown
    assert f"<td>5 of {len(transmission().machines[0].transitions)}" in shown
    assert "inside &lt;b&gt;" in shown
    assert "perhaps not needed, undecided: row 0" in shown
    assert "not proved by induction within the limits" in shown
    assert "<b>a run</b>" not in shown
    machine = transmission().machines[0]
    others = [name for name in machine.world.laws if name != TRUE_SENT]
    assert (
        f"Clauses that no claim needs (obligations, such as ranges, may need them): {'; '.join(others) or 'none'}."
        in shown
    )
    assert (
        "Transitions whose effect no claim needs (when they fire is kept, and may be needed): "
        + "; ".join(row.name for row in transmission().machines[0].transitions).replace("'", "&#39;")
        in shown
    )


@pytest.mark.thorough(ordinary=3)
@pytest.mark.parametrize(
    ("end", "fields", "words", "colour"),
    [
        ("wrong", {"run": Run({}, ({}, {}), "sent")}, "can miss the truth for more than 10 cycles; shortest run: 2 cycles, ends with", "violated"),
        ("withdrawn", {"within_cycles": 5}, "a wrong interval is right again or withdrawn within 5 cycles (proved)", "held"),
        ("contained", {}, "the reported interval still contains the truth (proved)", "proved"),
        ("undecided", {}, "undecided within the limits", "unknown"),
        ("no interval", {}, "none: the target reports no interval and declares no hazard", "soft"),
        ("hazard", {"run": Run({}, ({},), "sent")}, "it is lost; shortest run: 1 cycle, ends with", "violated"),
        ("no hazard", {}, "proved never: it is lost", "proved"),
    ],
)  # fmt: skip
def test_the_page_tells_what_becomes_of_a_broken_clause(
    end: str, fields: dict[str, Any], words: str, colour: str
) -> None:
    """The clause by number and name with its owner, claims lost after so many cycles, what detects it, and the end effect."""
    shown = page(end=end, **fields)
    assert f'<td class="{colour}">' in shown
    assert words in shown
    assert "containment (after 1 cycle)<br>age (after 2 cycles)" in shown
    assert '<span class="unknown">not decided: hard</span>' in shown
    assert f'<b class="id">transmission/A1</b> {TRUE_SENT}' in shown
    assert "<td>sent</td>" in shown


def test_the_picture_shows_the_cut_sets() -> None:
    """In red where a run was found."""
    assert "transmission/A1 " + TRUE_SENT in evidence()["picture"]


def test_what_was_not_asked_is_said() -> None:
    """With the command that asks it."""
    assert "safeloc verify transmission --evidence" in to_html(report_data([], [transmission()]))


def test_data_keep_to_the_schema_and_come_back(tmp_path: Path) -> None:
    """Beside report.json, with the rest of the machine; and the page is rendered again from there."""
    given = {"transmission": evidence(run=Run({"mode": 0}, ({"sent": True},), "sent"))}
    jsonschema.validate(report_data([], [transmission()], given), schema())
    first = write_folder(tmp_path, [], [transmission()], evidence=given).read_text(encoding="utf-8")
    [machine] = read_for_page(tmp_path)["machines"]
    assert (
        given["transmission"]["faults"]["effects"][0]["end_effect"]
        == machine["evidence"]["faults"]["effects"][0]["end_effect"]
    )
    assert first == render_folder(tmp_path).read_text(encoding="utf-8")
