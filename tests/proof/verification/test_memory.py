"""The memory of a run: it includes all processes, and the processes that these start."""

from __future__ import annotations

import os
import subprocess
import sys
import time
from pathlib import Path

import pytest

from safeloc.proof.verification import memory
from safeloc.proof.verification.memory import Memory, Taken, descendants, taken

pytestmark = pytest.mark.skipif(not Path("/proc/self/smaps_rollup").exists(), reason="the system does not tell")
HOLD = "import sys; held = bytearray(80_000_000); print('held', flush=True); sys.stdin.read()"
START = f"import subprocess, sys; subprocess.run([sys.executable, '-c', {HOLD!r}])"


@pytest.mark.parametrize("code", [HOLD, START])
def test_what_a_process_holds_is_seen(code: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """The memory of a child process counts, and that of a grandchild."""
    monkeypatch.setattr(memory, "LOOKS_EVERY_S", 0.3)
    before, command = sum(one.size_bytes for one in taken(os.getpid(), {}).values()), [sys.executable, "-c", code]
    with Memory() as seen, subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True) as one:
        assert one.stdout is not None
        assert "held" in one.stdout.readline()
        assert one.pid in descendants(os.getpid())
        time.sleep(3 * memory.LOOKS_EVERY_S)
    assert seen.most_bytes - before > 70_000_000


def test_where_the_system_does_not_tell(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    """Without figures from the system the memory is 0, and nothing fails."""
    monkeypatch.setattr(memory, "PROC", tmp_path)
    with Memory() as seen:
        pass
    assert 0 == seen.most_bytes


def test_an_idle_process_is_measured_once() -> None:
    """A process that has not run since the last look keeps its figure; one that has run is measured again."""
    with subprocess.Popen(
        [sys.executable, "-c", HOLD], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True
    ) as one:
        assert one.stdout is not None
        assert "held" in one.stdout.readline()
        time.sleep(0.2)  # it waits for its input now
        first = taken(os.getpid(), {})
        pretended = {one.pid: Taken(1, first[one.pid].ticks)}
        assert taken(os.getpid(), pretended)[one.pid] == pretended[one.pid]
        ran = {one.pid: Taken(1, first[one.pid].ticks - 1)}
        assert taken(os.getpid(), ran)[one.pid].size_bytes > 70_000_000
