"""How a command ends when it has no verdict: never with a verdict's exit code."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest
from rich.console import Console

from safeloc.cli import main as commands
from safeloc.cli import prove, show
from safeloc.cli.show import Progressing
from safeloc.language.verdict import Held
from safeloc.proof.cache import engine
from safeloc.proof.results import Finding
from tests.cli.calling import DOOR, QUICK, Call

ROOT = Path(__file__).parents[2]
COMMAND = [sys.executable, "-c", "from safeloc.cli import main; main()"]


@pytest.mark.parametrize(
    ("error", "code", "message"),
    [
        (KeyboardInterrupt(), 130, "safeloc: interrupted; no result."),
        (RuntimeError("a defect"), 2, "RuntimeError: a defect\nsafeloc: failed, as printed above; no result."),
        (RecursionError("too deep"), 2, "RecursionError: too deep"),
        (PermissionError(13, "no"), 2, "PermissionError: [Errno 13] no"),
    ],
)
def test_no_error_looks_like_a_violation(
    call: Call, monkeypatch: pytest.MonkeyPatch, error: BaseException, code: int, message: str
) -> None:
    """Python itself would end with 1, which is the code of a violated property."""

    def fails(*_: object) -> None:
        raise error

    monkeypatch.setattr(prove, "load_target", fails)
    called = call("prove", DOOR)
    assert (called.code, called.out) == (code, "")
    assert message in called.err


@pytest.mark.parametrize(("began", "said"), [(0.0, True), (float("inf"), False)])
def test_results_that_are_not_kept_are_told(
    call: Call, monkeypatch: pytest.MonkeyPatch, tmp_path: Path, began: float, said: bool
) -> None:
    """A file of the package was written after the process began."""
    monkeypatch.setattr(engine, "_BEGAN", began)
    monkeypatch.setattr(engine, "_disturbed", [False])
    called = call("prove", DOOR, *QUICK, "--cache", str(tmp_path))
    assert called.code == 0
    assert ("what it found after that is not kept" in called.err) == said


@pytest.mark.thorough(ordinary=1)
@pytest.mark.parametrize("what", [["export", DOOR, "--to", "smtlib"], ["list", "requirements"]])
def test_a_closed_pipe(what: list[str]) -> None:
    """The reader went away: no complaint, and no verdict's exit code."""
    writer = subprocess.Popen([*COMMAND, *what], cwd=ROOT, stdout=subprocess.PIPE, stderr=subprocess.PIPE)
    assert writer.stdout is not None
    assert writer.stderr is not None
    writer.stdout.close()
    complaint = writer.stderr.read().decode()
    assert (writer.wait(60), complaint) == (141, "")


# ------------------------------------------------------------------ progress


class Terminal:
    """A standard error that says it is a terminal."""

    def __init__(self) -> None:
        self.text = ""

    def write(self, text: str) -> int:
        """Keep it."""
        self.text += text
        return len(text)

    def flush(self) -> None:
        """Nothing is held back."""

    def isatty(self) -> bool:
        """It is."""
        return True


FINDING = Finding("door/test/x", "door", "test", "x", Held("Hypothesis", 1, 1), "Hypothesis", 0.5)


def test_progress_in_a_pipe_is_plain_lines(capsys: pytest.CaptureFixture[str]) -> None:
    """A phase, then a line a finding; nothing that moves."""
    with Progressing(2, quiet=False) as progress:
        progress.say("testing door", 2)
        progress.add(FINDING)
    assert capsys.readouterr().err == "testing door\nheld      door/test/x  (0.5 s)\n"


def test_progress_on_a_terminal_is_a_bar_with_an_estimate(monkeypatch: pytest.MonkeyPatch) -> None:
    """A phase that gives more or fewer findings than planned does not move the end."""
    terminal = Terminal()
    monkeypatch.setattr(sys, "stderr", terminal)
    monkeypatch.setenv("TERM", "xterm")
    monkeypatch.setattr(show, "err", Console(stderr=True))  # it asks once, when it is made, what it writes to
    with Progressing(5, quiet=False) as progress:
        progress.say("proving door", 2)
        for _ in range(4):
            progress.add(FINDING)
        assert progress.done == (2, 5)
        progress.say("testing door", 3)
        progress.add(FINDING)
        assert progress.done == (3, 5)
    assert "proving door" in terminal.text
    assert "left" in terminal.text


def test_progress_is_silent_with_json(capsys: pytest.CaptureFixture[str]) -> None:
    """Standard error is empty as well."""
    with Progressing(1, quiet=True) as progress:
        progress.say("testing door", 1)
        progress.add(FINDING)
    assert capsys.readouterr().err == ""


def test_the_entry_point_is_a_function() -> None:
    """What the installed script calls."""
    assert callable(commands)
