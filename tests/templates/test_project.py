"""`safeloc init`: a project that is verified as it stands, or nothing at all."""

from __future__ import annotations

import os
import subprocess
import sys
import tomllib
from pathlib import Path

import pytest

from safeloc.errors import InputError
from safeloc.templates.project import TEMPLATES, write_project
from tests.cli.calling import Call

ROOT = Path(__file__).parents[2]
FILES = {
    ".github/workflows/verify.yml",
    ".gitignore",
    ".gitlab-ci.yml",
    "Makefile",
    "README.md",
    "pyproject.toml",
}
RECORDING = "recordings/run.jsonl"


def files(folder: Path) -> set[str]:
    """Every file in a folder, by its path in it."""
    return {path.relative_to(folder).as_posix() for path in folder.rglob("*") if path.is_file()}


@pytest.mark.parametrize("template", TEMPLATES)
def test_the_files_of_a_project(call: Call, tmp_path: Path, template: str) -> None:
    """Machine and tests as in the template; around them the project's name in place of every mark."""
    folder = tmp_path / "my-train"
    called = call("init", str(folder), "--template", template)
    assert called.code == 0
    module = TEMPLATES[template].module
    recordings = {RECORDING} if (ROOT / "safeloc" / "templates" / template / RECORDING).is_file() else set()
    assert FILES | recordings | {f"{module}.py", f"tests/test_{module}.py"} == files(folder)
    assert files(folder) == {str(Path(line).relative_to(folder)) for line in called.out.splitlines()}
    assert f"next: cd {folder}; make verify" in called.err
    source = ROOT / "safeloc" / "templates" / template / f"{module}.py"
    assert source.read_bytes() == (folder / f"{module}.py").read_bytes()
    project = tomllib.loads((folder / "pyproject.toml").read_text(encoding="utf-8"))
    assert ("my-train", [module]) == (project["project"]["name"], project["tool"]["setuptools"]["py-modules"])
    marks = ("@NAME@", "@MODULE@", "@MACHINE@", "@VERSION@", "safeloc.templates")
    assert [] == [
        name for name in files(folder) for mark in marks if mark in (folder / name).read_text(encoding="utf-8")
    ]
    assert f"{module}.py:{TEMPLATES[template].machine}" in (folder / "Makefile").read_text(encoding="utf-8")


@pytest.mark.thorough(ordinary=1)
@pytest.mark.parametrize("template", TEMPLATES)
@pytest.mark.parametrize(("rule", "says"), [("verify", "all holds: "), ("quick", "quick: ")])
def test_make_verify(tmp_path: Path, template: str, rule: str, says: str) -> None:
    """`make verify` and `make quick` of a new project: all holds, and a report; what was not asked is no failure of make."""
    folder = tmp_path / "train"
    write_project(folder, template)
    command = f"SAFELOC={sys.executable} -m safeloc"
    environment = {**os.environ, "PYTHONPATH": str(ROOT)}
    done = subprocess.run(
        ["make", rule, command], cwd=folder, env=environment, capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stdout + done.stderr
    assert says in done.stdout
    assert (folder / "report" / "index.html").is_file()


def test_an_empty_folder_is_taken(call: Call, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Also the current one."""
    folder = tmp_path / "here"
    folder.mkdir()
    monkeypatch.chdir(folder)
    assert call("init", ".").code == 0
    assert FILES < files(folder)
    assert 'name = "here"' in (folder / "pyproject.toml").read_text(encoding="utf-8")


def test_an_unknown_template(call: Call, tmp_path: Path) -> None:
    """Refused with the list; nothing is written."""
    called = call("init", str(tmp_path / "x"), "--template", "machin")
    assert called.code == 2
    assert (
        "safeloc: no template 'machin'; there are machine (one machine with the error law of a sensor); composition (a "
        "sensor's machine and a supervising one, with a contract); source (a source of your own for the localizer). Did you mean 'machine'?"
        == called.err.strip()
    )
    assert [] == list(tmp_path.iterdir())


def test_a_folder_with_files_is_refused(call: Call, tmp_path: Path) -> None:
    """What it holds is named, and stays as it was."""
    folder = tmp_path / "mine"
    folder.mkdir()
    for name in "abcd":
        (folder / name).write_text(name)
    called = call("init", str(folder))
    assert called.code == 2
    expected = (
        "not empty (it holds a, b, c and 1 more); nothing is overwritten. Name a new folder, or empty this one first."
    )
    assert f"safeloc: {folder}: {expected}" == called.err.strip()
    assert {"a", "b", "c", "d"} == files(folder)


@pytest.mark.parametrize("name", ["1train", "my train", "tr@in", "züge", "-", "train-", "a.b", "$(x)"])
def test_a_name_that_is_none(tmp_path: Path, name: str) -> None:
    """Names that pip, make or a shell would stumble over."""
    with pytest.raises(
        InputError, match=r"is no name for a project; use letters, digits, - and _, with a letter first"
    ):
        write_project(tmp_path / name, "machine")
    assert [] == list(tmp_path.iterdir())


def test_a_place_that_is_none(tmp_path: Path) -> None:
    """A file, a link to nothing, a folder in a folder that does not exist."""
    (tmp_path / "file").write_text("")
    (tmp_path / "link").symlink_to(tmp_path / "nothing")
    for name, reason in (
        ("file", r"a file, not a folder; name a folder that does not exist yet\.$"),
        ("gone/train", r"gone: no such folder; create it first, or name a folder in one that exists\.$"),
    ):
        with pytest.raises(InputError, match=reason):
            write_project(tmp_path / name, "machine")
    with pytest.raises(InputError, match=r"a link to something that does not exist; name another folder\.$"):
        write_project(tmp_path / "link", "machine")
    assert {"file", "link"} == {path.name for path in tmp_path.iterdir()}


@pytest.mark.parametrize("error", [OSError("disk full"), KeyboardInterrupt()])
def test_nothing_half_written_is_left(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, error: BaseException) -> None:
    """An error at the fifth file: whatever was written is gone; a folder that was there stays, empty."""
    folder, real, opened = tmp_path / "train", Path.open, list[Path]()
    folder.mkdir()

    def failing(self: Path, mode: str = "r", *rest: object, **named: object) -> object:
        if mode == "xb":
            opened.append(self)
        if len(opened) == 5:
            raise error
        return real(self, mode, *rest, **named)  # type: ignore[call-overload]

    monkeypatch.setattr(Path, "open", failing)
    with pytest.raises(InputError if isinstance(error, OSError) else KeyboardInterrupt) as caught:
        write_project(folder, "machine")
    assert 5 == len(opened)
    assert [] == list(folder.iterdir())
    if isinstance(error, OSError):
        assert f"{folder}: the project cannot be written here: disk full; nothing was left." == str(caught.value)


def test_what_somebody_else_wrote_meanwhile_stays(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A file that appears after the folder was found empty is neither overwritten nor removed."""
    folder = tmp_path / "train"
    monkeypatch.setattr("safeloc.templates.project._refuse_place", lambda _folder: None)
    folder.mkdir()
    (folder / "README.md").write_text("mine")
    with pytest.raises(InputError, match="cannot be written here"):
        write_project(folder, "machine")
    assert {"README.md"} == files(folder)
    assert "mine" == (folder / "README.md").read_text()
