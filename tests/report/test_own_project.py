"""The report of a user's own machine: its recordings, formulas, conditions and requirements are told as those of a project."""

from __future__ import annotations

import html
import re
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import pytest
from jsonschema import validate

from safeloc.catalogue import load_target
from safeloc.language.verdict import NotAsked
from safeloc.proof.cores.cores import Core
from safeloc.proof.cores.elements import Element
from safeloc.proof.results import Finding
from safeloc.proof.verification.replay import replay_stream
from safeloc.report.data import report_data, schema
from safeloc.report.page import to_html
from safeloc.report.proof_evidence import evidence_data

MODULE = """
from safeloc import Law, Machine, Transition, World, always, modes, number, reachable, within
from safeloc.language.units import MM

(ON,) = table = modes("ON")
seen, last = number("seen_mm", MM, 0, 9_000), number("last_mm", MM, 0, 9_000)
place, run = number("place_mm", MM, 0, 9_000), number("run_mm", MM, 0, 100)
machine = Machine(
    name="gauge", modes=table, inputs=[seen], state={last: 0}, outputs={"last_mm": last},
    transitions=[Transition("keep", ON, ON, set={last: seen})],
    world=World(
        ghosts={place: 0}, choices=[run], moves={place: place + run},
        clauses={
            "the sensor is exact": Law(seen.eq(place + run), "What it says is so.", owner="supplier"),
            "the line ends": Law(place + run <= 9_000, "No train runs on.", owner="operator"),
        },
    ),
)
properties = [
    always("right", last.eq(place)),
    always("in range", last <= 9_000, statement="The last value is on the line."),
    within("answers", 3, seen > 10, last > 10),
    reachable("gets there", last.eq(100)),
]
recordings = ["run.jsonl"]
"""


def data_of(folder: Path, cores: Sequence[Core] | None = None) -> dict[str, Any]:
    """The report of the machine: each claim not asked, and one replayed recording; `cores` are its proof cores, if it has them."""
    (folder / "gauge.py").write_text(MODULE, encoding="utf-8")
    (folder / "run.jsonl").write_text('{"seen_mm": 50, "run_mm": 50}\n', encoding="utf-8")
    target = load_target(f"{folder / 'gauge.py'}:machine")
    _, replayed = replay_stream(target, folder / "run.jsonl")
    asked = [
        Finding(f"gauge/property/{prop.name}", "gauge", "property", prop.statement, NotAsked("quick"), "", 0.0)
        for prop in target.properties
    ]
    evidence = {} if cores is None else {"gauge": evidence_data(target, cores, [])}
    data = report_data([*asked, *replayed], [target], evidence)
    validate(data, schema())
    return data


def gauge(folder: Path, cores: Sequence[Core] | None = None, versions: Mapping[str, str] | None = None) -> str:
    """The page of that report; `versions` replace those of this computer."""
    data = data_of(folder, cores)
    return to_html({**data, "versions": {**data["versions"], **(versions or {})}})


def core(claim: str, *laws: str, why_none: str = "") -> Core:
    """The core of a claim that rests on these laws."""
    return Core(claim, tuple(Element("clause", "gauge", law) for law in laws), 1, why_none=why_none)


def needed_by(page: str, law: str) -> str:
    """What the list of conditions says of a law: who needs it."""
    found = re.search(rf"<b>{law}</b>.*?data-head=\"needed by\">(.*?)</td>", page, re.DOTALL)
    assert found is not None
    return html.unescape(re.sub("<[^>]*>", "", found[1]))


def test_the_words_of_a_project(tmp_path: Path) -> None:
    """Recordings are the project's; requirements of machines that ship are not counted; it is a report of state machines."""
    page = gauge(tmp_path)
    assert "they are files of the project" in page and "they ship with safeloc" not in page
    assert "safeloc list requirements" not in page
    assert "Verification of state machines" in page


def test_it_says_what_a_law_lacks(tmp_path: Path) -> None:
    """Each law has an owner here, and none a source."""
    assert "none without an owner, 2 without a source." in gauge(tmp_path)


def test_a_claim_without_words_has_its_formula(tmp_path: Path) -> None:
    """By its kind; the claim that is stated in words has none, and a short formula is not folded."""
    (machine,) = data_of(tmp_path)["machines"]
    assert {
        "right": ["always: last_mm = place_mm"],
        "answers": ["whenever: 10 mm < seen_mm", "within 3 steps: 10 mm < last_mm"],
        "gets there": ["in some run: last_mm = 100 mm"],
    } == {name: one["terms"] for name, one in machine["formulas"].items()}
    page = gauge(tmp_path)
    assert "<b>right</b><br><code>always: last_mm = place_mm</code>" in page


@pytest.mark.parametrize(("installed", "says"), [("not installed", False), ("2.6.5", True)])
def test_the_second_solver_is_the_one_that_was_there(tmp_path: Path, installed: str, says: bool) -> None:
    """A report made without yices does not say that yices was asked."""
    page = gauge(tmp_path, versions={"yices": installed})
    assert ("yices is asked first" in page) is says
    assert ("was not installed" in page) is not says


def test_a_law_that_no_claim_needs(tmp_path: Path) -> None:
    """With the cores of all claims it is needed by none; a claim without a core may need it; without cores every claim may."""
    known = [core("right", "the sensor is exact"), core("in range"), core("gets there", why_none="shown by a run")]
    page = gauge(tmp_path, known)
    assert "gauge: right" == needed_by(page, "the sensor is exact")
    assert "no claim (obligations, such as ranges, may need it)" == needed_by(page, "the line ends")
    page = gauge(tmp_path, [*known, core("answers", why_none="not proved by induction within the limits")])
    assert needed_by(page, "the line ends").endswith("and so may claims without a proof core: gauge: answers)")
    assert "gauge (every claim may need it)" == needed_by(gauge(tmp_path), "the line ends")
