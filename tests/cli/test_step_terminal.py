"""`safeloc step` in a terminal of 80 columns and 24 lines: a window, keys, and what they leave behind."""

from __future__ import annotations

import os
import select
import sys
import time
from collections.abc import Callable
from pathlib import Path

import pytest

from safeloc.runtime.streams.steps import read_steps
from tests.cli.test_step import LAMP

pytest.importorskip("textual", reason="textual is not installed; it is in the extra step")
pty = pytest.importorskip("pty", reason="there are no pseudo-terminals here")
SECONDS = 120


class Terminal:
    """A process in a pseudo-terminal, with everything that it has written."""

    def __init__(self, *command: str) -> None:
        self.process, self.file = pty.fork()
        if self.process == 0:
            os.environ |= {"TERM": "xterm-256color", "LINES": "24", "COLUMNS": "80"}
            os.execv(command[0], command)
        self.written = ""

    def until(self, reached: Callable[[], bool]) -> None:
        """Read what the process writes until something is so."""
        end = time.monotonic() + SECONDS
        while not reached():
            assert time.monotonic() < end, self.written[-2000:]
            if select.select([self.file], [], [], 0.1)[0]:
                self.written += os.read(self.file, 65536).decode(errors="replace")

    def type(self, keys: str) -> None:
        """Press keys."""
        os.write(self.file, keys.encode())

    def exit_code(self) -> int:
        """Read to the end, and return how the process ended."""
        try:
            while text := os.read(self.file, 65536):
                self.written += text.decode(errors="replace")
        except OSError:  # Linux says so at the end of a pseudo-terminal
            pass
        finally:
            os.close(self.file)
        return os.waitstatus_to_exitcode(os.waitpid(self.process, 0)[1])


@pytest.mark.thorough
def test_keys_step_undo_and_save(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Three steps and one back are two; the run and its test file are written; q leaves."""
    monkeypatch.chdir(tmp_path)
    Path("lamp.py").write_text(LAMP, encoding="utf-8")
    window = Terminal(sys.executable, "-m", "safeloc", "step", "lamp.py:machine")
    window.until(lambda: "step 0" in window.written)
    window.type("nnn")
    window.until(lambda: "step 3" in window.written)
    window.type("b")
    window.until(lambda: "step 2" in window.written)
    window.type("srun.jsonl\r")
    window.until(lambda: "2 steps: run.jsonl" in window.written)
    window.type("stest_run.py\r")
    window.until(lambda: "test_run.py" in window.written and Path("test_run.py").exists())
    window.type("q")
    assert 0 == window.exit_code()
    assert 2 == len(read_steps(Path("run.jsonl")).steps)
    assert "lamp" in Path("test_run.py").read_text(encoding="utf-8")
