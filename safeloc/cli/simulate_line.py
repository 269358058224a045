"""`safeloc simulate LINE`: vehicles on the routes of an audited line, one stream a machine, route and vehicle."""

from __future__ import annotations

import json
import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from safeloc.catalogue import ENTRIES
from safeloc.cli.console import err
from safeloc.cli.simulate_routes import Chosen, chosen_routes
from safeloc.config import Config
from safeloc.errors import InputError
from safeloc.models.line_runs.configs import LineVehicle
from safeloc.models.line_runs.drive import Journey, Stream, streams
from safeloc.models.line_runs.faults import MACHINES, Asked, parse
from safeloc.models.line_runs.ways import balise_groups
from safeloc.railway.audit import audit
from safeloc.railway.audit.vehicle import SHIPPED, find_layout
from safeloc.railway.map.model import Line, content_checksum
from safeloc.railway.map.toml_files import find_line
from safeloc.railway.map.walk import Walk
from safeloc.runtime.streams.steps import write_steps
from safeloc.simulation.vehicles import load_vehicle

SCHEMA = "safeloc-runs/1"
BY_GROUPS = ("odometry", "balise")
"""Machines that report nothing after a single group, unless it is vouched for."""


@dataclass(frozen=True)
class LineOptions:
    """The options of the command line."""

    machines: tuple[str, ...] = ()
    vehicles: tuple[str, ...] = ()
    routes: tuple[str, ...] = ()
    start: str | None = None
    end: str | None = None
    faults: tuple[str, ...] = ()
    trust_first: bool = False
    unaudited: bool = False
    seed: int = 0

    def named(self) -> list[str]:
        """Return the options of a line that were given."""
        given = {
            "--machine": self.machines,
            "--vehicle": self.vehicles,
            "--route": self.routes,
            "--from": self.start,
            "--to": self.end,
            "--faults": self.faults,
            "--trust-first": self.trust_first,
            "--unaudited": self.unaudited,
        }
        return [name for name, value in given.items() if value]


@dataclass(frozen=True)
class Run:
    """One stream, and the journey it is of. `label` names vehicle and route in file names."""

    journey: Journey
    stream: Stream
    label: str
    vehicle_label: str


@dataclass
class Folder:
    """Streams and configurations on their way into a folder. A configuration that is the default is not written."""

    where: Path
    configs: dict[str, str] = field(default_factory=dict)

    def write(self, run: Run) -> dict[str, Any]:
        """Write one stream; return its entry in runs.json."""
        stream = run.stream
        stop = f"-{_slug(stream.stop)}" if stream.stop else ""
        file = f"{stream.machine}-{run.label}{stop}.jsonl"
        write_steps(self.where / file, stream.steps, machine=stream.machine)
        config = self._config(stream.machine, run.vehicle_label, stream.config)
        with_config = f" --config {self.where / config}" if config else ""
        err.print(f"safeloc replay {stream.machine} {self.where / file}{with_config}", markup=False)
        return _entry(run, file, config)

    def _config(self, machine: str, vehicle: str, config: Config) -> str | None:
        if config == ENTRIES[machine].config():
            return None
        text = json.dumps(config.model_dump(mode="json"), indent=2) + "\n"
        base, number = "-".join(part for part in (machine, vehicle, "config") if part), 1
        while self.configs.setdefault(name := f"{base}{'' if number == 1 else f'-{number}'}.json", text) != text:
            number += 1
        (self.where / name).write_text(text, encoding="utf-8")
        return name


def simulate_line(name: str, where: Path, options: LineOptions) -> None:
    """Drive, and write the streams and runs.json. InputError, and nothing written, for what cannot be driven."""
    line = find_line(name)
    machines = options.machines or MACHINES
    unknown = [one for one in machines if one not in MACHINES]
    if unknown:
        raise InputError(f"no machine {unknown[0]!r} to drive on a line; there are {', '.join(MACHINES)}.")
    asked = parse(
        [one.strip() for told in options.faults for one in told.split(",")], machines, trust_first=options.trust_first
    )
    vehicles = list(_vehicles(options))
    passes = [_audited(line, vehicle, options.unaudited) for vehicle in vehicles]
    walk = Walk(line)
    chosen = chosen_routes(walk.topology, options.routes, options.start, options.end)
    runs = list(_runs(walk, chosen, vehicles, machines, asked, options.seed))
    _check_struck(asked, runs, line)
    _write(where, line, all(passes), runs)
    _hint(runs, options.trust_first)


def _vehicles(options: LineOptions) -> Iterator[LineVehicle]:
    for name in options.vehicles:
        path = SHIPPED / f"{name}.toml"
        layout = find_layout(name)
        yield LineVehicle(name, load_vehicle(path if path.is_file() else Path(name)), layout, options.trust_first)
    if not options.vehicles:
        yield LineVehicle(trust_first=options.trust_first)


def _audited(line: Line, vehicle: LineVehicle, unaudited: bool) -> bool:
    report = audit(line, vehicle.layout, vehicle.name)
    if report.violated and not unaudited:
        shown = "\n".join(f"  {finding.as_text()}" for finding in report.violated[:5])
        raise InputError(
            f"{line.name} does not pass its audit for {vehicle.name} ({len(report.violated)} violated):\n{shown}\n"
            "The proofs hold only for lines that pass: on this one a simulated run may break a machine's assumption. "
            "Mend the line (`safeloc audit` says where), or drive it all the same with --unaudited."
        )
    return not report.violated


def _runs(
    walk: Walk,
    chosen: Sequence[Chosen],
    vehicles: Sequence[LineVehicle],
    machines: Sequence[str],
    faults: Sequence[Asked],
    seed: int,
) -> Iterator[Run]:
    """Every machine on every route with every vehicle; the n-th vehicle has the n-th seed from `seed` on."""
    for index, vehicle in enumerate(vehicles):
        named = "" if vehicle.layout is None else _vehicle_label(vehicles, index)
        for number, one in enumerate(chosen, 1):
            label = "-".join(part for part in (named, str(number), one.route.models()) if part)
            journey = Journey(one.route, walk, vehicle, seed + index, one.rivals, faults)
            for machine in machines:
                for stream in streams(journey, machine):
                    yield Run(journey, stream, label, named)


def _vehicle_label(vehicles: Sequence[LineVehicle], index: int) -> str:
    slug = _slug(Path(vehicles[index].name).stem)
    same = [number for number, one in enumerate(vehicles) if _slug(Path(one.name).stem) == slug]
    return slug if len(same) == 1 else f"{slug}-{same.index(index) + 1}"


def _slug(name: str) -> str:
    return re.sub(r"[^A-Za-z0-9_.-]+", "_", name)


def _check_struck(asked: Sequence[Asked], runs: Sequence[Run], line: Line) -> None:
    """A fault that strikes in no run tests nothing."""
    struck = [one for run in runs for one in run.stream.struck]
    idle = [one.told for one in asked if not any(one.is_at(found.name, found.at) for found in struck)]
    if idle:
        raise InputError(f"fault {idle[0]} does not occur on the driven routes of {line.name}; choose another place.")
    if not runs:
        raise InputError(f"nothing to drive: the chosen machines have no data source on these routes of {line.name}.")


def _write(where: Path, line: Line, audited: bool, runs: Sequence[Run]) -> None:
    folder = Folder(where)
    try:
        where.mkdir(parents=True, exist_ok=True)
        entries = [folder.write(run) for run in runs]
        data = {
            "schema": SCHEMA,
            "line": line.name,
            "version": line.version,
            "checksum": content_checksum(line),
            "audited": audited,
            "runs": entries,
        }
        (where / "runs.json").write_text(json.dumps(data, indent=2) + "\n", encoding="utf-8")
    except OSError as error:
        raise InputError(f"{where}: cannot be written: {error}") from error
    err.print(f"{len(runs)} streams, listed in {where / 'runs.json'}", markup=False)


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


def _hint(runs: Sequence[Run], trust_first: bool) -> None:
    alone = [run for run in runs if run.stream.machine in BY_GROUPS and len(balise_groups(run.journey.route)) < 2]
    if alone and not trust_first:
        err.print(
            f"{len(alone)} of the streams have one balise group or none: the first is only a candidate, and nothing is "
            "reported after it unless it is vouched for (--trust-first).",
            markup=False,
        )
