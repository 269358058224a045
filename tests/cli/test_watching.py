"""`--watch`: a saved file is seen, what it is about is decided again, and what changed is shown first."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import threading
from pathlib import Path

import pytest

from safeloc.cli.watching import PACKAGE, Row, beside, changes, looked_at, rows
from tests.cli.calling import started

OWN = """
from safeloc.language.expr import number
from safeloc.language.machine import Machine, Transition, modes
from safeloc.language.spec import always
from safeloc.language.units import COUNT

A, B = modes("A", "B")
X, N = number("x", COUNT, 0, 9), number("n", COUNT, 0, 9)
machine = Machine("own", (A, B), [X], {N: 0}, {"n": N}, [Transition("go", A, B, X > 5, {N: X})])
properties = [always("small", N <= 9)]
"""


def result(name: str, verdict: str, seconds: float = 1.0, machine: str = "m") -> dict[str, object]:
    """A result as a report has it."""
    return {"id": name, "verdict": verdict, "seconds": seconds, "machine": machine, "rechecked": []}


def test_the_worst_comes_first_and_what_changed_before_the_rest() -> None:
    """What was kept has no line."""
    data = {
        "kept": {"other": "2026-01-01T00:00:00Z"},
        "results": [
            result("same", "proved", 9.0),
            result("mended", "proved"),
            result("broken", "violated"),
            result("open", "unknown"),
            result("kept", "violated", machine="other"),
        ],
    }
    before = {"same": "proved", "mended": "violated", "broken": "proved"}
    assert ["broken", "open", "mended", "same"] == [row.id for row in rows(data, before)]
    assert "violated     1.0 s  was proved   broken" == rows(data, before)[0].line
    assert "new" in rows(data, before)[1].line
    by_run = {**data, "results": [{**result("reached", "proved"), "rechecked": ["interpreter"]}]}
    assert rows(by_run, before)[0].line.startswith("shown ")
    assert "as before" in Row("x", "proved", 1.0, "proved").line


def test_a_file_that_is_saved_made_or_taken_away_is_seen(tmp_path: Path) -> None:
    """What Python makes of it, and files of other kinds, are not looked at."""
    path = tmp_path / "a.py"
    path.write_text("1")
    first = looked_at([tmp_path])
    (tmp_path / "__pycache__").mkdir()
    (tmp_path / "__pycache__" / "b.py").write_text("1")
    (tmp_path / "page.html").write_text("1")
    assert first == looked_at([tmp_path])
    path.write_text("22")
    second = looked_at([tmp_path])
    assert first != second
    path.unlink()
    assert {} == looked_at([tmp_path, tmp_path / "gone.py"])


def test_changes_come_one_by_one(tmp_path: Path) -> None:
    """Several files saved together are one change; one that comes while a run is going on is not lost."""
    path = tmp_path / "a.py"
    path.write_text("1")
    come = changes([tmp_path])
    next(come)
    path.write_text("while the first run was going on")
    next(come)

    def save() -> None:
        path.write_text("three")
        (tmp_path / "b.py").write_text("four")

    threading.Timer(0.5, save).start()
    next(come)
    assert (tmp_path / "b.py").exists()


def test_what_is_looked_at_besides_the_package(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The Python files beside a user's own module, those of where one works, and the configuration."""
    own, other, config = tmp_path / "own.py", tmp_path / "parts.py", tmp_path / "own.toml"
    for file in (own, other, config):
        file.write_text("")
    monkeypatch.chdir(tmp_path)
    assert [] == beside(["odometry"], None)
    assert {own, other, config} == set(beside([f"{own}:machine"], config))
    assert {own, other} == set(beside(["package.own:machine"], None))
    assert (PACKAGE / "cli" / "watching.py") in looked_at([PACKAGE])


def line_with(process: subprocess.Popen[str], words: str) -> str:
    """The next line that holds these words."""
    assert process.stdout is not None
    for line in process.stdout:
        if words in line:
            return line
    raise AssertionError(f"no line with {words!r}")


@pytest.mark.thorough
def test_an_edit_is_decided_again(tmp_path: Path) -> None:
    """The property that it breaks is first, with what it was before; a file that cannot be loaded says why; Ctrl-C ends."""
    path = tmp_path / "own.py"
    path.write_text(OWN)
    command = [sys.executable, "-m", "safeloc", "prove", f"{path}:machine", "--watch", "--depth", "6"]
    with started(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT) as process:
        try:
            assert "small" in line_with(process, "own/property/small")
            line_with(process, "waiting")
            path.write_text(OWN.replace("N <= 9", "N < 9"))
            broken = line_with(process, "own/")
            assert broken.startswith("violated")
            assert broken.split("was proved")[1].strip() == "own/property/small"
            line_with(process, "waiting")
            path.write_text("this is no Python")
            assert "own.py" in line_with(process, "SyntaxError")
            line_with(process, "waiting")
            path.write_text(OWN)
            assert "proved: 0 results decided" in line_with(process, "results decided")
            line_with(process, "waiting")
            os.killpg(process.pid, signal.SIGINT)
            line_with(process, "no longer watching")
            assert 0 == process.wait(60)
        finally:
            process.kill()
