"""What is saved by what earlier runs found.

`python -m benchmarks.bench_cache [MACHINE ...]`: for each machine (three small ones without any) processor seconds of `verify`
with nothing kept, with nothing changed, and after one random edit of its declaration with what the unedited run left; the
last two as ratios to the first, with the change that was made. `--edits N` makes so many edits and tells their median.
"""

from __future__ import annotations

import argparse
import random
import resource
import tempfile
from collections.abc import Sequence
from pathlib import Path
from statistics import median

from tests.edits.checkout import Checkout, edited
from tests.edits.judge import Case, edit_of

SMALL = ("stop_point", "balise", "axle_counter")


def main(arguments: Sequence[str] | None = None) -> None:
    """Print one line a machine."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.bench_cache", description=__doc__)
    parser.add_argument("machines", nargs="*", default=list(SMALL))
    parser.add_argument("--edits", type=int, default=1)
    asked = parser.parse_args(arguments)
    print(f"{'machine':<20} {'cold s':>7} {'unchanged':>9} {'one edit':>9}  last edit")
    with tempfile.TemporaryDirectory() as place:
        checkout = Checkout(Path(place, "checkout"))
        for number, name in enumerate(asked.machines):
            cache = Path(place, f"cache-{number}")
            cold, unchanged = _seconds(checkout, name, cache), _seconds(checkout, name, cache)
            ratios, told = list[float](), ""
            for turn in range(asked.edits):
                path, edit = edit_of(checkout, Case(turn, "machine", name), random.Random(f"{name} {turn}"))
                with edited(path, edit.made(path.read_text(encoding="utf-8"))):
                    ratios.append(_seconds(checkout, name, cache) / cold)
                told = f"{path.name}:{edit.line} {edit.before.strip()} -> {edit.after.strip()}"
            print(f"{name:<20} {cold:>7.1f} {unchanged / cold:>9.2f} {median(ratios):>9.2f}  {told}", flush=True)


def _seconds(checkout: Checkout, machine: str, cache: Path) -> float:
    """Processor seconds of one run."""
    before = processor_s()
    checkout.verified(machine, cache)
    return processor_s() - before


def processor_s() -> float:
    """Return the processor time of all ended processes that this one has started, user and system."""
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


if __name__ == "__main__":
    main()
