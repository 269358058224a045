"""The digests of a report: what is there, what was changed, what is gone, what is not of the report."""

from __future__ import annotations

import shutil
import subprocess
from pathlib import Path

import pytest

from safeloc.errors import InputError
from safeloc.report.digests import SUMS, origin
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
    (folder / "certificates" / "mine.texts.xz").write_text("")
    expected = [
        "junit.xml is missing",
        "certificates/mine.texts.xz is not of this report",
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


def test_what_the_digests_do_not_show_is_told(folder: Path) -> None:
    """Nothing says who made the report; a signature beside them is named as not checked, with the command that checks it."""
    [line] = origin(folder)
    assert "nothing was changed by accident" in line
    assert "who made it, that does not show" in line
    assert f"gpg --armor --detach-sign {SUMS}" in line
    (folder / f"{SUMS}.asc").write_text("-----BEGIN PGP SIGNATURE-----\n")
    (folder / f"{SUMS}.sig").write_text("-----BEGIN SSH SIGNATURE-----\n")
    _, gpg, ssh = origin(folder)
    assert f"{SUMS}.asc is there, and not checked by safeloc; this checks it: gpg --verify {SUMS}.asc {SUMS}" == gpg
    assert "ssh-keygen -Y verify" in ssh
    (folder / f"{SUMS}.sig").write_bytes(b"\x88\x75")
    assert origin(folder)[2].endswith(f"gpg --verify {SUMS}.sig {SUMS}")
    assert unfit(folder) == []


@pytest.mark.skipif(shutil.which("ssh-keygen") is None, reason="ssh-keygen is not installed")
def test_the_command_that_is_named_checks_a_signature(folder: Path, tmp_path: Path) -> None:
    """Signed as the page says; then a changed digest is found out, which the digests themselves would not show."""
    key = tmp_path / "key"
    made = ["ssh-keygen", "-q", "-t", "ed25519", "-N", "", "-f", str(key)]
    subprocess.run(made, check=True)
    sign = ["ssh-keygen", "-q", "-Y", "sign", "-f", str(key), "-n", "safeloc-report", SUMS]
    subprocess.run(sign, cwd=folder, check=True, capture_output=True)
    (folder / "ALLOWED_SIGNERS").write_text(f"WHO {key.with_suffix('.pub').read_text()}")
    command = origin(folder)[1].partition("this checks it: ")[2]
    assert 0 == subprocess.run(command, shell=True, cwd=folder, check=False, capture_output=True).returncode
    (folder / SUMS).write_text((folder / SUMS).read_text().replace("0", "1"))
    assert 0 != subprocess.run(command, shell=True, cwd=folder, check=False, capture_output=True).returncode
