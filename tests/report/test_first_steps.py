"""Where the page tells a reader to begin: with the counterexamples, and with the run of a machine that can be driven."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from safeloc.report.first_steps import first_steps
from safeloc.report.folder import write_folder
from safeloc.report.links import Links
from tests.report import lamp


def machine(name: str, parts: int = 1, *, silent: bool = True, reported: bool = True) -> dict[str, Any]:
    """What the report has of a machine, as far as it is asked here."""
    inputs = [{"name": "a_mm", "kind": "input"}, *([{"name": "a_mm.present", "kind": "input"}] if silent else [])]
    return {
        "name": name, "parts": [{"variables": inputs}] * parts, "reported": {"position": "p"} if reported else None, "declared": [],
    }  # fmt: skip


def found(
    runs: dict[str, int], machines: list[dict[str, Any]], *, violated: bool = False, scripts: str = ""
) -> dict[str, Any]:
    """The first steps in a report with these runs; `scripts` has the names of machines that can be run."""
    results = [
        {"id": one, "machine": one.split("/")[0], "verdict": "violated" if violated else "proved", "certificates": []}
        for one in runs
    ]
    data = {"machines": machines, "results": results, "runs": runs, "scripts": scripts.split()}
    return first_steps(data, Links(data, {one["name"]: one["name"] for one in machines}))


def test_counterexamples_begin_with_the_shortest() -> None:
    """Five are named, of the others the number; each leads to its run."""
    runs = {f"a/property/p{length}": length for length in (244, 3, 7, 9, 8, 1)}
    steps = found(runs, [machine("a")], violated=True)
    assert [1, 3, 7, 8, 9] == [length for _, length, _ in steps["counterexamples"]]
    assert (1, "#result=a%2Fproperty%2Fp1") == (steps["more"], steps["counterexamples"][0][2])
    assert [] == found(runs, [machine("a")])["counterexamples"]


def test_the_machine_to_drive_can_be_driven() -> None:
    """It reports an interval, has a sensor that may be silent, and a script; one by itself comes first, then the longest run."""
    runs = {"a/property/p": 5, "b/property/p": 50, "b/property/q": 60, "c/property/p": 900}
    machines = [machine("a", silent=False), machine("b"), machine("c", parts=3)]
    assert {"machine": "b", "steps": 60, "at": "#result=b%2Fproperty%2Fq&drive="} == found(
        runs, machines, scripts="a b c"
    )["driven"]
    assert "c" == found(runs, machines, scripts="a c")["driven"]["machine"]
    assert found(runs, machines, scripts="a")["driven"] is None
    assert found(runs, [machine("b", reported=False)], scripts="b")["driven"] is None


def test_the_page_leads_there(tmp_path: Path) -> None:
    """To a counterexample by one click, and to what is violated and undecided."""
    page = write_folder(tmp_path, lamp.findings(), [lamp.target()]).read_text(encoding="utf-8")
    paths = page.partition('<nav class="paths"')[2].partition("</nav>")[0]
    assert (
        'href="run.html#result=lamp%2Fproperty%2Fwears+%26+tears">lamp/property/wears &amp; tears</a> (3 steps)'
        in paths
    )
    assert all(
        f'href="#{one}"' in paths and f'id="{one}"' in page
        for one in ("violated", "undecided", "conditions", "recheck")
    )
    assert "Drive a machine" not in paths
