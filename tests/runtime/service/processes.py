"""The process as a user starts it, with its reports and log read back."""

from __future__ import annotations

import json
import os
import select
import subprocess
import sys
import time
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from functools import cache
from pathlib import Path
from typing import Any

from safeloc.cli import main
from safeloc.runtime.streams.records import Record
from tests.forked import instead_of_exec
from tests.runtime.embedding.driving import drive, trusting

ROOT = Path(__file__).parents[3]
TRUSTING = "trust_first_marker = true\n"
PATIENCE_S = 90.0
SAFELOC = (sys.executable, "-c", "from safeloc.cli import main; main()")
"""The command `safeloc`, of this checkout. Here it is forked from the process of the tests, which saves a second each time."""
STARTED = (sys.executable, "-m", "safeloc")
"""The same, started as a shell would start it."""

Data = dict[str, Any]


def line(record: Record, **envelope: object) -> str:
    """A record as a line."""
    return json.dumps({**envelope, **record.model_dump(exclude_none=True)}) + "\n"


def lines(cycles: int, first: int = 1, **envelope: object) -> list[str]:
    """A drive as lines."""
    return [line(record, **envelope) for records in drive(cycles, first) for record in records]


def numbered(cycles: int, vehicle: str = "1") -> list[str]:
    """A drive with a count of lines, and a line at the end of each cycle."""
    made: list[str] = []
    for cycle, records in enumerate(drive(cycles), 1):
        for record in records:
            made.append(line(record, vehicle=vehicle, number=len(made) + 1))
        end = {"vehicle": vehicle, "number": len(made) + 1, "kind": "cycle", "time_ms": cycle * 100}
        made.append(json.dumps(end) + "\n")
    return made


def read(text: str | bytes) -> list[Data]:
    """Lines of JSON."""
    return [json.loads(one) for one in text.splitlines()]


def reports(told: Iterable[Data]) -> list[Data]:
    """Without events."""
    return [one for one in told if "mode" in one]


def command(folder: Path, *arguments: str, config: str = TRUSTING, machine: str = "odometry") -> list[str]:
    """What a shell would start."""
    path = folder / "config.toml"
    path.write_text(config, encoding="utf-8")
    return [*SAFELOC, "run", machine, "--config", str(path), *arguments]


def ran(
    folder: Path, *arguments: str, said: str = "", config: str = TRUSTING, machine: str = "odometry"
) -> subprocess.CompletedProcess[bytes]:
    """A whole run over standard input."""
    return run_to_its_end(command(folder, *arguments, config=config, machine=machine), input=said.encode())


def run_to_its_end(words: Sequence[str], **options: Any) -> subprocess.CompletedProcess[bytes]:
    """The same of any command line."""
    return subprocess.run(
        words, capture_output=True, cwd=ROOT, check=False, timeout=PATIENCE_S, **_forked_if_safeloc(words, options)
    )


def _forked_if_safeloc(words: Sequence[str], options: dict[str, Any]) -> dict[str, Any]:
    """Options of `subprocess` with which `safeloc` is forked, and not loaded anew; other programs are started as ever."""
    if tuple(words[: len(SAFELOC)]) != SAFELOC:
        return options
    trusting()  # what nearly all of them run is made before, once
    told = ["safeloc", *words[len(SAFELOC) :]]
    begin = instead_of_exec(main, told, options.get("env"), options.get("preexec_fn"))
    return {**options, "preexec_fn": begin, "restore_signals": False}


class Running:
    """A process that goes on; its log is read as it comes."""

    def __init__(self, words: Sequence[str], **options: Any) -> None:
        self.process = subprocess.Popen(
            words, stderr=subprocess.PIPE, cwd=ROOT, bufsize=0, **_forked_if_safeloc(words, options)
        )
        self.log: list[Data] = []
        self._rest = b""

    def logged(self, event: str) -> Data:
        """The next line of the log with this event; TimeoutError where it does not come."""
        until = time.monotonic() + PATIENCE_S
        seen = 0
        while True:
            for one in self.log[seen:]:
                seen += 1
                if one["event"] == event:
                    return one
            if time.monotonic() > until or not self._more(until - time.monotonic()):
                raise TimeoutError(f"no {event!r} in the log: {self.log}")

    def caught_up(self) -> list[Data]:
        """The log as far as it is written."""
        assert self.process.stderr is not None
        while select.select([self.process.stderr], [], [], 0)[0] and self._more(0):
            pass
        return self.log

    def _more(self, seconds: float) -> bool:
        assert self.process.stderr is not None
        fd = self.process.stderr.fileno()
        if not select.select([fd], [], [], max(0.0, seconds))[0]:
            return True
        data = os.read(fd, 65_536)
        *whole, self._rest = (self._rest + data).split(b"\n")
        self.log += [json.loads(one) for one in whole]
        return bool(data)

    def port(self) -> int:
        """Where it listens."""
        return int(self.logged("listening")["port"])

    def end(self, number: int | None = None) -> int:
        """Its exit code, after a signal if one is given."""
        if number is not None:
            self.process.send_signal(number)
        code = self.process.wait(PATIENCE_S)
        assert self.process.stderr is not None
        told = self._rest + self.process.stderr.read()
        assert b"Traceback" not in told, told.decode()
        self.log += read(told)
        return code


@contextmanager
def running(
    folder: Path, *arguments: str, config: str = TRUSTING, machine: str = "odometry", **streams: Any
) -> Iterator[Running]:
    """A process that does not outlive the test."""
    with started(command(folder, *arguments, config=config, machine=machine), **streams) as made:
        yield made


@contextmanager
def started(words: Sequence[str], **streams: Any) -> Iterator[Running]:
    """The same of any command line."""
    made = Running(words, **streams)
    try:
        yield made
    finally:
        if made.process.poll() is None:
            made.process.kill()
        made.process.wait()
        for stream in (made.process.stdin, made.process.stdout, made.process.stderr):
            if stream is not None:
                stream.close()


@cache
def nowhere() -> int:
    """What is written there is read by nobody; one descriptor for all tests of a process, however many examples they draw."""
    return os.open(os.devnull, os.O_WRONLY)


def wait_for(condition: Any, what: str) -> None:
    """Until it holds; TimeoutError where it does not."""
    until = time.monotonic() + PATIENCE_S
    while not condition():
        if time.monotonic() > until:
            raise TimeoutError(what)
        time.sleep(0.01)


def plain(report: Mapping[str, Any]) -> Data:
    """A report without what depends on how lines were counted."""
    return {key: value for key, value in report.items() if key not in ("cycle", "rejections")}
