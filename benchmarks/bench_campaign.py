"""Campaigns: vehicle-cycles a second of one core, and where the time goes; what workers add.

python -m benchmarks.bench_campaign            shares of simulation, machine and counting, for three machines
python -m benchmarks.bench_campaign workers [SHARDS]    one process against two side by side and 1, 2 and 8 local workers, on the clock; 120 shards
                                                       unless told
python -m benchmarks.bench_campaign caller [SHARDS]     what the process that was called does for a shard: all workers wait for it
python -m benchmarks.bench_campaign killed [SHARDS]     two workers, of which one is killed every 30 s, against two that are let be

Times of the first table are processor time of this process, the best of three shards; the ratio to the machine's own step in C says what the
rest costs.
"""

from __future__ import annotations

import math
import os
import resource
import signal
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from safeloc.campaign.counted import Counted, alert_limit_mm, to_parquet, wrong_cycles
from safeloc.campaign.declaration import Campaign, parse_campaign
from safeloc.campaign.judged import judge_of
from safeloc.campaign.scenes import drawn_runs
from safeloc.campaign.schedule import Progress, Where, dask_modules, local_cluster, run_missing
from safeloc.campaign.shards import run_shard, shard_files, write_shard
from safeloc.errors import EngineError

ON_LINE = """machine = "{machine}"
cycles = 2300
shard_vehicles = {vehicles}
[[lines]]
line = "valley"
[[vehicles]]
vehicle = "desiro-br642"
[[situations]]
name = "no fault"
weight = 1.0
vehicles = {total}
"""
JOURNEY = """machine = "localizer"
cycles = 1500
shard_vehicles = {vehicles}
[[lines]]
line = "main-line"
[[situations]]
name = "no fault"
weight = 1.0
vehicles = {total}
"""
SHARDS = 3
MACHINES = {"odometry": (ON_LINE, 500), "balise": (ON_LINE, 250), "localizer": (JOURNEY, 100)}
"""Declaration, and vehicles of a shard."""


@dataclass(frozen=True)
class Cost:
    """Seconds of processor time of one shard, by what they went into."""

    vehicle_cycles: int
    simulation: float
    machine: float
    counting: float

    @property
    def whole(self) -> float:
        """All of it."""
        return self.simulation + self.machine + self.counting


def declared(machine: str, shards: int) -> Campaign:
    """Return the campaign of a machine with so many shards."""
    text, vehicles = MACHINES[machine]
    return parse_campaign(text.format(machine=machine, vehicles=vehicles, total=vehicles * shards), machine)


def costs(campaign: Campaign) -> Iterator[Cost]:
    """Yield the cost of each shard; the machine is compiled before."""
    judge = judge_of(drawn_runs(campaign, campaign.shards[0])[0].target)
    for shard in campaign.shards:
        began = time.process_time()
        scene, drawn, runs = drawn_runs(campaign, shard)
        simulated = time.process_time()
        outcome = judge.outcome(runs)
        moved = time.process_time()
        limit_mm = alert_limit_mm(campaign, scene.target)
        to_parquet(Counted(shard, judge.clauses, drawn, outcome, limit_mm, 50_000).groups())
        yield Cost(outcome.told.size, simulated - began, moved - simulated, time.process_time() - moved)


def shares() -> None:
    """Print what a shard costs, for each machine."""
    print(
        "| machine | vehicle-cycles a second of a core | simulation | machine and clauses | counting | times the machine's own step |"
    )
    print("|---|---|---|---|---|---|")
    for machine in MACHINES:
        best = min(costs(declared(machine, SHARDS)), key=lambda one: one.whole)
        parts = " | ".join(f"{part / best.whole:.0%}" for part in (best.simulation, best.machine, best.counting))
        print(
            f"| {machine} | {best.vehicle_cycles / best.whole:,.0f} | {parts} | {best.whole / best.machine:.1f} |",
            flush=True,
        )
    print(f"\ngreatest memory of this process: {resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024:.0f} MB")


def workers(shards: int) -> None:
    """Print the time on the clock, the start of the workers included, of one process and of some workers.

    What two processes take that know nothing of each other, each with half of the shards, is the most that two cores give:
    they share memory and caches, also with what else runs on the computer.
    """
    campaign = declared("odometry", shards)
    print("| where | seconds | times as fast as one process |\n|---|---|---|", flush=True)
    one, two = side_by_side(shards, 1), side_by_side(shards, 2)
    print(f"| one process, without Dask | {one:.1f} | 1 |")
    print(f"| two such processes, half of the shards each | {two:.1f} | {one / two:.2f} |", flush=True)
    for number in (1, 2, 8):
        with tempfile.TemporaryDirectory() as folder:
            began = time.monotonic()
            run_missing(campaign, Path(folder), Where(workers=number), lambda _: None)
            taken = time.monotonic() - began
        print(f"| workers: {number} | {taken:.1f} | {one / taken:.2f} |", flush=True)


def caller(shards: int) -> None:
    """Print the processor time that a shard of the localizer takes from the process that was called: to hand it out, take it back, count and write it.

    The worker only returns the bytes, so it is no part of that.
    """
    campaign = declared("localizer", 1)
    data = run_shard(campaign.text, campaign.name, 0)
    _, distributed = dask_modules()
    with (
        tempfile.TemporaryDirectory() as folder,
        local_cluster(distributed, 1) as cluster,
        distributed.Client(cluster) as client,
    ):
        client.submit(len, data, pure=False).result()
        began, clock = time.process_time(), time.monotonic()
        waiting, running = iter(range(shards)), set()
        for _ in range(4):
            running.add(client.submit(bytes, data, pure=False))
        while running:
            done, running = distributed.wait(running, return_when="FIRST_COMPLETED")
            for future in done:
                table = future.result()
                number = next(waiting, None)
                if number is not None:
                    write_shard(Path(folder), number, "0" * 16, table)
                    wrong_cycles(table)
                    running.add(client.submit(bytes, data, pure=False))
        taken, waited = time.process_time() - began, time.monotonic() - clock
    print(
        f"{shards} shards of {len(data) / 1024:.0f} kB: {taken / shards * 1000:.1f} ms of processor time each, {waited / shards * 1000:.1f} ms on the clock"
    )


@dataclass
class Killing:
    """Kills one of the local workers every so often, as shards come in; each in its turn."""

    every_s: float
    last: float
    killed: int = 0

    def __call__(self, _: Progress) -> None:
        """Kill one if it is time."""
        from distributed import get_client  # takes a second to load, and only workers need it

        if time.monotonic() - self.last < self.every_s:
            return
        pids = sorted(get_client().run(os.getpid).values())
        if pids:
            os.kill(pids[self.killed % len(pids)], signal.SIGKILL)
            self.killed, self.last = self.killed + 1, time.monotonic()


def killed(shards: int) -> None:
    """Print the time with and without killed workers, and whether the shards are the same, to the byte. EngineError if not."""
    campaign, names = declared("odometry", shards), []
    print("| workers | killed | seconds |\n|---|---|---|", flush=True)
    for every_s in (math.inf, 30.0):
        with tempfile.TemporaryDirectory() as folder:
            began = time.monotonic()
            killing = Killing(every_s, began)
            run_missing(campaign, Path(folder), Where(workers=2), killing)
            print(f"| 2 | {killing.killed} | {time.monotonic() - began:.1f} |", flush=True)
            names.append({file.path.name for file in shard_files(Path(folder))})
    if names[0] != names[1]:
        raise EngineError("the shards of both runs differ.")
    print(f"\nthe {len(names[0])} shards of both runs are the same, to the byte")


def side_by_side(shards: int, processes: int) -> float:
    """Return the seconds until so many processes have run their parts, each as a campaign of its own in one process."""
    command = [sys.executable, "-m", "benchmarks.bench_campaign", "alone", str(shards // processes)]
    began = time.monotonic()
    for one in [subprocess.Popen(command) for _ in range(processes)]:
        one.wait()
    return time.monotonic() - began


def alone(shards: int) -> None:
    """Run a campaign in this process."""
    with tempfile.TemporaryDirectory() as folder:
        run_missing(declared("odometry", shards), Path(folder), Where(in_process=True), lambda _: None)


def main() -> None:
    """Run what the first word asks for."""
    match sys.argv[1:]:
        case ["workers", *number]:
            workers(int(number[0]) if number else 120)
        case ["caller", *number]:
            caller(int(number[0]) if number else 500)
        case ["killed", *number]:
            killed(int(number[0]) if number else 400)
        case ["alone", number]:
            alone(int(number))
        case _:
            shares()


if __name__ == "__main__":
    main()
