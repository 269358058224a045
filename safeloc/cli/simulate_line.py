"""`safeloc simulate LINE`: options, audit and messages; the runs themselves come from `models/line_runs/`."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

from safeloc.cli.console import err
from safeloc.errors import InputError
from safeloc.models.line_runs.configs import LineVehicle
from safeloc.models.line_runs.faults import MACHINES, parse
from safeloc.models.line_runs.route_choice import chosen_routes
from safeloc.models.line_runs.run_folder import Run, line_runs, write_runs
from safeloc.railway.audit import audit
from safeloc.railway.audit.vehicle import SHIPPED, find_layout
from safeloc.railway.map.model import Line
from safeloc.railway.map.toml_files import find_line
from safeloc.railway.map.walk import Walk
from safeloc.simulation.vehicles import load_vehicle


@dataclass(frozen=True)
class LineOptions:
    """The options of the command line that apply to a line."""

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
        """Return the names of the options that were given."""
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


def simulate_line(name: str, where: Path, options: LineOptions) -> None:
    """Drive vehicles over a line; write the streams and runs.json into a folder.

    InputError for a line, vehicle, route or fault that cannot be simulated; then nothing is written.
    """
    line, runs, audited = _driven(name, options)
    for entry in write_runs(where, line, runs, audited=audited):
        with_config = f" --config {where / entry['config']}" if entry["config"] else ""
        err.print(f"safeloc replay {entry['machine']} {where / entry['file']}{with_config}", markup=False)
    err.print(f"{len(runs)} streams, listed in {where / 'runs.json'}", markup=False)
    _hint(runs, options.trust_first)


def runs_on_line(name: str, options: LineOptions) -> list[Run]:
    """Drive vehicles over a line and return the runs; the errors are those of `simulate_line`."""
    return _driven(name, options)[1]


def _driven(name: str, options: LineOptions) -> tuple[Line, list[Run], bool]:
    """Return the line, the runs on it, and whether it passes its audit for every vehicle."""
    line = find_line(name)
    machines = options.machines or MACHINES
    unknown = [one for one in machines if one not in MACHINES]
    if unknown:
        raise InputError(f"no machine {unknown[0]!r} to drive on a line; there are {', '.join(MACHINES)}.")
    names = [fault.strip() for given in options.faults for fault in given.split(",")]
    faults = parse(names, machines, trust_first=options.trust_first)
    vehicles = list(_vehicles(options))
    passes = [_audited(line, vehicle, options.unaudited) for vehicle in vehicles]
    walk = Walk(line)
    chosen = chosen_routes(walk.topology, options.routes, options.start, options.end)
    return line, line_runs(walk, chosen, vehicles, machines, faults, options.seed), all(passes)


def _vehicles(options: LineOptions) -> Iterator[LineVehicle]:
    for name in options.vehicles:
        path = SHIPPED / f"{name}.toml"
        layout = find_layout(name)
        yield LineVehicle(name, load_vehicle(path if path.is_file() else Path(name)), layout, options.trust_first)
    if not options.vehicles:
        yield LineVehicle(trust_first=options.trust_first)


def _audited(line: Line, vehicle: LineVehicle, unaudited: bool) -> bool:
    """Return whether the line passes its audit for a vehicle. InputError if it does not, unless --unaudited is given."""
    report = audit(line, vehicle.layout, vehicle.name)
    if report.violated and not unaudited:
        shown = "\n".join(f"  {finding.as_text()}" for finding in report.violated[:5])
        raise InputError(
            f"{line.name} does not pass its audit for {vehicle.name} ({len(report.violated)} violated):\n{shown}\n"
            "The proofs hold only for lines that pass: on this one a simulated run may break a machine's assumption. "
            "Mend the line (`safeloc audit` says where), or drive it all the same with --unaudited."
        )
    return not report.violated


def _hint(runs: Sequence[Run], trust_first: bool) -> None:
    alone = sum(run.has_single_group for run in runs)
    if alone and not trust_first:
        err.print(
            f"{alone} of the streams have one balise group or none: the first is only a candidate, and nothing is "
            "reported after it unless --trust-first makes it a reference.",
            markup=False,
        )
