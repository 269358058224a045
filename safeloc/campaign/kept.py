"""Storage of a campaign's findings: vehicles with a wrong interval, and those with the smallest margins, as streams with
the truth.
"""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from safeloc.campaign.aggregate import Results
from safeloc.campaign.declaration import Campaign, Shard
from safeloc.campaign.scenes import Scene, drawn_runs
from safeloc.language.nodes import Value
from safeloc.language.trace import present_inputs
from safeloc.runtime.streams.steps import write_steps
from safeloc.simulation.many_runs import Drawn, ManyRuns, through_border

_STREAMS = "streams"
AFTER = 20
"""Cycles that a kept stream goes on after the cycle for which it is kept."""
KINDS: Mapping[str, tuple[str, str, str]] = {
    "kept-wrong": ("kept_wrong > 0", "first_wrong", "a wrong interval although every law was kept"),
    "broken-wrong": ("broken_wrong > 0", "longest_wrong desc", "a wrong interval after a law was broken"),
    "near": (
        "kept_wrong + broken_wrong = 0 and least_margin_nm is not null",
        "least_margin_nm",
        "no wrong interval; the smallest margins",
    ),
}
"""Kind -> which vehicles, in which order, and why."""


@dataclass(frozen=True)
class _Wanted:
    kind: str
    vehicle: int
    cycle: int


def keep_streams(campaign: Campaign, results: Results, folder: Path) -> list[dict[str, Any]]:
    """Write the streams, and the configurations that they need, into the folder; return what was kept, each with its command."""
    place = folder / _STREAMS
    place.mkdir(parents=True, exist_ok=True)
    for old in place.iterdir():
        old.unlink()
    wanted: dict[int, list[_Wanted]] = {}
    for kind, (where, order, _) in KINDS.items():
        for shard, vehicle, cycle in results.worst(where, order, campaign.declared.kept):
            wanted.setdefault(shard, []).append(_Wanted(kind, vehicle, cycle))
    shards = campaign.shards
    return [
        entry for number, some in sorted(wanted.items()) for entry in _of_shard(campaign, shards[number], some, place)
    ]


def _of_shard(campaign: Campaign, shard: Shard, some: list[_Wanted], place: Path) -> Iterator[dict[str, Any]]:
    scene, drawn, runs = drawn_runs(campaign, shard)
    config = _config(scene, shard, place)
    for one in some:
        column = one.vehicle - shard.first
        path = place / f"{one.kind}-{shard.number:06}-{one.vehicle}.jsonl.gz"
        steps, first = _stream(scene, runs, column, one.cycle + 1 + AFTER)
        write_steps(path, steps, machine=scene.target.name, first=first)
        with_config = f" --config {config}" if config else ""
        yield {
            "kind": one.kind,
            "why": KINDS[one.kind][2],
            "stratum": campaign.words_of(shard.stratum),
            "shard": shard.number,
            "vehicle": one.vehicle,
            "cycle": one.cycle + 1,
            "drawn": _drawn(drawn, column),
            "file": str(path),
            "command": f"safeloc replay {scene.target.spec or scene.target.name} {path}{with_config}",
        }


def _drawn(drawn: Drawn, column: int) -> dict[str, Any]:
    figures = {name: float(values[column]) for name, values in drawn.figures.items()}
    return {"figures": figures, "faults": [str(fault) for fault in drawn.faults[column]]}


def _config(scene: Scene, shard: Shard, place: Path) -> Path | None:
    """Write the configuration of a machine that has not its defaults; return the file."""
    config = scene.target.config
    if config is None or config == type(config)():
        return None
    path = place / f"config-{shard.stratum.number}.json"
    path.write_text(json.dumps(config.model_dump(mode="json"), indent=2) + "\n", encoding="utf-8")
    return path


def _stream(scene: Scene, runs: ManyRuns, column: int, cycles: int) -> tuple[list[dict[str, Value]], dict[str, Value]]:
    """Return the inputs of one vehicle, ghosts included, up to so many cycles, and the first values of open variables."""
    system = scene.target.system
    one = {name: values[:cycles, column : column + 1] for name, values in runs.inputs.items()}
    admitted, _ = through_border(system, one)
    names = [var.name for var in system.inputs]
    length = len(next(iter(admitted.values())))
    steps = [
        present_inputs(system, {name: admitted[name][cycle, 0].item() for name in names}) for cycle in range(length)
    ]
    first = {name: value if isinstance(value, int) else value[column].item() for name, value in runs.first.items()}
    return steps, first
