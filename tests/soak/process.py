"""The process as a host runs it: on a port of its own, with a snapshot, its log in a file; and what it uses."""

from __future__ import annotations

import json
import os
import signal
import subprocess
from pathlib import Path
from typing import Any

from tests.runtime.service.processes import PATIENCE_S, ROOT, command, wait_for
from tests.soak.day import CONFIG

KIB = 1024
SIGNS = ('"event": "failed"', '"event": "halted"', "Traceback")
"""What stands in the log where something happened that nobody planned."""


class Process:
    """Started anew with `start`, it goes on from its snapshot. `life` counts the starts."""

    def __init__(self, folder: Path, life: int = 0) -> None:
        self.folder, self.life = folder, life
        self.running: subprocess.Popen[bytes] | None = None
        folder.mkdir(parents=True, exist_ok=True)

    def start(self, *, fresh: bool) -> int:
        """The port on which it hears lines."""
        self.life += 1
        arguments = ["--from", "tcp:0", "--snapshot", str(self.folder / "snapshot.json"), *(["--fresh"] * fresh)]
        self._log = self.folder / f"log-{self.life}.jsonl"
        with self._log.open("wb") as log:
            self.running = subprocess.Popen(
                command(self.folder, *arguments, config=CONFIG), stdin=subprocess.DEVNULL, stderr=log, cwd=ROOT
            )
        wait_for(lambda: self._told("started") is not None, f"it hears nothing; see {self._log}")
        return int((self._told("listening") or {})["port"])

    def end(self, number: signal.Signals) -> list[str]:
        """End it by a signal; what went wrong in its life, by its log and its exit code."""
        assert self.running is not None
        self.running.send_signal(number)
        code = self.running.wait(PATIENCE_S)
        with self._log.open(encoding="utf-8") as log:
            wrong = [line.strip()[:500] for line in log if any(sign in line for sign in SIGNS)]
        wanted = -number if number == signal.SIGKILL else 0
        return wrong if code == wanted else [*wrong, f"exit code {code} after {number.name}"]

    def kill(self) -> None:
        """Leave nothing behind that runs."""
        if self.running is not None and self.running.poll() is None:
            self.running.kill()
            self.running.wait()

    def resident_kib(self) -> int:
        """Memory that it holds."""
        return int(self._of("statm").split()[1]) * os.sysconf("SC_PAGE_SIZE") // KIB

    @property
    def pid(self) -> int:
        """Its number."""
        assert self.running is not None
        return self.running.pid

    def processor_s(self) -> float:
        """Processor time that it has had since its start."""
        fields = self._of("stat").rpartition(")")[2].split()
        return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")

    def _told(self, event: str) -> dict[str, Any] | None:
        """The first line of its log with this event."""
        whole = self._log.read_text(encoding="utf-8").splitlines(keepends=True)
        told = (json.loads(line) for line in whole if line.startswith("{") and line.endswith("\n"))
        return next((one for one in told if one["event"] == event), None)

    def _of(self, file: str) -> str:
        return Path(f"/proc/{self.pid}/{file}").read_text(encoding="ascii")


def waited_s(pid: int) -> float:
    """How long the main thread of a process has been ready to run and waited for a core."""
    return int(Path(f"/proc/{pid}/schedstat").read_text(encoding="ascii").split()[1]) / 1e9
