"""Named runs that were worked out by hand or drawn from a seed: their steps, and the expected outcome in words.

Some of them ship as recordings of a machine, in the folder `recordings` beside the file that makes them. The others are
made when they are needed.
"""

from __future__ import annotations

import sys
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Generic, TypeVar

from safeloc.language.nodes import Value
from safeloc.runtime.streams.steps import Cell, write_steps

Config_ = TypeVar("Config_", contravariant=True)
Steps = list[dict[str, Cell]]


@dataclass(frozen=True)
class WorkedRun(Generic[Config_]):
    """A named run: its expected outcome in words, its steps for a given configuration, and first values of open state variables."""

    outcome: str
    steps: Callable[[Config_], Sequence[Mapping[str, Cell]]]
    first: Mapping[str, Value] = field(default_factory=dict)


def write_runs(
    folder: Path, runs: Mapping[str, WorkedRun[Config_]], config: Config_, *, short: bool = False
) -> list[Path]:
    """Write each run as a recording of the machine with which its name begins, `MACHINE-what-happens`; return the paths.

    short  leave out, in each step, what is as in the step before
    """
    paths = [folder / f"{name}.jsonl.gz" for name in runs]
    for path, (name, run) in zip(paths, runs.items(), strict=True):
        write_steps(path, run.steps(config), machine=name.partition("-")[0], first=run.first, short=short)
    return paths


def write_named(
    made_by: str,
    shipped: Mapping[str, WorkedRun[Config_]],
    on_demand: Mapping[str, WorkedRun[Config_]],
    config: Config_,
) -> None:
    """Write the runs that ship where they stand, or those made on demand into the folder that the command line names.

    made_by  the file that declares the runs, `__file__`
    """
    if sys.argv[1:] and not on_demand:
        sys.exit("All named runs of this machine ship; without a folder they are written where they stand.")
    paths = (
        write_runs(Path(sys.argv[1]), on_demand, config)
        if sys.argv[1:]
        else write_runs(Path(made_by).with_name("recordings"), shipped, config)
    )
    print(*paths, sep="\n")
