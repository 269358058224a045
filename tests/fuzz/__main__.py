"""The long run: python -m tests.fuzz --machines 20000 --compositions 1000 --seed 1 --out FILE

One line of FILE a case; started again with the same FILE, it goes on where it was ended. The last line of output is
`N passed, N failed`; the exit code is 1 where a case failed.
"""

from __future__ import annotations

import argparse
import multiprocessing
import sys
import time
import traceback
from collections.abc import Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path

from tests.fuzz.cases import KINDS, Plan
from tests.fuzz.expect import NOW, OPEN
from tests.fuzz.tally import TRAPS, Tally, tally, total
from tests.kept_lines import keep, kept_lines

Task = tuple[str, int, int, frozenset[str]]
SHOWN_EVERY = 50
DETAIL = 1500  # letters of a disagreement


def main(arguments: Sequence[str] | None = None) -> int:
    """The exit code."""
    asked = _arguments(arguments)
    traps = TRAPS - set(asked.without) - (OPEN if asked.mended_only else frozenset())
    if asked.only:
        traps = frozenset(asked.only)
    tasks = _tasks(asked, traps)
    done = _done(asked.out, asked.seed)
    left = [task for task in tasks if (task[0], task[2]) not in done]
    print(f"{len(tasks)} cases, {len(tasks) - len(left)} of them in {asked.out}", flush=True)
    found = {(task[0], task[2]): done[task[0], task[2]] for task in tasks if (task[0], task[2]) in done}
    started = time.monotonic()
    for task, one in _run(left, asked.jobs):
        keep(asked.out, {"kind": task[0], "seed": task[1], "number": task[2], **one.data()})
        found[task[0], task[2]] = one
        _progress(task, one, found, len(tasks), started)
    return _closing(found)


def _arguments(arguments: Sequence[str] | None) -> argparse.Namespace:
    parser = argparse.ArgumentParser(prog="python -m tests.fuzz", description=__doc__)
    parser.add_argument("--machines", type=int, default=20000)
    parser.add_argument("--compositions", type=int, default=1000)
    parser.add_argument("--back-ends", type=int, default=2000, help="machines and compositions by all back ends")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--out", type=Path, required=True, help="a line a case; read again to go on")
    parser.add_argument("--jobs", type=int, default=1)
    parser.add_argument("--without", nargs="*", default=[], choices=sorted(TRAPS), help="traps not to draw")
    parser.add_argument("--only", nargs="*", default=[], choices=sorted(TRAPS), help="the only traps to draw")
    parser.add_argument("--mended-only", action="store_true", help="no trap that tests.fuzz.expect calls open")
    return parser.parse_args(arguments)


def _tasks(asked: argparse.Namespace, traps: frozenset[str]) -> list[Task]:
    """Kinds mixed, so that the first hour sees all of them."""
    counts = {"machine": asked.machines, "composition": asked.compositions, "back ends": asked.back_ends}
    tasks = [(kind, asked.seed, number, traps) for kind, count in counts.items() for number in range(count)]
    return sorted(tasks, key=lambda task: (task[2] / counts[task[0]], task[0]))


def _done(file: Path, seed: int) -> dict[tuple[str, int], Tally]:
    """What stands in the file."""
    return {(line["kind"], line["number"]): tally(line) for line in kept_lines(file) if line["seed"] == seed}


def _run(tasks: list[Task], jobs: int) -> Iterator[tuple[Task, Tally]]:
    if jobs == 1:
        yield from ((task, _one(task)) for task in tasks)
        return
    with ProcessPoolExecutor(jobs, multiprocessing.get_context("fork")) as pool:
        yield from zip(tasks, pool.map(_one, tasks), strict=True)


def _one(task: Task) -> Tally:
    """One case; what the fuzzer itself cannot do is a failure as well."""
    kind, seed, number, traps = task
    try:
        return KINDS[kind](seed, number, Plan(traps=traps, expect=NOW))
    except Exception:
        return Tally(wrong=[f"the fuzzer itself: {traceback.format_exc()}"])


def _progress(task: Task, one: Tally, found: dict[tuple[str, int], Tally], count: int, started: float) -> None:
    for complaint in one.wrong:
        print(f"WRONG {task[0]} {task[2]} of seed {task[1]}: {complaint[:DETAIL]}", flush=True)
    if len(found) % SHOWN_EVERY == 0:
        failed = sum(bool(each.wrong) for each in found.values())
        seconds = time.monotonic() - started
        print(f"{len(found)} of {count} cases, {failed} failed, {seconds:.0f} s", flush=True)


def _closing(found: dict[tuple[str, int], Tally]) -> int:
    """The figures, and the last line."""
    all_ = total(found.values())
    print(f"{sum(all_.compared.values())} comparisons, {len(all_.wrong)} disagreements")
    for what, count in sorted(all_.compared.items()):
        print(f"  {what}: {count} compared, {all_.undecided[what]} undecided")
    for trap, count in sorted(all_.refused.items()):
        print(f"  refused, rightly: {trap}: {count}")
    failed = sum(bool(one.wrong) for one in found.values())
    print(f"{len(found) - failed} passed, {failed} failed")
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
