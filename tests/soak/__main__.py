"""The soak: python -m tests.soak --hours-of-fleet 24 --vehicles 200 --wall-minutes 60 --out FILE

A day of a fleet by its own clock, through a process of its own (`safeloc run odometry --from tcp:0 --snapshot ...`), with what
a day brings: pauses, silences, connections that are lost, damaged lines, kill -9, an orderly restart. Every report is
compared with the truth of the simulated drives. One line of FILE a window; started again with the same FILE and the same
figures, it goes on behind the last one, with vehicles and a process that were switched on just then. The last line of output is
`N passed, N failed`, of the criteria in tests/soak/judge.py; the exit code is 1 where one failed. Linux.
"""

from __future__ import annotations

import argparse
import gc
import sys
from collections.abc import Sequence
from pathlib import Path

from tests.kept_lines import keep, kept_lines
from tests.soak.fleet import Fleet, Plan
from tests.soak.judge import Bounds, judged
from tests.soak.process import Process
from tests.soak.windows import Window, as_line, as_window, at_share


def main(arguments: Sequence[str] | None = None) -> int:
    """The exit code."""
    asked = _arguments(arguments)
    plan = Plan(asked.hours_of_fleet, asked.vehicles, asked.wall_minutes, asked.windows, asked.seed)
    bounds = Bounds(asked.most_growth_mib, asked.most_p99_ms, asked.most_waited)
    done = [as_window(line) for line in kept_lines(asked.out)]
    print(
        f"{plan.windows} windows, {len(done)} of them in {asked.out}; the fleet's clock runs {plan.speed:.1f} times as fast"
    )
    if len(done) < plan.windows:
        done += _go_on(plan, done, asked.out)
    found = list(judged(done, plan.windows, bounds))
    for one in found:
        print(f"{'passed' if one.passed else 'FAILED'}: {one.words}")
    failed = sum(not one.passed for one in found)
    print(f"{len(found) - failed} passed, {failed} failed")
    return 1 if failed else 0


def _arguments(arguments: Sequence[str] | None) -> argparse.Namespace:
    parser = argparse.ArgumentParser(prog="python -m tests.soak", description=__doc__)
    parser.add_argument("--hours-of-fleet", type=float, default=24)
    parser.add_argument("--vehicles", type=int, default=200)
    parser.add_argument("--wall-minutes", type=float, default=60, help="at least; longer where the machine is too slow")
    parser.add_argument("--windows", type=int, default=144)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--out", type=Path, required=True, help="a line a window; read again to go on")
    parser.add_argument("--most-growth-mib", type=float, default=Bounds.growth_mib)
    parser.add_argument("--most-p99-ms", type=float, default=Bounds.p99_ms)
    parser.add_argument("--most-waited", type=float, default=Bounds.waited, help="share of a window without a core")
    return parser.parse_args(arguments)


def _go_on(plan: Plan, done: Sequence[Window], out: Path) -> list[Window]:
    """The windows that are left, each written when it is over."""
    process = Process(out.with_suffix(".process"), done[-1].life if done else 0)
    fleet = Fleet(plan, process, len(done) * plan.window_ms)
    gc.collect()
    gc.freeze()  # the sender's own pauses are not the process's
    made: list[Window] = []
    try:
        for window in fleet.windows(len(done)):
            keep(out, as_line(window))
            made.append(window)
            _progress(window, plan)
    finally:
        process.kill()
    return made


def _progress(window: Window, plan: Plan) -> None:
    print(
        f"window {window.number + 1} of {plan.windows}: {window.reports} reports, {window.located} located, {window.wrong} wrong, "
        f"{window.resident_kib / 1024:.1f} MiB, p99 {at_share([window.latency], 0.99):.2f} ms, {window.wall_s:.1f} s "
        f"{window.ended} {window.first_wrong}".rstrip(),
        flush=True,
    )


if __name__ == "__main__":
    sys.exit(main())
