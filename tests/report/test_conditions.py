"""What the proofs hand over to others: one list of laws with figures and owners, and which claim needs which law."""

from __future__ import annotations

import re
from dataclasses import asdict
from typing import Any

import pytest

from safeloc.assurance.register import register_of
from safeloc.report.conditions import conditions, counts, figures, needs
from safeloc.report.data import report_data
from safeloc.report.page import to_html
from tests.shipped import laws_of, shipped


def machines(*names: str) -> list[dict[str, Any]]:
    """The machines of a report without findings."""
    found: list[dict[str, Any]] = report_data([], [shipped(name) for name in names])["machines"]
    return found


def test_every_law_is_there_once() -> None:
    """Those of the register that no machine guarantees, also if several targets have the same machine."""
    names = ("odometry", "supervised_odometry", "localizer")
    found = conditions(machines(*names))
    laws = {(one.id, one.name) for name in names for one in laws_of(name) if not one.guaranteed}
    assert {(law["id"], law["name"]) for law in found["laws"]} == laws
    first = found["laws"][0]
    assert first["id"] == "odometry/A1"
    assert {"odometry", "supervised_odometry"} <= set(first["targets"])
    assert len([law for law in found["laws"] if law["id"] == "odometry/A5" and "odometry" in law["targets"]]) == 1


@pytest.mark.thorough
def test_page_and_command_count_alike() -> None:
    """Laws left to others and figures to confirm, of machines that share both; the command has the law of records besides."""
    names = ("odometry", "supervised_odometry", "balise", "marker_device", "reflector_device")
    found, listed = conditions(machines(*names)), register_of(list(map(shipped, names)))
    assert listed.left_to_others == len(found["laws"]) + 1
    assert [asdict(one) for one in listed.to_confirm] == found["figures"]
    assert {law["id"] for law in found["laws"]} | {"border/B1"} == {
        row.one.id for row in listed.rows if row.is_left_to_others
    }


def test_a_figure_to_confirm_stands_once() -> None:
    """With every place that has it; figures of one name that differ in value or source are told apart, and say so."""
    same = {"name": "guard.brake", "value": "7", "unit": "mm/s2", "source": "[M] service brake"}
    other = {**same, "name": "brake", "value": "9"}
    known = [{"name": n, "parts": [], "evidence": None, "figures": f} for n, f in {
        "a": [same, {**same, "name": "read", "source": "[S] read"}], "b": [{**same, "name": "brake"}], "c": [other],
    }.items()]  # fmt: skip
    first, second = conditions(known)["figures"]
    assert ("brake", "7", 2, ("a: guard.brake", "b: brake")) == (
        first["name"], first["value"], first["values"], first["places"]
    )  # fmt: skip
    assert ("brake", "9", 2, ("c: brake",)) == (second["name"], second["value"], second["values"], second["places"])


def test_figures_have_their_values() -> None:
    """Those of the part's own section; of several, each with its place; a name that the configuration has not stands alone."""
    made = {"figures": [
        {"name": "a.rate", "value": "1", "unit": "ppm", "source": "[M]"}, {"name": "b.rate", "value": "2", "unit": "", "source": ""},
        {"name": "c.rate", "value": "2", "unit": "", "source": ""},
    ]}  # fmt: skip
    law = {"figures": ["rate", "gone"]}
    assert ["rate = 1 ppm [M] (a) or 2 (b, c)", "gone"] == figures(law, made, {"name": "m"})
    assert ["rate = 2", "gone"] == figures(law, made, {"name": "b"})
    assert ["rate = 1 ppm [M]", "gone"] == figures(law, made, {"name": "m", "section": "a"})


@pytest.mark.thorough(ordinary=1)
@pytest.mark.parametrize("name", ["localizer", "localizer_sections", "fibre_area"])
def test_no_figure_of_a_source_is_ambiguous(name: str) -> None:
    """Which part of the configuration a machine's figures are of is known; two units of one device alone have figures of one name."""
    [machine] = report_data([], [shipped(name)])["machines"]
    several = {
        words
        for part in machine["parts"]
        for law in part["clauses"]
        for words in figures(law, machine, part)
        if " or " in words
    }
    places = re.findall(r"\(([^)]*)\)", " ".join(several))
    assert all(
        {place.split(".")[-1] for place in one.split(", ")} <= {"odometer", "check", "first_unit", "second_unit"}
        for one in places
    )


@pytest.mark.thorough
def test_a_law_of_a_unit_names_the_figures_of_that_unit() -> None:
    """Of two units with other figures, the law of each has its own: no supplier vouches for the figures of the other's unit."""
    said = {law["name"]: law["figures"] for law in conditions(machines("odometry", "localizer"))["laws"]}
    for name, place in (
        ("front_wheel obeys its error law", "first_unit"),
        ("rear_radar obeys its error law", "second_unit"),
        ("the odometer, if it is the lawful unit, obeys its error law", "odometer"),
        ("the check unit, if it is the lawful unit, obeys its error law", "check"),
    ):
        of_a_unit = [words for words in said[name] if not words.startswith("max_")]
        assert len(of_a_unit) >= 4
        assert all(words.startswith(f"{place}.") and " or " not in words for words in of_a_unit)


def core(claim: str, *elements: tuple[str, str], why_none: str = "") -> dict[str, Any]:
    """The core of a claim as the report has it."""
    rests_on = [{"kind": kind, "machine": "odometry", "name": name} for kind, name in elements]
    return {
        "claim": claim, "rests_on": rests_on, "steps": 1, "kept_by": "", "undecided": [], "why_none": why_none, "rows_of": 18
    }  # fmt: skip


def with_cores() -> dict[str, Any]:
    """The odometry machine with two cores, and a claim without one."""
    (machine,) = machines("odometry")
    law = machine["parts"][0]["clauses"][0]["name"]
    cores = [
        core("containment", ("clause", law), ("row", "tolerance exceeded")),
        core("tolerance"),
        core("age limit", why_none="not proved"),
    ]
    faults = {"schema": "safeloc-faults/1", "target": "odometry", "effects": [], "cut_sets": {}}
    return {**machine, "evidence": {"cores": cores, "needed_by_none": [], "faults": faults, "picture": ""}}


def test_claims_name_the_laws_that_they_need() -> None:
    """By the number of the register; a claim without a core says nothing, which is not `none`."""
    assert needs(with_cores()) == {"containment": ["odometry/A1"], "tolerance": []}
    assert conditions([with_cores()])["laws"][0]["needed_by"] == ["odometry: containment"]
    assert conditions([with_cores()])["laws"][1]["needed_by"] == []
    assert needs(machines("odometry")[0]) == {}


def test_the_page_has_the_list_and_the_needs() -> None:
    """Each law with its number, and a row of a property leads to the laws that it needs."""
    data = report_data([], [shipped("odometry")])
    page = to_html(data)
    assert '<h2 id="conditions" class="own-page">Conditions for the safety case</h2>' in page
    assert '<tr id="condition-odometry-A1" data-owner="' in page
    assert '<td class="id"><a href="#law-odometry-odometry-A1">odometry/A1</a>' in page
    assert '<a class="id" href="#condition-odometry-A1">odometry/A1</a>' in page  # and back
    assert "models/odometry/world.py:" in page
    assert "safeloc verify --evidence" in page
    assert 'id="law-odometry-odometry-A1"' in page


def law(name: str, *terms: str, owner: str = "operator", source: str = "", **more: Any) -> dict[str, Any]:
    """A law as a report has it."""
    said = {"id": f"m/{name}", "name": name, "statement": "", "owner": owner, "source": source, "figures": []}
    said |= {"observable": "as a whole"}
    return {**said, "terms": list(terms), "parts": [], "guaranteed": False, **more}


def machine(name: str, *laws: dict[str, Any]) -> dict[str, Any]:
    """A machine of a report with these laws and two figures."""
    known = [
        {"name": "a", "value": "1", "unit": "mm", "source": "[M] remembered"},
        {"name": "b", "value": "2", "unit": "", "source": "[S] read"},
    ]
    return {"name": name, "parts": [{"name": "m", "clauses": list(laws)}], "figures": known, "evidence": None}


def test_laws_of_one_name_with_other_parts_are_two() -> None:
    """A letter in the term stands for something else: that is another condition, and it is counted in headline and list."""
    parts = [{"name": "A", "text": "x < 1"}], [{"name": "A", "text": "x < 2"}]
    found = conditions([machine("one", law("A1", "A", parts=parts[0])), machine("two", law("A1", "A", parts=parts[1]))])
    assert 2 == len(found["laws"]) == counts(found)["assumptions"]
    same = conditions([machine("one", law("A1", "A")), machine("two", law("A1", "A"))])
    assert [["one", "two"]] == [one["targets"] for one in same["laws"]]


def test_the_headline_and_the_list_have_one_number() -> None:
    """Of machines that share a machine under other figures; also in the data."""
    names = ("balise", "supervised_odometry", "odometry")
    data = report_data([], list(map(shipped, names)))
    page = to_html(data)
    number = data["conditions"]["assumptions"]
    assert f"It rests on {number} assumptions;" in page
    assert number == len(re.findall('<tr id="condition-[^>]* data-owner=', page))
    assert page.count('<span class="memory">[M]</span>') == page.count("data-confirm>") > 0
    assert f'<td><b>all</b></td><td class="n"><b>{number}</b></td>' in page
    unsure, remembered = page.count("data-confirm>"), data["conditions"]["figures_to_confirm"]
    assert f"{unsure} conditions have to be confirmed, {remembered} figures are from memory:" in page


def test_each_owner_has_a_sum_and_what_is_to_be_confirmed() -> None:
    """[M] stands at the figure that is from memory, and marks the law that names it; the sums add up."""
    laws = (
        law("A1", "x", figures=["a", "b"]),
        law("A2", "y", figures=["b"]),
        law("A3", "z", owner="", source="[M] guess"),
    )
    found = conditions([machine("one", *laws)])
    assert [["a = 1 mm [M]", "b = 2"], ["b = 2"], []] == [one["figures"] for one in found["laws"]]
    assert [True, False, True] == [one["confirm"] for one in found["laws"]]
    assert [("operator", 2, 1), ("none", 1, 1)] == [(o["owner"], o["laws"], o["confirm"]) for o in found["owners"]]
    assert {
        "assumptions": 3, "true_by_definition": 0, "without_owner_or_source": 3, "without_owner": 1, "without_source": 2,
        "figures_to_confirm": 1
    } == counts(found)  # fmt: skip


def test_what_is_true_by_definition_needs_no_owner() -> None:
    """Headline and sums by owner speak of the same laws."""
    found = conditions([machine("one", law("A1", "x"), law("A2", "y", owner="nobody", source="[D] arithmetic"))])
    assert 1 == counts(found)["true_by_definition"]
    assert {"operator": 1, "nobody": 1} == {one["owner"]: one["laws"] for one in found["owners"]}
    page = to_html(report_data([], [shipped("turn_off")]))
    assert "that somebody has to ensure, and" in page and "(owner: nobody); none without an owner or a source" in page


def test_what_shows_in_operation_is_told_for_each_machine() -> None:
    """A law may show against another one in a composition and not by itself."""
    shows = machine("two", law("A1", "x", observable="against m: b"))
    (found,) = conditions([machine("one", law("A1", "x")), shows, machine("three", law("A1", "x"))])["laws"]
    assert {"as a whole": ["one", "three"], "against m: b": ["two"]} == found["seen"]
