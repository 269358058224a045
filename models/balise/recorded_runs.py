"""Shipped recordings of the balise machine: a service, groups with every kind of fault, and two announced groups missed in a row.

`python -m safeloc.models.balise.recorded_runs` writes them; the tests check that it still writes the same.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from safeloc.models.balise.simulate import Steps, line, simulate
from safeloc.models.balise.variables import BaliseConfig
from safeloc.runtime.streams.steps import write_steps
from safeloc.simulation.faults import Fault
from safeloc.simulation.motion import Leg

FOLDER = Path(__file__).with_name("recordings")


@dataclass(frozen=True)
class Run:
    """A run over groups so far apart, with these of them faulty.

    spacing_mm   0: the default line, along which a random service is driven; else 39 m/s are reached and kept
    """

    seed: int
    seconds: int
    spacing_mm: int = 0
    faults: Sequence[Fault] = ()


RUNS: Mapping[str, Run] = {
    "service": Run(0, 100),
    "faulty-groups": Run(
        5,
        118,
        130_000,
        (
            Fault("missed", 4), Fault("corrupted", 7), Fault("incomplete", 10), Fault("wrong way", 14), Fault("early", 16),
            Fault("late", 19), Fault("duplicate", 22), Fault("stale", 25), Fault("malformed", 28),
        ),
    ),
    "two-missed": Run(6, 45, 100_000, (Fault("missed", 8), Fault("missed", 9))),
}  # fmt: skip
"""By the end of the recording's name."""


def recorded(run: Run) -> Steps:
    """Return the steps of a run."""
    config = BaliseConfig()
    if not run.spacing_mm:
        return simulate(config, seed=run.seed, seconds=run.seconds)
    return simulate(
        config, seed=run.seed, legs=[Leg(39_000, run.seconds)], groups=line(60_000, run.spacing_mm), missed=0,
        faults=run.faults,
    )  # fmt: skip


def write(folder: Path = FOLDER) -> list[Path]:
    """Write all of them; the paths."""
    paths = [folder / f"balise-{name}.jsonl.gz" for name in RUNS]
    for path, run in zip(paths, RUNS.values(), strict=True):
        write_steps(path, recorded(run), machine="balise")
    return paths


if __name__ == "__main__":
    for path in write():
        print(path)
