"""Runs that show that something occurs: of the whole, of a machine by itself, of a case that a property speaks of."""

from __future__ import annotations

import json
import shutil
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from safeloc.catalogue import load_target
from safeloc.checker.folder import Checked, check_folder
from safeloc.proof.provers.obligations import obligations
from safeloc.runtime.scripts import read_script, script
from safeloc.runtime.streams.columns import FUNCTION
from tests.checker.raw_report import with_words
from tests.checker.small_proofs import LIMITS, kept, written

BY_ITSELF = "pair/obligation/transition leaper: leap"
CASE = "counting/obligation/case 1 of answered"


def report(folder: Path, name: str, config: Path | None = None) -> Path:
    """The folder of what a declaration owes."""
    target = load_target(f"tests.checker.declared:{name}", config)
    return written(folder, kept(target, obligations(target.system, LIMITS, properties=target.properties)))


@pytest.fixture(scope="module")
def reports(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Path]:
    """The report of each declaration, made once."""
    return {name: report(tmp_path_factory.mktemp(name), name) for name in ("pair", "counting")}


@pytest.fixture
def pair(reports: dict[str, Path], tmp_path: Path) -> Path:
    """Of two machines, one of which does something only by itself; it may be spoilt."""
    return Path(shutil.copytree(reports["pair"], tmp_path / "copy"))


@pytest.fixture
def counting(reports: dict[str, Path], tmp_path: Path) -> Path:
    """Of a machine whose properties speak of cases that a search finds; it may be spoilt."""
    return Path(shutil.copytree(reports["counting"], tmp_path / "copy"))


def rows(folder: Path) -> dict[str, Checked]:
    """Return the checker's answer about each result."""
    return {row.id: row for row in check_folder(folder, seconds=10).rows}


def edited(folder: Path, change: Any) -> None:
    """The report with each result changed; None leaves it out."""
    data = with_words(folder)
    data["results"] = [row for row in map(change, data["results"]) if row is not None]
    (folder / "report.json").write_text(json.dumps(data))


def spoilt(folder: Path, result: str, change: Callable[[dict[str, Any]], dict[str, Any]]) -> None:
    """A result has a run of its own, another one than before."""
    [path] = (folder / "traces").iterdir()
    data = json.loads(read_script(path, FUNCTION))
    [(number, run)] = [(number, one) for number, one in enumerate(data["runs"]) if result in one["results"]]
    run["results"].remove(result)
    data["runs"].append(change({**run, "results": [result], "like": [number, run["steps"]]}))
    path.write_text(script(FUNCTION, path.stem, data=json.dumps(data).encode()))


def left_at_the_start(run: dict[str, Any]) -> dict[str, Any]:
    """A run of no steps."""
    return {**run, "steps": 0, "like": [run["like"][0], 0]}


def test_a_machine_by_itself(pair: Path) -> None:
    """Its run is kept, is one of that machine, and shows the row."""
    assert {"confirmed"} == {row.answer for row in rows(pair).values()}
    [told] = [row for row in json.loads((pair / "report.json").read_text())["results"] if row["id"] == BY_ITSELF]
    assert told["statement"].endswith(", by itself")
    assert "leaper by itself" in told["notes"]["witness"]


def test_what_is_shown_by_itself_is_not_shown_of_the_whole(pair: Path) -> None:
    """The very run does not do for the whole."""
    edited(pair, lambda row: {**row, "statement": row["statement"].replace(", by itself", "")})
    assert "not confirmed" == rows(pair)[BY_ITSELF].answer


def test_a_broken_assumption_has_to_be_told(pair: Path) -> None:
    """The run keeps no assumption, which is not to be claimed."""
    edited(pair, lambda row: {**row, "method": row["method"].replace("a defence: ", "")})
    assert "its run does not show it" == rows(pair)[BY_ITSELF].why


def test_a_run_by_itself_that_was_cut(pair: Path) -> None:
    """Without its steps it shows nothing; without the file there is nothing."""
    spoilt(pair, BY_ITSELF, left_at_the_start)
    assert "its run does not show it" == rows(pair)[BY_ITSELF].why
    spoilt(pair, BY_ITSELF, lambda run: {**run, "results": []})
    assert "the report stores no run for it" == rows(pair)[BY_ITSELF].why


def test_cases_that_a_search_found(counting: Path) -> None:
    """Each has a run of its own, and all together are every case."""
    found = rows(counting)
    assert {"confirmed"} == {row.answer for row in found.values()}
    assert CASE in found


def test_a_case_without_a_run(counting: Path) -> None:
    """A case that occurs in no recording and no stored run is not confirmed."""
    edited(counting, lambda row: None if row["id"] == CASE else row)
    assert "not confirmed" == rows(counting)["counting/obligation/antecedents"].answer


def test_a_run_to_another_case(counting: Path) -> None:
    """A run that stays where it begins comes to no case."""
    spoilt(counting, CASE, left_at_the_start)
    assert "its run does not show it" == rows(counting)[CASE].why


def test_a_machine_made_from_a_configuration(tmp_path: Path) -> None:
    """The report says from which, the checker makes it again from that; from another one it is another machine."""
    config = tmp_path / "figures.toml"
    config.write_text("highest = 7\n")
    folder = report(tmp_path / "report", "made_of", config)
    assert {"confirmed"} == {row.answer for row in rows(folder).values()}
    data = json.loads((folder / "report.json").read_text())
    assert {"highest": 7} == data["machines"][0]["configuration"]
    data["machines"][0]["configuration"] = {"highest": 8}
    (folder / "report.json").write_text(json.dumps(data))
    assert all("another digest" in row.why for row in rows(folder).values())
