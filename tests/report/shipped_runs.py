"""Shipped recordings as runs, and with a change made to them."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from functools import cache
from pathlib import Path
from typing import TypeVar

from safeloc.catalogue import Target, load_target
from safeloc.proof.verification.replay import run_with_truth
from safeloc.report.recorded_run import RecordedRun
from safeloc.runtime.streams.gzipped import name_of
from safeloc.runtime.streams.steps import Cell, read_steps, write_steps

P = TypeVar("P")
Change = Callable[[int, dict[str, Cell]], Mapping[str, Cell]]


@cache
def shipped(name: str) -> Target:
    """A shipped machine; this process makes it once."""
    return load_target(name)


def recording(machine: str, stem: str) -> Path:
    """The file of a shipped recording."""
    return next(path for path in shipped(machine).streams if name_of(path) == stem)


@cache
def told(machine: str, stem: str) -> RecordedRun:
    """A shipped recording, run once."""
    path = recording(machine, stem)
    trace = run_with_truth(shipped(machine), path)
    assert trace is not None
    truth = [step["truth_mm"] for step in read_steps(path).steps]
    return RecordedRun(stem, trace, tuple(place for place in truth if isinstance(place, int)))


def changed(machine: str, stem: str, folder: Path, change: Change) -> Path:
    """A copy of a recording with every step (numbered from 1 on) changed; without ghosts, as a vehicle records."""
    target = shipped(machine)
    ghosts = {var.name for one in target.machines for var in one.world.choices}
    steps = read_steps(recording(machine, stem)).steps
    kept: Sequence[dict[str, Cell]] = [{k: v for k, v in step.items() if k not in ghosts} for step in steps]
    path = folder / f"{stem}.jsonl"
    write_steps(path, [change(number, step) for number, step in enumerate(kept, 1)], machine=machine)
    return path


def picture(machine: str, kind: type[P]) -> P:
    """The picture of a kind that a shipped machine declares."""
    return next(one for one in shipped(machine).pictures if isinstance(one, kind))


def with_streams(machine: str, *paths: Path) -> Target:
    """A shipped machine with other recordings."""
    return replace(shipped(machine), streams=paths)
