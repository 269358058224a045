"""`safeloc recheck`: a report folder from its files, and what is told of one that is not what it was."""

from __future__ import annotations

import json
import shutil
from collections.abc import Callable
from pathlib import Path

import pytest

from safeloc.checker.folder import check_folder
from safeloc.errors import InputError
from safeloc.report.certificates import Archives, packed_texts, read_archives
from safeloc.runtime.scripts import read_script, script
from safeloc.runtime.streams.columns import FUNCTION
from tests.checker.raw_report import with_words
from tests.checker.small_proofs import Evidence, refused, written
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
    found = check_folder(report, jobs=2, seconds=10, progress=lambda *count: told.append(count))
    assert ([], {}, 0) == (refused(found), found.wrong, found.exit_code)
    assert told[-1] == (len(found.opinions), sum(map(len, archives(report).values())))
    assert 20 <= len(found.rows)


def archives(folder: Path) -> Archives:
    """Return the texts in the files of certificates: file -> name -> text."""
    expected = json.loads((folder / "report.json").read_text())["certificates"]
    texts = read_archives(folder / "certificates", expected).texts
    return {file: {name: texts[name] for name in names} for file, names in expected.items()}


def place(found: Archives, part: str) -> tuple[str, str]:
    """File and name of a certificate whose name has this part."""
    return next((file, name) for file, texts in found.items() for name in texts if part in name)


def test_a_text_that_was_edited(copy: Path) -> None:
    """A text that is not that of its name is wrong, whatever it says."""
    kept = archives(copy)
    file, name = place(kept, "overlap")
    (copy / "certificates" / file).write_bytes(packed_texts({**kept[file], name: kept[file][name] + "; a remark\n"}))
    found = check_folder(copy, seconds=10)
    assert ([name], 1) == (list(found.wrong), found.exit_code)


def test_texts_swapped(copy: Path) -> None:
    """Two texts that have changed names are both wrong."""
    kept = archives(copy)
    file, texts = next((file, texts) for file, texts in kept.items() if len(texts) > 1)
    one, other, *_ = texts
    (copy / "certificates" / file).write_bytes(packed_texts({**texts, one: texts[other], other: texts[one]}))
    assert {one, other} <= set(check_folder(copy, seconds=10).wrong)


def test_a_text_that_is_missing(copy: Path) -> None:
    """A file that holds less than the report says is wrong, and what rests on it is not confirmed."""
    kept = archives(copy)
    file, name = place(kept, "always-step")
    (copy / "certificates" / file).write_bytes(
        packed_texts({key: text for key, text in kept[file].items() if key != name})
    )
    found = check_folder(copy, seconds=10)
    assert f"{copy / 'certificates' / file}: its certificates are not those listed in report.json." == found.wrong[file]
    assert any("never above eight" in one for one in refused(found))


def test_a_file_that_is_gone(copy: Path) -> None:
    """It is told, what rests on it is not confirmed, and what relies on it is wrong."""
    file, _ = place(archives(copy), "always-step")
    (copy / "certificates" / file).unlink()
    found = check_folder(copy, seconds=10)
    assert 1 == found.exit_code
    assert file in found.wrong
    assert any("never above eight" in one for one in refused(found))


@pytest.mark.parametrize("spoilt", [lambda data: data[:-40], lambda data: data[:90] + b"?" + data[91:], lambda _: b""])
def test_a_damaged_file(copy: Path, spoilt: Callable[[bytes], bytes]) -> None:
    """A file that was cut or changed is told by name; what rests on it is not confirmed."""
    file, _ = place(archives(copy), "overlap")
    path = copy / "certificates" / file
    path.write_bytes(spoilt(path.read_bytes()))
    found = check_folder(copy, seconds=10)
    assert found.wrong[file].startswith(f"{path}: damaged, ")
    assert 1 == found.exit_code
    assert any(row.why.endswith("of its certificates are missing or wrong") for row in found.rows)


def test_a_stranger_among_the_files(copy: Path) -> None:
    """A file that the report does not know is told."""
    (copy / "certificates" / "stranger.texts.xz").write_bytes(packed_texts({"a.smt2": "(check-sat)"}))
    assert ["stranger.texts.xz"] == list(check_folder(copy, seconds=10).wrong)


def test_a_run_that_does_not_show_it(copy: Path) -> None:
    """A witness that was cut is none; nor is one that is gone, or one in a file that was cut."""
    path = copy / "traces" / "counting.js"
    data = json.loads(read_script(path, FUNCTION))
    numbered = enumerate(data["runs"])
    [(at, run)] = [(at, one) for at, one in numbered if any("it comes to eight" in result for result in one["results"])]
    cut = {"steps": run["steps"] - 1, "like": [at, run["steps"] - 1]}
    data["runs"].append({**run, **cut, "results": [one for one in run["results"] if "comes to eight" in one]})
    path.write_text(script(FUNCTION, "counting", data=json.dumps(data).encode()))
    assert ["its run does not show it"] == not_confirmed(copy)
    data["runs"] = [
        {**one, "results": [id_ for id_ in one["results"] if "to eight" not in id_]} for one in data["runs"]
    ]
    path.write_text(script(FUNCTION, "counting", data=json.dumps(data).encode()))
    assert ["the report stores no run for it"] == not_confirmed(copy)
    path.write_bytes(path.read_bytes()[:-40])
    assert {f"{path}: damaged, it is no complete call of safelocRuns. Write the report again."} == set(
        not_confirmed(copy)
    )


def not_confirmed(folder: Path) -> list[str]:
    """Why results are not confirmed."""
    return [row.why for row in check_folder(folder, seconds=10).rows if row.answer == "not confirmed"]


def test_another_declaration(copy: Path) -> None:
    """If the declaration is not that of the report, nothing is confirmed, and the exit code is 3."""
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
    data = with_words(copy)
    for row in data["results"]:
        row["statement"] = row["statement"].replace("5 of 5", "6 of 6")
        row["id"] = row["id"].replace("never above eight", "never above one")
        row["method"] = row["method"].replace("under the assumption", "for all inputs in range")
    (copy / "report.json").write_text(json.dumps(data))
    told = " ".join(refused(check_folder(copy, seconds=10)))
    assert all(part in told for part in ("obligation/ranges", "never above one", "never far"))


@pytest.mark.parametrize("text", ["", "[]", '{"schema": "safeloc-report/2"}', "{" * 10_000])
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
    file, _ = place(archives(copy), "overlap")
    (copy / "certificates" / file).unlink()
    done = call("recheck", str(copy), "--seconds", "10", "--json")
    assert (1, 1) == (done.code, json.loads(done.out)["exit_code"])
    assert 2 == call("recheck", str(copy / "traces")).code
