"""The digests of a report: what is there, what was changed, what is gone, what is not of the report."""

from __future__ import annotations

import subprocess
from pathlib import Path

import pytest

from safeloc.errors import InputError
from safeloc.report.digests import SUMS
from safeloc.report.folder import files_of, render_folder, unfit, write_folder
from tests.report.test_page import door, findings


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """A report."""
    return write_folder(tmp_path / "report", findings(), [door()]).parent


def test_a_report_fits(folder: Path) -> None:
    """As it was written, and after its page was rendered again, in either form; every file of it has a digest."""
    assert unfit(folder) == []
    render_folder(folder, single=True)
    assert unfit(folder) == []
    render_folder(folder)
    assert unfit(folder) == []
    listed = [line.partition("  ")[2] for line in (folder / SUMS).read_text().splitlines()]
    assert sorted([SUMS, *listed]) == sorted(files_of(folder))
    assert sorted(files_of(folder)) == sorted(
        path.relative_to(folder).as_posix() for path in folder.rglob("*") if path.is_file()
    )


def test_the_form_is_that_of_sha256sum(folder: Path) -> None:
    """The program of every Linux agrees, and refuses what we refuse."""
    check = ["sha256sum", "--check", "--quiet", SUMS]
    assert subprocess.run(check, cwd=folder, check=False).returncode == 0
    (folder / "report.json").write_text("{}")
    assert subprocess.run(check, cwd=folder, check=False, capture_output=True).returncode == 1


def test_what_does_not_fit(folder: Path) -> None:
    """Each by its name; rendering the page again makes none of it good."""
    (folder / "traces" / "door.js").write_text("")
    (folder / "junit.xml").unlink()
    (folder / "certificates" / "mine.tar.xz").write_text("")
    expected = [
        "junit.xml is missing",
        "certificates/mine.tar.xz is not of this report",
        "traces/door.js is not the file that was written",
    ]
    assert unfit(folder) == expected
    (folder / "traces" / "door.js").write_text("safelocRuns();")
    with pytest.raises(InputError, match="damaged"):
        render_folder(folder)
    assert unfit(folder) == expected


def test_verdicts_that_were_changed(folder: Path) -> None:
    """Nor does a page that is rendered from changed data fit."""
    path = folder / "report.json"
    path.write_text(path.read_text().replace('"verdict":"violated"', '"verdict":"proved"'))
    render_folder(folder)
    assert unfit(folder) == ["report.json is not the file that was written"]


def test_without_digests(folder: Path) -> None:
    """It cannot be told whether the files belong together, and a page that is rendered again does not change that."""
    (folder / SUMS).unlink()
    render_folder(folder)
    assert [line.partition(":")[0] for line in unfit(folder)] == ["SHA256SUMS is missing"]


def test_digests_that_are_none(folder: Path) -> None:
    """Refused with the line."""
    with (folder / SUMS).open("a") as file:
        file.write("abc  index.html\n")
    lines = len((folder / SUMS).read_text().splitlines())
    with pytest.raises(InputError, match=rf"SHA256SUMS:{lines}: no digest and name of a file"):
        unfit(folder)
