"""The memory of a run: it includes all processes, and the processes that these start."""

from __future__ import annotations

import os
import subprocess
import sys
import time
from pathlib import Path

import pytest

from safeloc.proof.verification import memory
from safeloc.proof.verification.memory import Memory, descendants, taken_bytes

pytestmark = pytest.mark.skipif(not Path("/proc/self/smaps_rollup").exists(), reason="the system does not tell")
HOLD = "import sys; held = bytearray(80_000_000); print('held', flush=True); sys.stdin.read()"
START = f"import subprocess, sys; subprocess.run([sys.executable, '-c', {HOLD!r}])"


@pytest.mark.parametrize("code", [HOLD, START])
def test_what_a_process_holds_is_seen(code: str) -> None:
    """The memory of a child process counts, and that of a grandchild."""
    before, command = taken_bytes(os.getpid()), [sys.executable, "-c", code]
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
