"""Storage of a campaign's findings: vehicles with a wrong interval, and those with the smallest margins, as streams with
the truth, shortened, and as a regression test.
"""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from safeloc.campaign.aggregate import Results
from safeloc.campaign.declaration import Campaign, Shard
from safeloc.campaign.regression import NAME, regression_test
from safeloc.campaign.scenes import Scene, drawn_runs, scene_of
from safeloc.campaign.shards import judge_of_target
from safeloc.campaign.shortened import messages_of, shortened
from safeloc.language.nodes import Value
from safeloc.language.trace import present_inputs
from safeloc.runtime.streams.steps import write_steps
from safeloc.simulation.many_runs import Drawn, ManyRuns, through_border

_STREAMS = "streams"
AFTER = 20
"""Cycles that a kept stream goes on after the cycle for which it is kept."""
_NEAR = "near"
KINDS: Mapping[str, tuple[str, str, str]] = {
    "kept-wrong": ("kept_wrong > 0", "first_wrong", "a wrong interval although every law was kept"),
    "broken-wrong": ("broken_wrong > 0", "longest_wrong desc", "a wrong interval after a law was broken"),
    _NEAR: (
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


def keep_streams(
    campaign: Campaign, results: Results, folder: Path
) -> tuple[list[dict[str, Any]], list[dict[str, Any]]]:
    """Write the streams, and the configurations that they need, into the folder; return what was found of each kind, and what was
    kept, each with its command.

    Of wrong intervals the worst vehicle of each situation is kept, however many situations there are.
    """
    place = folder / _STREAMS
    place.mkdir(parents=True, exist_ok=True)
    for old in place.iterdir():
        if old.is_file():  # not the folder that Python leaves where the regression test was run
            old.unlink()
    wanted: dict[int, list[_Wanted]] = {}
    found = []
    for kind, (where, order, why) in KINDS.items():
        vehicles, strata = results.vehicles(where)
        most = campaign.declared.kept and max(campaign.declared.kept, 0 if kind == _NEAR else strata)
        some = list(results.worst(where, order, most))
        found.append({"kind": kind, "why": why, "vehicles": vehicles, "kept": len(some)})
        for shard, vehicle, cycle in some:
            wanted.setdefault(shard, []).append(_Wanted(kind, vehicle, cycle))
    shards = campaign.shards
    kept = [
        entry for number, some in sorted(wanted.items()) for entry in _of_shard(campaign, shards[number], some, place)
    ]
    if kept:
        target = scene_of(campaign, campaign.strata[0]).target
        (place / NAME).write_text(regression_test(target, kept, place), encoding="utf-8")
    return found, kept


def _of_shard(campaign: Campaign, shard: Shard, some: list[_Wanted], place: Path) -> Iterator[dict[str, Any]]:
    scene, drawn, runs = drawn_runs(campaign, shard)
    config, judge = _config(scene, shard, place), judge_of_target(scene.target)
    for one in some:
        column = one.vehicle - shard.first
        path = place / f"{one.kind}-{shard.number:06}-{one.vehicle}.jsonl.gz"
        run = _alone(scene, runs, column, one.cycle + 1 + AFTER)
        short = shortened(judge, run, one.cycle)
        steps, first = _stream(scene, short)
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
            "messages": messages_of(scene.target.system, run),
            "messages_left": messages_of(scene.target.system, short),
            "file": str(path),
            "config": None if config is None else str(config),
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


def _alone(scene: Scene, runs: ManyRuns, column: int, cycles: int) -> ManyRuns:
    """Return the run of one vehicle, up to so many cycles, as the border on board passes it on."""
    one = {name: values[:cycles, column : column + 1] for name, values in runs.inputs.items()}
    first = {
        name: value if isinstance(value, int) else np.asarray(value)[column : column + 1]
        for name, value in runs.first.items()
    }
    return ManyRuns(through_border(scene.target.system, one)[0], first)


def _stream(scene: Scene, run: ManyRuns) -> tuple[list[dict[str, Value]], dict[str, Value]]:
    """Return the inputs of one vehicle, ghosts included, and the first values of open variables."""
    system = scene.target.system
    lists = {var.name: run.inputs[var.name][:, 0].tolist() for var in system.inputs}
    steps = [
        present_inputs(system, {name: values[cycle] for name, values in lists.items()})
        for cycle in range(len(next(iter(lists.values()))))
    ]
    return steps, {name: value if isinstance(value, int) else value[0].item() for name, value in run.first.items()}
