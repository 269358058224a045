"""Whether `safeloc verify` decides the same on a busy machine as on an idle one.

`python -m benchmarks.beside_load MACHINE... --out FILE [--runs 20] [--busy 8]`: so many runs with nothing kept and nothing beside them, and
as many beside so many processes that never rest. A line of FILE a run; started again with the same FILE it goes on where it was. At the
end: how many different sets of verdicts there were, what they differ in, and medians of clock and processor time. Exit code 1 if there
was more than one set.
"""

from __future__ import annotations

import argparse
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path
from statistics import median
from typing import Any

from benchmarks.bench_cache import processor_s
from tests.edits.checkout import Checkout
from tests.kept_lines import keep, kept_lines

RESTLESS = "while True: pass"


def main(arguments: Sequence[str] | None = None) -> int:
    """Print one line a run, and what they agree on; return the exit code."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.beside_load", description=__doc__)
    parser.add_argument("machine", nargs="+")
    parser.add_argument("--runs", type=int, default=20)
    parser.add_argument("--busy", type=int, default=8, help="processes beside the second half of the runs")
    parser.add_argument("--out", type=Path, required=True)
    asked = parser.parse_args(arguments)
    done = {(line["beside"], line["number"]) for line in kept_lines(asked.out)}
    with tempfile.TemporaryDirectory() as place:
        checkout = Checkout(Path(place, "checkout"))
        for beside in (0, asked.busy):
            with busy(beside):
                for number in (one for one in range(asked.runs) if (beside, one) not in done):
                    line = {"beside": beside, "number": number, **_run(checkout, asked.machine)}
                    keep(asked.out, line)
                    print(_told(line), flush=True)
    lines = kept_lines(asked.out)
    print(*summed_up(lines), sep="\n")
    return int(len(different_sets(lines)) > 1)


@contextmanager
def busy(processes: int) -> Iterator[Sequence[subprocess.Popen[bytes]]]:
    """Let so many processes run without rest, and end them."""
    running = [subprocess.Popen([sys.executable, "-c", RESTLESS]) for _ in range(processes)]
    try:
        yield running
    finally:
        for one in running:
            one.kill()
            one.wait()


def _run(checkout: Checkout, machines: Sequence[str]) -> dict[str, Any]:
    clock, used = time.monotonic(), processor_s()
    with tempfile.TemporaryDirectory() as cache:
        ran = checkout.all_verified(Path(cache), *machines)
    seconds = {"clock_s": round(time.monotonic() - clock, 1), "processor_s": round(processor_s() - used, 1)}
    return {**seconds, "code": ran.code, "verdicts": dict(ran.verdicts), "error": ran.error}


def _told(line: Mapping[str, Any]) -> str:
    return f"{line['beside']} beside, run {line['number']}: {line['clock_s']} s, {line['processor_s']} s of processor, code {line['code']}, {len(line['verdicts'])} verdicts"


def different_sets(lines: Sequence[Mapping[str, Any]]) -> list[dict[str, str]]:
    """Return the different sets of verdicts, each with its exit code."""
    found: list[dict[str, str]] = []
    for line in lines:
        said = {"exit code": str(line["code"]), **line["verdicts"]}
        if said not in found:
            found.append(said)
    return found


def summed_up(lines: Sequence[Mapping[str, Any]]) -> list[str]:
    """Return the number of different sets, what they differ in, and the medians."""
    different = different_sets(lines)
    told = [f"{len(lines)} runs, {len(different)} different sets of verdicts"]
    for name in sorted(set().union(*different)):
        said = [one.get(name, "no verdict") for one in different]
        if len(set(said)) > 1:
            told.append(f"  {name}: {', '.join(said)}")
    for beside in sorted({line["beside"] for line in lines}):
        own = [line for line in lines if line["beside"] == beside]
        clock, used = (median(line[what] for line in own) for what in ("clock_s", "processor_s"))
        told.append(f"{len(own)} runs with {beside} beside: {clock:.1f} s, {used:.1f} s of processor (medians)")
    return told


if __name__ == "__main__":
    sys.exit(main())
