"""Workers that a parent forks: started again, ended in order, never left behind."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import threading
from pathlib import Path

import pytest

from safeloc.errors import InputError
from safeloc.runtime.service.journal import Journal
from safeloc.runtime.service.supervised import Supervised
from safeloc.runtime.service.workers import Workers
from tests.runtime.service.broker.mosquitto import (
    broker,
    broker_file,
    gateway,
    messages,
    needs_mosquitto,
    without_lines,
)
from tests.runtime.service.broker.workers import alone
from tests.runtime.service.processes import PATIENCE_S, ROOT, Data, numbered, read, running, wait_for

FAILING = """
import os, sys, time
from safeloc.runtime.service import workers
from safeloc.runtime.service.journal import Journal
from safeloc.runtime.service.supervised import Supervised
workers._AGAIN_S, workers._SILENT_S, workers._LOOK_S = 0.01, 0.2, 0.05
link = workers.Workers(1, Journal(2), Supervised(None, {})).run()
if sys.argv[1] == "hangs":
    time.sleep(100)
os._exit(7)
"""


def taken(log: list[Data]) -> list[tuple[int, int]]:
    """Which worker took which partition, in order."""
    return [(one["worker"], one["partition"]) for one in log if one["event"] == "partition taken"]


def is_there(pid: int) -> bool:
    """Whether the process runs, or waits for its parent."""
    return Path(f"/proc/{pid}").exists()


@needs_mosquitto
@pytest.mark.parametrize("number", [signal.SIGTERM, signal.SIGKILL])
def test_workers_start_again_and_end_with_their_parent(tmp_path: Path, number: int) -> None:
    """A killed worker costs no report, and another one follows it. Whatever ends the parent, the workers give their leases
    back and end."""
    with (
        broker(tmp_path / "broker") as there,
        gateway(there.port) as speaker,
        running(
            tmp_path, "--from", there.url, "--broker", str(broker_file(tmp_path)), "--snapshot", str(tmp_path / "kept"),
            "--processes", "2",
        ) as parent,
    ):  # fmt: skip
        wait_for(lambda: len(taken(parent.caught_up())) == 4, "owners")
        said = messages(numbered(30, "7"))
        for one in said[:15]:
            speaker.send("7", one)
        wait_for(lambda: len(speaker.by_cycle("7")) == 15, "reports")
        os.kill(parent.logged("worker started")["pid"], signal.SIGKILL)
        for one in said[15:]:
            speaker.send("7", one)
        wait_for(lambda: len(speaker.by_cycle("7")) == 30, "reports")
        assert [without_lines(one) for _, one in sorted(speaker.by_cycle("7").items())] == alone("7", numbered(30, "7"))
        # its own ones, or on a busy machine two that the other one has taken meanwhile (test_fleet has them wait)
        wait_for(
            lambda: [one for one, _ in taken(parent.caught_up())[4:]].count(0) == 2, "two partitions of a third worker"
        )
        pids = [one["pid"] for one in parent.log if one["event"] == "worker started"]
        if number == signal.SIGTERM:
            assert parent.end(number) == 0
        else:
            parent.process.kill()
        wait_for(lambda: not any(is_there(pid) for pid in pids), "the end of all workers")
        wait_for(lambda: set(speaker.owners().values()) == {""}, "free leases")
        ends = [one for one in parent.log if one["event"] == "worker ended"]
        assert (ends[0]["worker"], ends[0]["code"]) == (0, -signal.SIGKILL)


@pytest.mark.parametrize(("what", "told"), [("fails", "exit code 7"), ("hangs", "signal 9")])
def test_a_worker_that_fails_again_and_again(what: str, told: str) -> None:
    """Five lives that are short end everything, with an error that says so; one that gives no sign is killed for it."""
    words = [sys.executable, "-c", FAILING, what]
    ended = subprocess.run(words, cwd=ROOT, capture_output=True, timeout=PATIENCE_S, check=False)
    assert ended.returncode == 1
    assert (
        f"worker 0 ended 5 times in a row within 30 s of its start, the last time with {told}" in ended.stderr.decode()
    )
    log = read("\n".join(line for line in ended.stderr.decode().splitlines() if line.startswith("{")))
    assert [one["event"] for one in log].count("worker started") == 5
    assert [one["short_lives"] for one in log if one["event"] == "worker ended"] == [1, 2, 3, 4, 5]


def test_no_fork_beside_a_thread_or_without_fork(monkeypatch: pytest.MonkeyPatch) -> None:
    """A worker would have the thread's locks, and not the thread."""
    stop = threading.Event()
    thread = threading.Thread(target=stop.wait)
    thread.start()
    try:
        with pytest.raises(RuntimeError, match="a thread runs already"):
            Workers(1, Journal(2), Supervised(None, {})).run()
    finally:
        stop.set()
        thread.join()
    monkeypatch.delattr(os, "fork")
    with pytest.raises(InputError, match=r"^--processes needs a system that can fork \(Linux, macOS\); start"):
        Workers(1, Journal(2), Supervised(None, {}))
