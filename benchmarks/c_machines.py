"""Shipped machines in generated C: steps a second over drawn rows, by size: python -m benchmarks.c_machines [names]

Rows are taken with their check and without outputs. All inputs come and go at random, as they seldom do in service.
"""

from __future__ import annotations

import sys
import tempfile
import time
from pathlib import Path

from safeloc.codegen.c_loader import load_c
from safeloc.language.system import TransitionSystem, without_ghosts
from safeloc.proof.drawn_runs.sampled import drawn_run
from safeloc.shipped_machines import ENTRIES

STEPS, TIMES, ROUNDS = 100, 20, 20


def speed(system: TransitionSystem, folder: Path) -> float:
    """Steps a second of processor time, best of all rounds."""
    drawn = drawn_run(system, 0, STEPS, lawful=False)
    machine = load_c(system, folder=folder, first=drawn.first)
    rows, first = machine.rows([*drawn.steps] * TIMES), machine.save()
    best = 0.0
    for _ in range(ROUNDS):
        machine.restore(first)
        begin = time.process_time()
        machine.run(rows)
        best = max(best, len(rows) / (time.process_time() - begin))
    return best


def main() -> None:
    """Measures and prints."""
    print(f"{'':20} {'state':>5} {'inputs':>6} {'steps/s':>12}")
    with tempfile.TemporaryDirectory() as folder:
        for name in sys.argv[1:] or ENTRIES:
            system = without_ghosts(ENTRIES[name].make(ENTRIES[name].config()).system)
            found = speed(system, Path(folder))
            print(f"{name:20} {len(system.state):5} {len(system.inputs):6} {found:12,.0f}", flush=True)


if __name__ == "__main__":
    main()
