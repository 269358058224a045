"""What changed between two reports: each kind of change is told once, and times are no change."""

from __future__ import annotations

import copy
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from safeloc.report.changes import changes
from safeloc.report.data import report_data
from safeloc.report.folder import write_folder
from tests.cli.calling import caller
from tests.report.lamp import findings, target

Data = dict[str, Any]


@pytest.fixture(scope="module")
def lamp() -> Data:
    """The report of the lamp."""
    data: Data = report_data(findings(), [target()])
    return data


def row(data: Data, name: str) -> Data:
    """One result."""
    found: Data = next(one for one in data["results"] if one["id"] == name)
    return found


def test_other_times_are_no_change(lamp: Data) -> None:
    """Nor is the date."""
    later = copy.deepcopy(lamp)
    later["made"] = "2030-01-01T00:00:00Z"
    for one in later["results"]:
        one["seconds"] += 3
    found = changes(lamp, later)
    assert (list(found.lines), found.worse) == (["nothing changed but the times"], False)


def worse(data: Data) -> None:
    """A property is no longer proved."""
    row(data, "lamp/property/new")["verdict"] = "unknown"


def better(data: Data) -> None:
    """An undecided one is proved."""
    row(data, "lamp/property/later")["verdict"] = "proved"


def unasked(data: Data) -> None:
    """A quick run leaves a property out; that is no progress, also where it was violated."""
    row(data, "lamp/property/wears & tears")["verdict"] = "not asked"


def other_lines(data: Data) -> None:
    """A property is declared otherwise, under its name and without other words."""
    [one] = [one for one in data["machines"][0]["declared"] if one["of"][0][-1] == "new"]
    one["text"] += " # wider"


def gone(data: Data) -> None:
    """A property is gone."""
    data["results"].remove(row(data, "lamp/property/new"))


def added(verdict: str) -> Callable[[Data], None]:
    """A property is new."""

    def change(data: Data) -> None:
        data["results"].append({**row(data, "lamp/property/new"), "id": "lamp/property/added", "verdict": verdict})

    return change


def restated(data: Data) -> None:
    """A property says something else under its name."""
    row(data, "lamp/property/new")["statement"] = "light never wears"


def another_law(data: Data) -> None:
    """A law has other terms, and one is new."""
    [part] = data["machines"][0]["parts"]
    part["clauses"][0]["terms"] = ["wear < 7"]
    part["clauses"].append({**part["clauses"][0], "name": "second"})


def another_machine(data: Data) -> None:
    """A machine of another declaration, and one that is new, with its results."""
    [machine] = data["machines"]
    machine["declaration"] = "other"
    data["machines"].append({**machine, "name": "torch", "parts": [], "figures": []})
    data["results"].append({**row(data, "lamp/property/new"), "id": "torch/property/x", "machine": "torch"})


def another_version(data: Data) -> None:
    """Another solver, and other limits."""
    data["versions"]["z3-solver"] = "9.9"
    data["made_by"] = {"limits": {"seconds": 7}}


@pytest.mark.parametrize(
    ("change", "lines", "is_worse"),
    [
        (worse, ["worse", "  proved -> unknown  lamp/property/new"], True),
        (better, ["better", "  unknown -> proved  lamp/property/later"], False),
        (gone, ["gone", "  proved  lamp/property/new"], True),
        (added("proved"), ["new", "  proved  lamp/property/added"], False),
        (added("vacuous"), ["new, and neither proved nor held", "  vacuous  lamp/property/added"], True),
        (unasked, ["not asked any more", "  violated -> not asked  lamp/property/wears & tears"], True),
        (other_lines, ["other source lines", "  lamp/property/new"], False),
        (restated, ["other statement", "  lamp/property/new"], False),
        (another_law, ["laws", "  other terms: lamp: lamp: assumption", "  new: lamp: lamp: second"], False),
        (
            another_machine,
            ["new", "  all of torch: 1 proved", "machines", "  new: torch", "  other declaration: lamp"],
            False,
        ),
    ],
)
def test_each_change_is_told(lamp: Data, change: Callable[[Data], None], lines: list[str], *, is_worse: bool) -> None:
    """Alone, and under its heading."""
    new = copy.deepcopy(lamp)
    change(new)
    found = changes(lamp, new)
    assert (list(found.lines), found.worse) == (lines, is_worse)


def test_what_it_was_made_with(lamp: Data) -> None:
    """Versions and limits."""
    new = copy.deepcopy(lamp)
    another_version(new)
    told = list(changes(lamp, new).lines)
    assert told[0] == "made with"
    assert any(line.startswith("  z3-solver: ") and line.endswith(" -> 9.9") for line in told)
    assert "  new: limit of seconds = 7" in told


def test_the_command(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    """Of two folders; it writes nothing, and refuses what would."""
    call = caller(monkeypatch, capsys)
    for name, found in (("old", findings()), ("new", findings()[1:])):
        write_folder(tmp_path / name, found, [target()])
    old, new = str(tmp_path / "old"), str(tmp_path / "new")
    same = call("report", "--diff", old, old)
    assert (same.code, same.out) == (0, "nothing changed but the times\n")
    less = call("report", "--diff", old, new)
    assert less.code == 1
    assert "gone\n" in less.out
    more = call("report", "--diff", new, old)
    assert (more.code, "gone" in more.out.splitlines(), "new" in more.out.splitlines()) == (0, False, True)
    assert call("report", "--diff", old, new, "--single-file").code == 2
    assert call("report", "--diff", str(tmp_path), new).code == 2
    assert call("report", "--since", old, new, "--diff", old).code == 2
    assert call("report", "--since", old, new, "--extract", str(tmp_path / "out")).code == 2


def test_the_page_says_what_changed(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """Below the headline, open where something got worse; rendered again without it, it is gone."""
    call = caller(monkeypatch, capsys)
    for name, found in (("old", findings()), ("new", findings()[1:])):
        write_folder(tmp_path / name, found, [target()])
    old, new = tmp_path / "old", tmp_path / "new"

    def page(*arguments: str) -> str:
        assert call("report", *arguments).code == 0
        return (Path(arguments[0]) / "index.html").read_text(encoding="utf-8")

    less = page(str(new), "--since", str(old))
    assert (
        '<details id="changed" open>' in less
        and findings()[0].id in less.split('id="changed"')[1].split("</details>")[0]
    )
    assert '<details id="changed">' in page(str(old), "--since", str(new))
    assert "nothing but the times" in page(str(old), "--since", str(old))
    assert 'id="changed"' not in page(str(new))
    assert call("report", str(new), "--since", str(tmp_path)).code == 2
