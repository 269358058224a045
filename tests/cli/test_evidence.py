"""`safeloc cores` and `safeloc faults`: what proofs rest on, and every clause broken, as a user asks for it."""

from __future__ import annotations

import json
from pathlib import Path
from xml.etree import ElementTree

import pytest

from safeloc.assurance.evidence import fault_work
from safeloc.assurance.evidence.effects import Effect
from safeloc.catalogue import Target
from safeloc.proof.cores.clauses import ClauseId
from tests.cli.calling import DOOR, DOOR_FILE, Call

KEPT = "cache"


@pytest.fixture(autouse=True)
def _there(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)


def test_cores_as_lines_and_as_data(call: Call) -> None:
    """A line for each claim, then what no claim needs; the second time it is kept."""
    told = call("cores", "transmission", "--cache", KEPT)
    assert 0 == told.code
    assert "containment: 1-induction\n    clauses: a position that is sent holds the truth" in told.out
    assert "clauses that no claim needs (obligations, such as ranges, may need them): " in told.out
    data = json.loads(call("cores", "transmission", "--cache", KEPT, "--json").out)
    assert ("safeloc-cores/1", "transmission") == (data["schema"], data["target"])
    [one] = [core for core in data["cores"] if core["claim"] == "containment"]
    assert "a position that is sent holds the truth" in {element["name"] for element in one["rests_on"]}


def test_cores_of_one_property(call: Call) -> None:
    """What no claim needs is not told then: not all were asked."""
    told = call("cores", "transmission", "--property", "containment", "--cache", KEPT)
    assert told.out.startswith("containment")
    assert "no claim needs" not in told.out
    assert told.out.endswith("\n1 claim\n")
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


def test_faults_of_named_clauses_alone(call: Call) -> None:
    """By id or by name; the cut sets say of which clauses they speak."""
    by_id = call("faults", "delocalized", "--clause", "delocalized/A1", "--cache", KEPT)
    by_name = call("faults", "delocalized", "--clause", "a valid position holds the truth", "--cache", KEPT)
    assert (0, 0) == (by_id.code, by_name.code)
    assert by_id.out.count("    owner  ") == 1
    assert by_name.out.count("    owner  ") == 1
    assert "among these clauses: delocalized/A1\n" in by_id.out


@pytest.mark.parametrize(
    ("name", "asked", "message"),
    [
        ("delocalized", "delocalized/A77", "'delocalized/A77' is no clause of delocalized; its clauses are delocalized/A1."),
        ("localizer", "localizer/balise/A1", "'localizer/balise/A1' is guaranteed by another machine, and not assumed of localizer"),
    ],
)  # fmt: skip
def test_a_clause_that_is_not_assumed_is_refused(call: Call, name: str, asked: str, message: str) -> None:
    """With those that are."""
    wrong = call("faults", name, "--clause", asked)
    assert 2 == wrong.code
    assert message in " ".join(wrong.err.replace("│", " ").split())


@pytest.mark.thorough
def test_faults_of_a_machine_without_an_interval(call: Call) -> None:
    """The end effect is its hazard, and so is the top event of the cut sets."""
    told = call("faults", "turn_off", "--order", "2", "--cache", KEPT)
    assert 0 == told.code
    assert (
        "    end effect    a false course through a switch is reported; shortest run: 3 cycles, ends with" in told.out
    )
    assert "minimal cut sets of 'a false course through a switch is reported': turn_off/A1, " in told.out


def test_order_two_asks_of_an_interval_or_a_hazard(call: Call) -> None:
    """A machine of one's own that declares neither is told so."""
    wrong = call("faults", DOOR, "--order", "2")
    assert 2 == wrong.code
    assert "reports no interval and declares no hazard" in " ".join(wrong.err.replace("│", " ").split())


def test_a_machine_of_ones_own_declares_its_hazard(call: Call, tmp_path: Path) -> None:
    """With the name of a property beside it; anything else of that name is refused, with what is expected."""
    text = DOOR_FILE.read_text(encoding="utf-8")
    declared = 'from safeloc.target import Hazard\n\nhazard = Hazard("the door opens in front of nobody", ("*",))\n'
    (tmp_path / "own.py").write_text(text + declared, encoding="utf-8")
    told = call("faults", "own.py:machine", "--cache", KEPT)
    assert "of 'the door opens in front of nobody'" in told.out
    (tmp_path / "other.py").write_text(f'{text}hazard = "it opens"\n', encoding="utf-8")
    refused = call("faults", "other.py:machine")
    assert 2 == refused.code
    assert "other.hazard is 'it opens'" in refused.err and 'expected Hazard("what must not happen"' in refused.err


def test_what_is_not_decided_is_the_exit_code(call: Call, monkeypatch: pytest.MonkeyPatch) -> None:
    """A clause whose breach was not decided is told, and the run does not end as if all were known."""

    def undecided(_target: Target, broken: tuple[ClauseId, ...], _names: object, _limits: object) -> Effect:
        return Effect(broken, (), {}, ("containment",), "undecided")

    monkeypatch.setattr(fault_work, "effect", undecided)
    told = call("faults", "transmission", "--jobs", "1", "--fresh", "--cache", KEPT)
    assert 3 == told.code
    assert "    claims lost   none; not decided: containment" in told.out
    assert "    end effect    undecided within the limits" in told.out
    assert "not decided: transmission/A1" in told.out


@pytest.mark.thorough
def test_the_report_has_both_where_it_is_asked(call: Call) -> None:
    """Of a user's machine: what its claims rest on, in the page; without the option the page says how to ask."""
    asked = ["verify", DOOR, "--examples", "2", "--steps", "5", "--jobs", "1", "--cache", KEPT]
    assert 0 == call(*asked, "--out", "plain").code
    page = Path("plain/index.html").read_text(encoding="utf-8")
    assert "--evidence</code>" in page
    assert 0 == call(*asked, "--out", "both", "--evidence").code
    page = Path("both/index.html").read_text(encoding="utf-8")
    assert "Proof cores of door" in page
    assert "Effects of each broken clause of the world, alone" in page
