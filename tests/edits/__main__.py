"""The long run: python -m tests.edits --edits 200 --seed 1 --out FILE

Of 200 edits 10 are of the localizer, 20 of the engine, the others of the machines in turn. One line of FILE an edit; started
again with the same FILE, it goes on where it was ended. The last line of output is `N passed, N failed`.
"""

from __future__ import annotations

import argparse
import sys
import tempfile
from collections.abc import Sequence
from itertools import cycle
from pathlib import Path
from statistics import median

from safeloc.catalogue import ENTRIES
from tests.edits.checkout import Checkout
from tests.edits.judge import Case, judged
from tests.kept_lines import keep, kept_lines

LARGE = ("localizer", "localizer_sections")
QUICK = ("emitter", "axle_head", "travel_direction", "delocalized", "axle_section")
"""Machines that an edited engine is tried on."""


def cases(edits: int) -> list[Case]:
    """Which machine is edited when: a twentieth the localizer, a tenth the engine."""
    others, made = cycle(name for name in ENTRIES if name not in LARGE), list[Case]()
    for number in range(edits):
        if number % 20 == 10:
            made.append(Case(number, "machine", LARGE[0]))
        elif number % 10 == 5:
            made.append(Case(number, "engine", QUICK[number // 10 % len(QUICK)]))
        else:
            made.append(Case(number, "machine", next(others)))
    return made


def main(arguments: Sequence[str] | None = None) -> int:
    """The exit code."""
    parser = argparse.ArgumentParser(prog="python -m tests.edits", description=__doc__)
    parser.add_argument("--edits", type=int, default=200)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--out", type=Path, required=True, help="a line an edit; read again to go on")
    asked = parser.parse_args(arguments)
    done = {line["case"]["number"]: line for line in kept_lines(asked.out) if line["seed"] == asked.seed}
    with tempfile.TemporaryDirectory() as folder:
        checkout, cache = Checkout(Path(folder, "checkout")), Path(folder, "cache")
        for case in cases(asked.edits):
            if case.number not in done:
                line = {"seed": asked.seed, **judged(checkout, cache, case, asked.seed).data()}
                keep(asked.out, line)
                done[case.number] = line
                print(
                    f"{len(done)} of {asked.edits}: {case.machine}, {line['where']}, {line['wrong'] or 'the same'}",
                    flush=True,
                )
    return _closing([done[case.number] for case in cases(asked.edits)])


def _closing(lines: Sequence[dict[str, object]]) -> int:
    wrong = [line for line in lines if line["wrong"]]
    for line in wrong:
        print(f"{line['where']} ({line['change']}): {line['wrong']}")
    ratios = [float(str(line["warm_seconds"])) / max(0.1, float(str(line["cold_seconds"]))) for line in lines]
    undecided = sum(bool(line["undecided"]) for line in lines)
    print(
        f"{undecided} with something undecided; warm against cold, median: {median(ratios):.2f}"
        if lines
        else "no edits"
    )
    print(f"{len(lines) - len(wrong)} passed, {len(wrong)} failed")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
