"""How long `safeloc verify` of all machines takes after one edit of one machine.

`python -m benchmarks.one_edit --out FILE`: once with nothing kept, then after each of 50 random edits, spread over all machines,
with what the unedited run left, in the folder FILE.cache. A line of FILE a run; started again with the same FILE it goes on where it was,
as long as the code is the same. Edits come in random order, so that those of a run that is ended early are spread over all machines too. A
run after an edit that takes longer than `--most` of the run with nothing kept is ended, and counts as that long: so many claims of a
large machine may fail that each takes its limits. A median below that share is the same. At the end: medians of the clock
and of processor time, as shares of the run with nothing kept.
"""

from __future__ import annotations

import argparse
import math
import random
import shutil
import tempfile
import time
from collections import Counter
from collections.abc import Mapping, Sequence
from pathlib import Path
from statistics import median
from typing import Any

from benchmarks.bench_cache import processor_s
from safeloc.catalogue import ENTRIES
from tests.edits.checkout import MOST_SECONDS_OF_ALL, Checkout, edited
from tests.edits.judge import Case, edit_of
from tests.kept_lines import keep, kept_lines

COLD = -1
"""Number of the run with nothing kept."""


def main(arguments: Sequence[str] | None = None) -> None:
    """Print one line a run, and the medians."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.one_edit", description=__doc__)
    parser.add_argument("--edits", type=int, default=50)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--most", type=float, default=0.4, help="share of the clock of the run with nothing kept")
    parser.add_argument("--out", type=Path, required=True)
    asked = parser.parse_args(arguments)
    with tempfile.TemporaryDirectory() as place:
        checkout = Checkout(Path(place, "checkout"))
        checkout.compile()
        _measure(checkout, asked)
    print(*medians([line for line in kept_lines(asked.out) if line["number"] < asked.edits]), sep="\n")


def _measure(checkout: Checkout, asked: argparse.Namespace) -> None:
    """Make the runs of which FILE has no line."""
    cache = Path(f"{asked.out}.cache")
    lines = {line["number"]: line for line in kept_lines(asked.out)}
    if COLD not in lines:
        shutil.rmtree(cache, ignore_errors=True)
        lines[COLD] = {"number": COLD, **_timed(checkout, cache, MOST_SECONDS_OF_ALL)}
        _keep(asked.out, lines[COLD])
    most_s = asked.most * lines[COLD]["clock_s"]
    order = random.Random(asked.seed).sample(range(asked.edits), asked.edits)
    for number in (one for one in order if one not in lines):
        _keep(asked.out, {"number": number, **_after_edit(checkout, cache, number, asked.seed, most_s)})


def _after_edit(checkout: Checkout, cache: Path, number: int, seed: int, most_s: float) -> dict[str, Any]:
    """Time one edit; what its run keeps is no help to the next one."""
    name = list(ENTRIES)[number % len(ENTRIES)]
    path, edit = edit_of(checkout, Case(number, "machine", name), random.Random(f"{seed} {number}"))
    change = f"{path.name}:{edit.line} {edit.before.strip()} -> {edit.after.strip()}"
    own = cache.with_name(f"{cache.name}.own")
    shutil.rmtree(own, ignore_errors=True)
    shutil.copytree(cache, own, copy_function=_linked)
    try:
        with edited(path, edit.made(path.read_text(encoding="utf-8"))):
            return {"machine": name, "change": change, **_timed(checkout, own, most_s)}
    finally:
        shutil.rmtree(own)


def _linked(source: str, target: str) -> None:
    """Link in place of a copy: files of the cache are never changed, only replaced."""
    Path(target).hardlink_to(source)


def _timed(checkout: Checkout, cache: Path, most_s: float) -> dict[str, Any]:
    clock, used = time.monotonic(), processor_s()
    ran = checkout.all_verified(cache, seconds=most_s)
    seconds = {"clock_s": round(time.monotonic() - clock, 1), "processor_s": round(processor_s() - used, 1)}
    anew = sorted({name.partition("/")[0] for name in ran.verdicts} - ran.kept)
    return {**seconds, "code": ran.code, "verdicts": Counter(ran.verdicts.values()), "anew": anew, "error": ran.error}


def _keep(out: Path, line: Mapping[str, Any]) -> None:
    keep(out, dict(line))
    of = f"{line['machine']}, {line['change']}" if "machine" in line else "nothing kept"
    what = dict(line["verdicts"]) or line["error"]
    print(f"{of}: {line['clock_s']} s, {line['processor_s']} s of processor, {what}", flush=True)


def medians(lines: Sequence[Mapping[str, Any]]) -> list[str]:
    """Return a line for the clock and one for the processor: cold, after an edit (median), and the share; s."""
    [cold] = [line for line in lines if line["number"] == COLD]
    edits = [line for line in lines if line["number"] != COLD]
    if not edits:
        return ["no edits"]
    return [_of_all(what, cold, edits) for what in ("clock_s", "processor_s")]


def _of_all(what: str, cold: Mapping[str, Any], edits: Sequence[Mapping[str, Any]]) -> str:
    """Return the line of one kind of seconds; runs that were ended count as longer than all others."""
    ended = sum(line["code"] < 0 for line in edits)
    of_all = median(math.inf if line["code"] < 0 else line[what] for line in edits)
    if of_all == math.inf:
        return f"{what}: {cold[what]} cold, no median, since {ended} of {len(edits)} were ended"
    number = f"{len(edits)}, {ended} ended" if ended else f"{len(edits)}"
    return f"{what}: {cold[what]} cold, {of_all:.1f} after an edit (median of {number}), {of_all / cold[what]:.2f}"


if __name__ == "__main__":
    main()
