"""`safeloc cores` and `safeloc faults`: what proofs rest on, and every clause broken, as a user asks for it."""

from __future__ import annotations

import json
from pathlib import Path
from xml.etree import ElementTree

import pytest

from tests.cli.conftest import Call

KEPT = "cache"


@pytest.fixture(autouse=True)
def _there(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)


def test_cores_as_lines_and_as_data(call: Call) -> None:
    """A line for each claim, then what no claim needs; the second time it is kept."""
    told = call("cores", "transmission", "--cache", KEPT)
    assert 0 == told.code
    assert "containment: 1-induction\n    clauses: a position that is sent holds the truth" in told.out
    assert "clauses that no proof needs: " in told.out
    data = json.loads(call("cores", "transmission", "--cache", KEPT, "--json").out)
    assert ("safeloc-cores/1", "transmission") == (data["schema"], data["target"])
    [one] = [core for core in data["cores"] if core["claim"] == "containment"]
    assert "a position that is sent holds the truth" in {element["name"] for element in one["rests_on"]}


def test_cores_of_one_property(call: Call) -> None:
    """What no claim needs is not told then: not all were asked."""
    told = call("cores", "transmission", "--property", "containment", "--cache", KEPT)
    assert told.out.startswith("containment")
    assert "no proof needs" not in told.out
    assert "1 claims; of 0 no smallest set was found" in told.out
    wrong = call("cores", "transmission", "--property", "contain")
    assert 2 == wrong.code
    assert "has no property 'contain'" in " ".join(wrong.err.replace("│", " ").split())


def test_faults_as_lines_data_model_and_picture(call: Call) -> None:
    """Rows of a table, the cut sets, and both files."""
    told = call("faults", "delocalized", "--order", "2", "--open-psa", "it.xml", "--picture", "it.svg", "--cache", KEPT)
    assert 0 == told.code
    assert "delocalized/A1  " in told.out
    assert "    claims lost   containment (after 1 cycle)" in told.out
    assert (
        "can miss the truth for more than 10 cycles; shortest run: 1 cycle, ends with 'reference accepted'" in told.out
    )
    assert "minimal cut sets of 'a reported interval misses the truth': delocalized/A1" in told.out
    assert "delocalized_A1" in Path("it.xml").read_text(encoding="utf-8")
    assert ElementTree.fromstring(Path("it.svg").read_text(encoding="utf-8")).tag.endswith("svg")
    data = json.loads(call("faults", "delocalized", "--cache", KEPT, "--json").out)
    assert ("safeloc-faults/1", [["delocalized/A1"]]) == (data["schema"], data["cut_sets"]["minimal"])
    assert "wrong" == data["effects"][0]["end"]


def test_faults_of_a_machine_without_an_interval(call: Call) -> None:
    """Claims are told; order 2 asks of an interval."""
    told = call("faults", "turn_off", "--cache", KEPT)
    assert 0 == told.code
    assert "    end effect    none on an interval: the target reports none" in told.out
    assert "minimal cut sets" not in told.out
    wrong = call("faults", "turn_off", "--order", "2")
    assert 2 == wrong.code
    assert "turn_off reports no interval" in " ".join(wrong.err.replace("│", " ").split())


def test_what_is_not_decided_is_the_exit_code(call: Call) -> None:
    """With hardly any effort nothing is claimed."""
    told = call("faults", "transmission", "--seconds", "0.1", "--cache", KEPT)
    assert told.code in (0, 3)
    assert (3 == told.code) is ("not decided" in told.out)
