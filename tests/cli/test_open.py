"""`safeloc open`: what a word stands for, the page that is written, and when no verdict is shown."""

from __future__ import annotations

import shutil
import webbrowser
from pathlib import Path

import pytest

from safeloc.report.digests import origin
from safeloc.report.folder import write_folder
from safeloc.report.opening import find
from safeloc.runtime.streams.steps import write_steps
from safeloc.target import recorded
from tests.cli.calling import Call, Called
from tests.report.test_page import DOOR, door, findings

STEPS = [{"speed": 0, "released": True, "blocked": False}] * 3


@pytest.fixture
def asked(monkeypatch: pytest.MonkeyPatch) -> list[str]:
    """The addresses that a browser was asked to show; there is a screen."""
    shown: list[str] = []
    monkeypatch.setattr(webbrowser, "open", shown.append)
    monkeypatch.setenv("DISPLAY", ":0")
    return shown


def test_a_report(call: Call, tmp_path: Path, asked: list[str]) -> None:
    """Its page is printed and shown; `--no-browser` only prints it; nothing is written."""
    page = write_folder(tmp_path / "report", findings(), [door()])
    before = {path: path.read_bytes() for path in page.parent.rglob("*") if path.is_file()}
    assert call("open", str(page.parent)) == Called(0, f"{page}\n", f"{origin(page.parent)[0]}\n")
    assert asked == [page.as_uri()]
    assert call("open", str(page.parent), "--no-browser") == Called(0, f"{page}\n", f"{origin(page.parent)[0]}\n")
    assert len(asked) == 1
    assert before == {path: path.read_bytes() for path in page.parent.rglob("*") if path.is_file()}


def test_runs_of_a_report(call: Call, tmp_path: Path, asked: list[str]) -> None:
    """A file of runs is shown by the page of its report; one by itself is refused."""
    folder = write_folder(tmp_path / "report", findings(), [door()]).parent
    assert call("open", str(folder / "traces" / "door.js")) == Called(0, f"{folder / 'run.html'}\n", "")
    assert asked == [(folder / "run.html").as_uri()]
    alone = Path(shutil.copy(folder / "traces" / "door.js", tmp_path))
    assert "is shown by run.html of its report" in call("open", str(alone)).err


def test_files_that_do_not_fit(call: Call, tmp_path: Path, asked: list[str]) -> None:
    """A page says what does not fit, with exit code 2, and no verdict; names in it are text."""
    folder = write_folder(tmp_path / "report <b>", findings(), [door()]).parent
    (folder / "junit.xml").write_text("")
    found = call("open", str(folder))
    assert (found.code, found.err) == (2, "safeloc: junit.xml is not the file that was written\n")
    page = Path(found.out.strip())
    assert page.parent != folder
    assert asked == [page.as_uri()]
    text = page.read_text()
    assert "This report is not as it was written" in text
    assert "report &lt;b&gt;" in text
    assert 'class="verdict' not in text
    assert "violated</span>" not in text


def test_a_stream(call: Call, tmp_path: Path, asked: list[str]) -> None:
    """Its machine is named in it, or with --machine; the page is written where the user says, else in a new folder."""
    stream, out = tmp_path / "mine.jsonl", tmp_path / "out.html"
    write_steps(stream, STEPS)
    assert "does not name its machine; say which with --machine" in call("open", str(stream)).err
    assert call("open", str(stream), "--machine", DOOR, "--out", str(out)) == Called(0, f"{out}\n", "")
    text = out.read_text()
    assert '"first":"door/recording/mine"' in text
    assert "src=" not in text.replace("script.src=", "")
    again = call("open", str(stream), "--machine", DOOR)
    assert Path(again.out.strip()).parent.name.startswith("safeloc-")
    assert len(asked) == 2


def test_a_machine_and_a_recording_by_name(call: Call, tmp_path: Path, asked: list[str]) -> None:
    """All recordings that ship with a machine; one by its own name."""
    for word, names in (("axle_section", [path.name for path in recorded("axle_section")]), ("axle_section-service", ["axle_section-service.jsonl.gz"])):  # fmt: skip
        assert call("open", word, "--out", str(tmp_path / "page.html"), "--no-browser").code == 0
        first = names[0].partition(".")[0]
        assert f'"first":"axle_section/recording/{first}"' in (tmp_path / "page.html").read_text()
    assert asked == []


def test_a_path_comes_first(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A folder that has the name of a machine is that folder."""
    monkeypatch.chdir(tmp_path)
    write_folder(tmp_path / "odometry", findings(), [door()])
    assert find("odometry").page == Path("odometry/index.html")


@pytest.mark.parametrize(
    ("word", "told"),
    [
        ("odometri", "Did you mean odometry"),
        ("sweep", "Did you mean axle_section-sweep-turns, sections-sweep?"),
        ("xyzzy", "`safeloc list` names what there is"),
        ("travel_direction", "no recording of it ships; `safeloc simulate travel_direction`"),
        (".", "no report; `safeloc verify --out .` writes one"),
        ("no/such.jsonl", "no such file or folder"),
    ],
)
def test_what_cannot_be_shown(
    call: Call, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, word: str, told: str
) -> None:
    """Exit code 2, and what to do."""
    monkeypatch.chdir(tmp_path)
    found = call("open", word, "--no-browser")
    assert found.code == 2
    assert told in found.err


def test_out_is_for_pages_that_are_written(call: Call, tmp_path: Path) -> None:
    """A report has its page already; a place that cannot be written is told."""
    folder = write_folder(tmp_path / "report", findings(), [door()]).parent
    assert "--out is for the page of a stream or a machine" in call("open", str(folder), "--out", "x.html").err
    found = call("open", "axle_section", "--out", str(tmp_path / "none" / "x.html"), "--no-browser")
    assert (found.code, "cannot be written" in found.err) == (2, True)


def test_without_a_screen(call: Call, tmp_path: Path, asked: list[str], monkeypatch: pytest.MonkeyPatch) -> None:
    """The path is printed, and no browser is started in the terminal."""
    for name in ("DISPLAY", "WAYLAND_DISPLAY", "BROWSER"):
        monkeypatch.delenv(name, raising=False)
    page = write_folder(tmp_path / "report", findings(), [door()])
    assert call("open", str(page.parent)) == Called(0, f"{page}\n", f"{origin(page.parent)[0]}\n")
    assert asked == []
