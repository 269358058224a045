"""A copy of the package in which files are edited, and runs of `safeloc verify` in it."""

from __future__ import annotations

import json
import os
import shutil
import signal
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from subprocess import PIPE
from typing import Any

from safeloc.errors import InputError
from safeloc.report.stored import read_report

ROOT = Path(__file__).parents[2]
PARTS = ("safeloc", "models", "properties")
QUICKLY = ("--depth", "8", "--seconds", "20", "--examples", "5", "--steps", "20", "--jobs", "2")
MOST_SECONDS = 900
_TICKS_S = 0.1
"""A process that starts within a tick of the clock after the files were written keeps nothing: they may have changed since."""
MOST_SECONDS_OF_ALL = 3600


@dataclass(frozen=True)
class Ran:
    """A run: its exit code (-1: it was ended by the clock), verdicts by id, machines whose findings were kept, and errors."""

    code: int
    verdicts: Mapping[str, str]
    kept: frozenset[str]
    error: str

    @property
    def said(self) -> tuple[int, Mapping[str, str]]:
        """What two runs of the same have to agree on."""
        return self.code, self.verdicts

    @property
    def decided(self) -> bool:
        """Whether the clock had no part in it."""
        return self.code >= 0 and "unknown" not in self.verdicts.values()


_ENDED = Ran(-1, {}, frozenset(), "ended by the clock")


def _ran(code: int, data: Mapping[str, Any]) -> Ran:
    """Return what a report says of a run."""
    return Ran(code, {one["id"]: one["verdict"] for one in data["results"]}, frozenset(data["kept"]), "")


class Checkout:
    """The copy, in a folder of its own."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        for name in PARTS:
            shutil.copytree(ROOT / name, folder / name, symlinks=True, ignore=shutil.ignore_patterns("__pycache__"))
        time.sleep(_TICKS_S)

    def verified(self, machine: str, cache: Path) -> Ran:
        """One machine, with what is kept there."""
        with tempfile.TemporaryDirectory() as report:
            asked = ("verify", machine, *QUICKLY, "--json", "--out", report, "--cache", str(cache))
            return self._run(*asked, seconds=MOST_SECONDS)

    def all_verified(self, cache: Path, *machines: str, seconds: float = MOST_SECONDS_OF_ALL) -> Ran:
        """All machines, or some, as a user asks for them; ended after so many seconds. The verdicts are those of the report."""
        with tempfile.TemporaryDirectory() as report:
            asked = ("verify", *machines, "--jobs", "2", "--out", report, "--cache", str(cache))
            try:
                ran = self._started("-m", "safeloc", *asked, seconds=seconds)
            except subprocess.TimeoutExpired:
                return _ENDED
            try:
                return _ran(ran.returncode, read_report(Path(report)))
            except InputError:
                return Ran(ran.returncode, {}, frozenset(), ran.stderr[-500:])

    def compile(self) -> None:
        """Compile all modules, so that a run compiles only what was edited: a compiled module is for one source text, whenever
        that was written."""
        done = self._started("-m", "compileall", "-q", "--invalidation-mode", "checked-hash", ".", seconds=MOST_SECONDS)
        if done.returncode != 0:
            raise RuntimeError(done.stdout[-500:])

    def loads(self, machine: str) -> bool:
        """Whether the machine can be made at all."""
        code = f"from safeloc.catalogue import load_target; load_target({machine!r})"
        return self._started("-c", code, seconds=60).returncode == 0

    def files_of(self, machine: str) -> list[Path]:
        """The files in which the machine's transitions stand."""
        code = (
            "from safeloc.catalogue import load_target;"
            f"print(*{{row.src.rpartition(':')[0] for one in load_target({machine!r}).machines for row in one.transitions}}, sep='\\n')"
        )
        told = self._started("-c", code, seconds=60).stdout.split()
        return sorted({Path(name).resolve() for name in told if Path(name).resolve().is_relative_to(self.folder)})

    def _run(self, *arguments: str, seconds: float) -> Ran:
        try:
            ran = self._started("-m", "safeloc", *arguments, seconds=seconds)
        except subprocess.TimeoutExpired:
            return _ENDED
        try:
            return _ran(ran.returncode, json.loads(ran.stdout))
        except ValueError:
            return Ran(ran.returncode, {}, frozenset(), ran.stderr[-500:])

    def _started(self, *arguments: str, seconds: float) -> subprocess.CompletedProcess[str]:
        where = {**os.environ, "PYTHONPATH": str(self.folder), "PYTHONDONTWRITEBYTECODE": "1"}
        command = [sys.executable, *arguments]
        with subprocess.Popen(
            command, cwd=self.folder, env=where, stdout=PIPE, stderr=PIPE, text=True, start_new_session=True
        ) as process:
            try:
                out, err = process.communicate(timeout=seconds)
            except subprocess.TimeoutExpired:
                os.killpg(
                    process.pid, signal.SIGKILL
                )  # its own processes as well: they would take time from the next run
                raise
        return subprocess.CompletedProcess(command, process.returncode, out, err)


@contextmanager
def edited(path: Path, text: str) -> Iterator[None]:
    """Within, the file has this text."""
    before = path.read_text(encoding="utf-8")
    path.write_text(text, encoding="utf-8")
    try:
        yield
    finally:
        path.write_text(before, encoding="utf-8")
