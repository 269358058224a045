"""A computer of a cluster that vanishes without a word: its shards are run by the others, and every shard is the same."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from subprocess import Popen

import pytest

from safeloc.campaign.declaration import parse_campaign
from safeloc.campaign.schedule import Progress, Where, run_missing
from safeloc.campaign.shards import shard_files
from tests.campaign.declared import SMALL
from tests.free_port import free_port

VANISHED_S = 4
"""After so long without a sign of life the scheduler takes a worker for lost; five minutes where nothing else is configured."""


@contextmanager
def cluster(computers: int) -> Iterator[tuple[str, list[Popen[bytes]]]]:
    """A scheduler, and computers with a worker each, as groups of processes: the scheduler's address, and the computers."""
    address = f"tcp://127.0.0.1:{free_port()}"
    patient = {"DASK_DISTRIBUTED__SCHEDULER__WORKER_TTL": f"{VANISHED_S}s"}
    scheduler = ["scheduler", "--host", "127.0.0.1", "--port", address.rpartition(":")[2], "--no-dashboard"]
    worker = ["worker", address, "--nworkers", "1", "--nthreads", "1", "--no-dashboard"]
    started = [_started(one, patient) for one in (scheduler, *[worker] * computers)]
    try:
        yield address, started[1:]
    finally:
        for one in started:
            os.killpg(one.pid, signal.SIGKILL)
            one.wait()


def _started(arguments: list[str], environment: dict[str, str]) -> Popen[bytes]:
    command = [sys.executable, "-m", "dask", *arguments]
    return Popen(
        command,
        env=os.environ | environment,
        start_new_session=True,
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
    )


@pytest.mark.slow
def test_a_computer_that_vanishes_changes_no_shard(tmp_path: Path) -> None:
    """It stops while it runs a shard, with its connections open, as where the power fails; nobody else runs that shard before it is missed."""
    from distributed import Client  # takes a second to load, and only slow tests need it

    campaign = parse_campaign(SMALL.replace("vehicles = 10", "vehicles = 200"), "small.toml")
    with cluster(2) as (address, computers):
        with Client(address, timeout="60s") as client:
            client.wait_for_workers(2, timeout=120)
        vanished = list[int]()

        def stop(progress: Progress) -> None:
            if progress.ran == 5:
                os.killpg(computers[0].pid, signal.SIGSTOP)
                vanished.append(progress.ran)

        run_missing(campaign, tmp_path / "cluster", Where(scheduler=address), stop)
        os.killpg(computers[0].pid, signal.SIGCONT)
    run_missing(campaign, tmp_path / "here", Where(in_process=True), lambda _: None)
    names = [[file.path.name for file in shard_files(tmp_path / where)] for where in ("cluster", "here")]
    assert vanished == [5]
    assert names[0] == names[1]
    assert 50 == len(names[0])
