"""Runs the shards of a campaign that are not there yet, in this process or on workers of Dask.

A shard is handed out as text and number, comes back as bytes, and is written by this process. A worker that dies loses the shard
that it runs, which another one runs again; this process, if it dies, loses those that are under way.
"""

from __future__ import annotations

import logging
import os
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field
from itertools import islice
from pathlib import Path
from typing import Any

from safeloc.campaign import uninterrupted
from safeloc.campaign.counted import wrong_cycles
from safeloc.campaign.declaration import Campaign
from safeloc.campaign.shards import digests, made_by, run_shard, shard_files, write_shard
from safeloc.errors import EngineError, InputError

_AHEAD = 2
"""Shards handed out for each thread of the workers: one runs, one waits, so that no worker waits for this process."""
CORES = os.cpu_count() or 1
"""Cores of this computer."""
_PATIENCE_S = 20.0
"""Time without a result after which it is asked whether there are workers."""
ASKED = 10
"""Times in a row without any worker after which local ones are started anew; a killed one starts again by itself before."""
_ATTEMPTS = 1_000
"""Workers that may die with one shard before it is given up; a worker killed now and then is no fault of the shard."""


_STARTS = 5
"""Attempts to start the local workers."""


@dataclass(frozen=True)
class Where:
    """The place where shards run: this process, local worker processes, or a cluster whose scheduler has an address."""

    workers: int = 1
    in_process: bool = False
    scheduler: str | None = None


@dataclass
class Progress:
    """The progress of a campaign; shards of an earlier run count as done, but not in the time.

    starting  the shards that are not counted in the pace: with the first one of each process its machine is compiled
    """

    shards: int
    done: int
    cycles: int = 0
    kept_wrong: int = 0
    broken_wrong: int = 0
    damaged: int = 0
    ran: int = 0
    starting: int = 1
    began: float = field(default_factory=time.monotonic)

    def one_more(self, cycles: int, kept_wrong: int, broken_wrong: int) -> None:
        """Count a shard that was run."""
        self.done, self.ran, self.cycles = self.done + 1, self.ran + 1, self.cycles + cycles
        self.kept_wrong, self.broken_wrong = self.kept_wrong + kept_wrong, self.broken_wrong + broken_wrong
        if self.ran <= self.starting:
            self.began = time.monotonic()

    @property
    def seconds_left(self) -> float | None:
        """The time left at the pace so far; None before there is one."""
        if self.ran <= self.starting:
            return None
        return (time.monotonic() - self.began) / (self.ran - self.starting) * (self.shards - self.done)


Tell = Callable[[Progress], None]


def run_missing(campaign: Campaign, folder: Path, where: Where, tell: Tell, *, discard: bool = False) -> Progress:
    """Run every shard that is not in the folder, or damaged.

    discard  delete shards that are not of this campaign (of another declaration, safeloc or numpy), in place of the InputError
             that says how many there are
    """
    wanted = digests(campaign)
    _without_strange(folder, wanted, discard=discard)
    left, damaged = _left(folder, wanted)
    first_of = {shard.number: shard.first for shard in campaign.shards}
    left.sort(
        key=lambda number: (first_of[number], number)
    )  # each stratum in turn: what is done so far speaks of all of them
    processes = 1 if where.in_process else where.workers
    progress = Progress(len(wanted), len(wanted) - len(left), damaged=damaged, starting=processes)
    tell(progress)
    cycles_of = {shard.number: (shard.end - shard.first) * campaign.declared.cycles for shard in campaign.shards}
    for number, data in _results(campaign, left, where):
        write_shard(folder, number, wanted[number], data)
        progress.one_more(cycles_of[number], *wrong_cycles(data))
        tell(progress)
    return progress


def _without_strange(folder: Path, wanted: Mapping[int, str], *, discard: bool) -> None:
    """Delete the shards that are not of this campaign. InputError if that was not asked for: hours may be in them."""
    strange = [file for file in shard_files(folder) if wanted.get(file.number) != file.digest]
    if strange and not discard:
        raise InputError(
            f"{folder}: {len(strange)} shards are not of this campaign as it is: it was edited, or safeloc, numpy, pyarrow or the kind of "
            "processor is another one. Give another folder, or delete these shards with --discard."
        )
    for file in strange:
        file.path.unlink()


def _left(folder: Path, wanted: Mapping[int, str]) -> tuple[list[int], int]:
    """Return the numbers of the shards to run, and how many files were damaged, which are deleted."""
    left, damaged = dict(wanted), 0
    for file in shard_files(folder):
        if file.sound:
            left.pop(file.number, None)
        else:
            damaged += 1
            file.path.unlink()
    return sorted(left), damaged


def _results(campaign: Campaign, left: Sequence[int], where: Where) -> Iterator[tuple[int, bytes]]:
    if where.in_process or not left:
        yield from ((number, run_shard(campaign.text, campaign.name, number)) for number in left)
    else:
        with _client(where) as (client, revive):
            yield from _on_workers(client, revive, campaign, left, CORES if where.scheduler is None else None)


def _on_workers(
    client: Any, revive: Callable[[], None], campaign: Campaign, left: Sequence[int], cores: int | None
) -> Iterator[tuple[int, bytes]]:
    """Yield the shards as they are done; only a few are handed out at once, so that the scheduler stays small.

    cores  the cores that all workers share; None if they run elsewhere
    """
    _, distributed = dask_modules()

    def handed_out(number: int) -> Any:
        return client.submit(numbered, campaign.text, campaign.name, number, made_by(), pure=False)

    waiting = iter(left)
    threads = max(1, sum(client.nthreads().values()))
    running = {handed_out(number) for number in islice(waiting, handed_out_at_once(threads, cores))}
    while running:
        try:
            done, running = distributed.wait(running, timeout=_PATIENCE_S, return_when="FIRST_COMPLETED")
        except TimeoutError:
            revive()
            continue
        for future in done:
            yield future.result()
            running |= {handed_out(number) for number in islice(waiting, 1)}


_UNWATCHED: Mapping[str, Any] = {
    "distributed.worker.profile.enabled": False,
    "distributed.admin.tick.interval": "1s",
    "distributed.admin.system-monitor.interval": "10s",
}
"""What Dask measures of its own processes, 50 and 100 times a second: nobody reads it here, and it takes part of a core."""


def handed_out_at_once(threads: int, cores: int | None) -> int:
    """Return how many shards the workers have at a time.

    More workers than cores take turns, a shard each, and one waits: shards that run side by side on one core drive each other
    out of its caches.
    """
    return _AHEAD * threads if cores is None or threads <= cores else cores + 1


_ENVIRONMENT = "distributed.nanny.pre-spawn-environ"
_TRIM = "MALLOC_TRIM_THRESHOLD_"
"""Dask lets workers return each freed page of memory at once; arrays of every cycle then take new pages, and a third of the time."""


def numbered(text: str, name: str, number: int, by: str) -> tuple[int, bytes]:
    """Run a shard on a worker; EngineError if it would be another one there, as on a worker that came later with other packages."""
    if made_by() != by:
        raise EngineError(f"a worker has {made_by()}, this process {by}; install the same everywhere.")
    return number, run_shard(text, name, number)


def dask_modules() -> tuple[Any, Any]:
    """Return the settings of Dask, and its scheduling of several computers. InputError without Dask."""
    try:
        import dask.config
        import distributed
    except ImportError as error:
        raise InputError("workers need Dask: install safeloc[campaign], or run with --in-process.") from error
    return dask.config, distributed


@contextmanager
def _client(where: Where) -> Iterator[tuple[Any, Callable[[], None]]]:
    """Yield a client of the cluster, or of local workers that end with it; and what starts workers that are gone for good.

    InputError without Dask, or without the scheduler.
    """
    config, distributed = dask_modules()
    logging.getLogger("distributed").setLevel(logging.CRITICAL)
    settings = {
        **_UNWATCHED,
        "distributed.scheduler.allowed-failures": _ATTEMPTS,
        "distributed.deploy.lost-worker-timeout": "1 hour",  # a killed worker starts again by itself, on a busy computer slowly
        _ENVIRONMENT: {name: value for name, value in config.get(_ENVIRONMENT).items() if name != _TRIM},
    }
    with config.set(settings):
        if where.scheduler is not None:
            try:
                client = distributed.Client(where.scheduler, timeout="20s")
            except (OSError, ValueError) as error:
                raise InputError(f"--scheduler {where.scheduler}: no scheduler answers there: {error}.") from error
            with client:
                refuse_others(client)
                yield client, lambda: None
        else:
            with local_cluster(distributed, where.workers) as cluster, distributed.Client(cluster) as client:
                yield client, Revival(client, cluster, where.workers)


def local_cluster(distributed: Any, workers: int) -> Any:
    """Return local workers, started again if one is killed while it starts; EngineError if they never start."""
    why: Exception | None = None
    for _ in range(_STARTS):
        try:
            return distributed.LocalCluster(
                n_workers=workers,
                threads_per_worker=1,
                dashboard_address=None,
                scheduler_kwargs={"dashboard_address": "127.0.0.1:0"},  # its status page, where no other one is
                memory_limit=0,
                silence_logs=logging.CRITICAL,
                preload=[uninterrupted.__name__],
            )
        except RuntimeError as error:
            why = error
    raise EngineError(f"{workers} local workers did not start in {_STARTS} attempts: {why} Run with --in-process.")


@dataclass
class Revival:
    """Starts local workers anew where all are gone for good: each call asks whether there is one."""

    client: Any
    cluster: Any
    workers: int
    times: int = 0

    def __call__(self) -> None:
        self.times = 0 if self.client.nthreads() else self.times + 1
        if self.times == ASKED:
            self.times = 0
            self.cluster.scale(0)
            self.cluster.scale(self.workers)


def refuse_others(client: Any) -> None:
    """Refuse workers with other packages or another kind of processor, whose shards would be others."""
    found = client.run(made_by)
    if not found:
        raise InputError("the scheduler has no workers; start some, for example with `dask worker ADDRESS`.")
    strange = [(worker, by) for worker, by in found.items() if by != made_by()]
    if strange:
        worker, by = strange[0]
        raise EngineError(f"worker {worker} has {by}, this process {made_by()}; install the same everywhere.")
