"""Runs of vehicles over the routes of a line, written into a folder: one stream for each machine, route and vehicle.

`runs.json` lists the streams, each with its configuration, vehicle, seed, route and faults (schema safeloc-line-runs/1).
"""

from __future__ import annotations

import json
import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from safeloc.config import Config
from safeloc.errors import InputError
from safeloc.models.line_runs.configs import LineVehicle
from safeloc.models.line_runs.drive import Journey, Stream, streams
from safeloc.models.line_runs.faults import Asked
from safeloc.models.line_runs.route_choice import Chosen
from safeloc.models.line_runs.ways import balise_groups
from safeloc.railway.map.model import Line, content_checksum
from safeloc.railway.map.walk import Walk
from safeloc.runtime.streams.steps import write_steps

_SCHEMA = "safeloc-line-runs/1"
_BY_GROUPS = ("odometry", "balise")
"""Machines that report nothing after a single group, unless it is trusted without a second one."""


@dataclass(frozen=True)
class Run:
    """One stream with its journey. `label` names vehicle and route in file names, `vehicle_label` the vehicle alone."""

    journey: Journey
    stream: Stream
    label: str
    vehicle_label: str

    @property
    def has_single_group(self) -> bool:
        """True if the machine needs two balise groups for a report, and the route has one or none."""
        return self.stream.machine in _BY_GROUPS and len(balise_groups(self.journey.route)) < 2


def line_runs(
    walk: Walk,
    chosen: Sequence[Chosen],
    vehicles: Sequence[LineVehicle],
    machines: Sequence[str],
    faults: Sequence[Asked],
    seed: int,
) -> list[Run]:
    """Simulate every machine on every route with every vehicle; the n-th vehicle has the n-th seed from `seed` on.

    InputError for a fault that occurs on none of the routes, and if no machine has a data source on them.
    """
    runs = list(_runs(walk, chosen, vehicles, machines, faults, seed))
    _require_effect(faults, runs, walk.topology.line)
    return runs


def write_runs(where: Path, line: Line, runs: Sequence[Run], *, audited: bool) -> list[dict[str, Any]]:
    """Write the streams, their configurations and runs.json into a folder; return the entries of runs.json.

    audited  whether the line passes its audit for every vehicle. InputError if a file cannot be written
    """
    folder = _Folder(where)
    try:
        where.mkdir(parents=True, exist_ok=True)
        entries = [folder.write(run) for run in runs]
        data = {
            "schema": _SCHEMA,
            "line": line.name,
            "version": line.version,
            "checksum": content_checksum(line),
            "audited": audited,
            "runs": entries,
        }
        (where / "runs.json").write_text(json.dumps(data, indent=2) + "\n", encoding="utf-8")
    except OSError as error:
        raise InputError(f"{where}: cannot be written: {error}") from error
    return entries


def _runs(
    walk: Walk,
    chosen: Sequence[Chosen],
    vehicles: Sequence[LineVehicle],
    machines: Sequence[str],
    faults: Sequence[Asked],
    seed: int,
) -> Iterator[Run]:
    for index, vehicle in enumerate(vehicles):
        named = "" if vehicle.layout is None else _vehicle_label(vehicles, index)
        for number, one in enumerate(chosen, 1):
            label = "-".join(part for part in (named, str(number), one.route.models()) if part)
            journey = Journey(one.route, walk, vehicle, seed + index, one.rivals, faults)
            for machine in machines:
                for stream in streams(journey, machine):
                    yield Run(journey, stream, label, named)


def _require_effect(asked: Sequence[Asked], runs: Sequence[Run], line: Line) -> None:
    """Refuse a fault that occurs in no run, since it tests nothing, and a request without any run."""
    struck = [one for run in runs for one in run.stream.struck]
    idle = [one.as_requested for one in asked if not any(one.is_at(found.name, found.at) for found in struck)]
    if idle:
        raise InputError(f"fault {idle[0]} does not occur on the driven routes of {line.name}; choose another place.")
    if not runs:
        raise InputError(f"nothing to drive: the chosen machines have no data source on these routes of {line.name}.")


def _vehicle_label(vehicles: Sequence[LineVehicle], index: int) -> str:
    slug = _slug(Path(vehicles[index].name).stem)
    same = [number for number, one in enumerate(vehicles) if _slug(Path(one.name).stem) == slug]
    return slug if len(same) == 1 else f"{slug}-{same.index(index) + 1}"


def _slug(name: str) -> str:
    return re.sub(r"[^A-Za-z0-9_.-]+", "_", name)


@dataclass
class _Folder:
    """Writes streams and configurations into a folder. A configuration that equals the defaults is not written."""

    where: Path
    configs: dict[str, str] = field(default_factory=dict)

    def write(self, run: Run) -> dict[str, Any]:
        """Write one stream; return its entry in runs.json."""
        stream = run.stream
        stop = f"-{_slug(stream.stop)}" if stream.stop else ""
        file = f"{stream.machine}-{run.label}{stop}.jsonl"
        write_steps(self.where / file, stream.steps, machine=stream.machine)
        return _entry(run, file, self._config(stream.machine, run.vehicle_label, stream.config))

    def _config(self, machine: str, vehicle: str, config: Config) -> str | None:
        if config == type(config)():
            return None
        text = json.dumps(config.model_dump(mode="json"), indent=2) + "\n"
        base, number = "-".join(part for part in (machine, vehicle, "config") if part), 1
        while self.configs.setdefault(name := f"{base}{'' if number == 1 else f'-{number}'}.json", text) != text:
            number += 1
        (self.where / name).write_text(text, encoding="utf-8")
        return name


def _entry(run: Run, file: str, config: str | None) -> dict[str, Any]:
    route, stream = run.journey.route, run.stream
    return {
        "file": file,
        "machine": stream.machine,
        "config": config,
        "vehicle": run.journey.vehicle.name,
        "seed": run.journey.seed,
        "route": [f"{one.edge} {one.direction}" for one in route.runs],
        "start_mm": route.start_mm,
        "length_mm": route.length_mm,
        "models": route.models(),
        "stop": stream.stop or None,
        "steps": len(stream.steps),
        "faults": [
            {
                "name": one.name,
                "at": one.at or None,
                "first_cycle": one.begin,
                "end_cycle": one.end,
                "outcome": one.outcome[stream.machine],
            }
            for one in stream.struck
        ],
    }
