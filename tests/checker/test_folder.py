"""`safeloc recheck`: a report folder from its files, and what is told of one that is not what it was."""

from __future__ import annotations

import json
import shutil
from pathlib import Path

import pytest

from safeloc.checker.folder import check_folder
from safeloc.errors import InputError
from tests.checker.evidence import Evidence, refused, written
from tests.cli.calling import Call


@pytest.fixture(scope="module")
def report(proofs: dict[str, Evidence], tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The folder of one declaration."""
    return written(tmp_path_factory.mktemp("report"), proofs["counting"])


@pytest.fixture
def copy(report: Path, tmp_path: Path) -> Path:
    """A folder that may be spoilt."""
    return Path(shutil.copytree(report, tmp_path / "copy"))


def test_a_report_is_confirmed(report: Path) -> None:
    """Every proof of the folder, the witnesses of what is reachable among them."""
    told: list[tuple[int, int]] = []
    found = check_folder(report, jobs=2, seconds=10, told=lambda *count: told.append(count))
    assert ([], {}, 0) == (refused(found), found.wrong, found.exit_code)
    assert told[-1] == (len(found.opinions), len(list((report / "certificates").iterdir())))
    assert 20 <= len(found.rows)


def test_a_file_that_was_edited(copy: Path) -> None:
    """A file whose text is not that of its name is wrong, whatever it says."""
    path = next((copy / "certificates").glob("*overlap*"))
    path.write_text(path.read_text() + "; a remark\n")
    found = check_folder(copy, seconds=10)
    assert ([path.name], 1) == (list(found.wrong), found.exit_code)


def test_files_swapped(copy: Path) -> None:
    """Two files that have changed names are both wrong."""
    one, other, *_ = sorted((copy / "certificates").iterdir())
    texts = one.read_text(), other.read_text()
    one.write_text(texts[1])
    other.write_text(texts[0])
    assert {one.name, other.name} <= set(check_folder(copy, seconds=10).wrong)


def test_a_file_that_is_missing(copy: Path) -> None:
    """What rests on it is not confirmed, and what relies on it is wrong."""
    next((copy / "certificates").glob("*always-step*")).unlink()
    found = check_folder(copy, seconds=10)
    assert 1 == found.exit_code
    assert any("never above eight" in one for one in refused(found))


def test_a_run_that_does_not_show_it(copy: Path) -> None:
    """A witness that was cut is none; nor is one that is gone."""
    path = next((copy / "traces").glob("*it-comes-to-eight*"))
    path.write_text("\n".join(path.read_text().splitlines()[:-1]) + "\n")
    assert ["its run does not show it"] == [
        row.why for row in check_folder(copy, seconds=10).rows if row.answer == "not confirmed"
    ]
    path.unlink()
    assert ["no run is kept that shows it"] == [
        row.why for row in check_folder(copy, seconds=10).rows if row.answer == "not confirmed"
    ]


def test_another_declaration(copy: Path) -> None:
    """Where the declaration is not the one of the report nothing is confirmed, and that is told with code 3."""
    data = json.loads((copy / "report.json").read_text())
    data["machines"][0]["declaration"] = "0" * 64
    (copy / "report.json").write_text(json.dumps(data))
    found = check_folder(copy, seconds=10)
    assert {"cannot be checked"} == {row.answer for row in found.rows}
    assert "another digest" in found.rows[0].why
    assert 3 == found.exit_code


def test_a_declaration_that_cannot_be_loaded(copy: Path) -> None:
    """A user's file that is gone is told as such."""
    data = json.loads((copy / "report.json").read_text())
    data["machines"][0]["spec"] = "gone/away.py:machine"
    (copy / "report.json").write_text(json.dumps(data))
    found = check_folder(copy, seconds=10)
    assert {("cannot be checked", "its declaration cannot be loaded: gone/away.py: no such Python file.")} == {
        (row.answer, row.why) for row in found.rows
    }


def test_a_result_that_claims_more(copy: Path) -> None:
    """Ranges of more variables than there are proofs of, a property that nobody declared, a lemma for all inputs."""
    data = json.loads((copy / "report.json").read_text())
    for row in data["results"]:
        row["statement"] = row["statement"].replace("5 of 5", "6 of 6")
        row["id"] = row["id"].replace("never above eight", "never above one")
        row["method"] = row["method"].replace("under the assumption", "for all inputs in range")
    (copy / "report.json").write_text(json.dumps(data))
    told = " ".join(refused(check_folder(copy, seconds=10)))
    assert all(part in told for part in ("obligation/ranges", "never above one", "never far"))


@pytest.mark.parametrize("text", ["", "[]", '{"schema": "safeloc-report/1"}', "{" * 10_000])
def test_no_report(tmp_path: Path, text: str) -> None:
    """A folder that holds no report of this version is refused."""
    (tmp_path / "report.json").write_text(text)
    with pytest.raises(InputError, match="report"):
        check_folder(tmp_path)


def test_the_command(copy: Path, call: Call) -> None:
    """The command says how many are confirmed and what solvers said; its code is that of the worst."""
    done = call("recheck", str(copy), "--seconds", "10")
    assert 0 == done.code
    assert "confirmed" in done.out
    assert "cvc5: " in done.out
    next((copy / "certificates").glob("*overlap*")).unlink()
    done = call("recheck", str(copy), "--seconds", "10", "--json")
    assert (1, 1) == (done.code, json.loads(done.out)["exit_code"])
    assert 2 == call("recheck", str(copy / "traces")).code
