"""What the proofs hand over to others: one list of laws with figures and owners, and which claim needs which law."""

from __future__ import annotations

from typing import Any

from safeloc.assurance.register import register, to_confirm
from safeloc.catalogue import load_target
from safeloc.report.conditions import conditions, figures, needs
from safeloc.report.data import report_data
from safeloc.report.page import to_html


def machines(*names: str) -> list[dict[str, Any]]:
    """The machines of a report without findings."""
    found: list[dict[str, Any]] = report_data([], [load_target(name) for name in names])["machines"]
    return found


def test_every_law_is_there_once() -> None:
    """Those of the register that no machine guarantees, also if several targets have the same machine."""
    names = ("odometry", "supervised_odometry", "localizer")
    found = conditions(machines(*names))
    laws = {(one.id, one.name) for name in names for one in register(load_target(name)) if not one.guaranteed}
    assert {(law["id"], law["name"]) for law in found["laws"]} == laws
    first = found["laws"][0]
    assert first["id"] == "odometry/A1"
    assert {"odometry", "supervised_odometry"} <= set(first["targets"])
    assert len([law for law in found["laws"] if law["id"] == "odometry/A5" and "odometry" in law["targets"]]) == 1


def test_figures_that_somebody_has_to_confirm_are_there() -> None:
    """By name and value, as the register counts them."""
    found = conditions(machines("odometry", "balise"))["figures"]
    expected = {(one.name, one.value) for one in to_confirm(map(load_target, ("odometry", "balise"))).values()}
    assert {(one["name"], one["value"]) for one in found} == expected
    assert found


def test_figures_have_their_values() -> None:
    """All of them where two parts of a configuration differ; a name that the configuration has not stands alone."""
    made = {"figures": [{"name": "a.rate", "value": "1", "unit": "ppm"}, {"name": "b.rate", "value": "2", "unit": ""}]}
    assert figures({"figures": ["rate", "gone"]}, made) == ["rate = 1 ppm or 2", "gone"]


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
    data = report_data([], [load_target("odometry")])
    page = to_html(data)
    assert '<h2 id="conditions" class="own-page">Conditions for the safety case</h2>' in page
    assert '<td class="id">odometry/A1</td>' in page
    assert "safeloc verify --evidence" in page
    assert 'id="law-odometry-odometry-A1"' in page
