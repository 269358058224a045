"""`safeloc guard`: filter a receiver's positions by map and motion."""

from __future__ import annotations

import json
import sys
from collections import Counter
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import IO, Annotated

import typer

from safeloc.catalogue import read_config
from safeloc.cli.console import err, out, print_json
from safeloc.cli.files import require_not_read
from safeloc.cli.options import direction
from safeloc.errors import InputError
from safeloc.models.guard.variables import GuardConfig
from safeloc.railway.guard.fields import columns_of
from safeloc.railway.guard.figures import find_vehicle, guard_config
from safeloc.railway.guard.guard import Guard, Judgement
from safeloc.railway.guard.inputs import Way, deliveries, form_of, line_of, opened, route_of
from safeloc.railway.guard.judgement_data import SCHEMA, as_data
from safeloc.railway.guard.other_way import doubt
from safeloc.railway.guard.tracks import Tracks
from safeloc.railway.map.projection import WGS84
from safeloc.report.folder import usable
from safeloc.report.guard_folder import write_guard_folder

_NOTHING_PASSED = 3


def guard(
    line: Annotated[str, typer.Argument(help="map with the course of its edges: line (TOML, JSON) or GeoJSON")],
    stream: Annotated[str, typer.Argument(help="positions: file, or - for standard input")] = "-",
    vehicle: Annotated[
        str | None, typer.Option("--vehicle", help="vehicle file, or a shipped one: metro, desiro-br642, freight-v90")
    ] = None,
    config: Annotated[Path | None, typer.Option("--config", help="TOML or JSON with parameters of the guard")] = None,
    path: Annotated[Path | None, typer.Option("--path", help="GeoJSON with the edges of the route")] = None,
    edges: Annotated[str | None, typer.Option("--edges", help="the edges of the route, separated by commas")] = None,
    first: Annotated[
        str | None, typer.Option("--first", help="direction along the first edge: increasing or decreasing")
    ] = None,
    both: Annotated[
        bool,
        typer.Option(
            "--both-directions", help="the vehicle may also run back on the route (setting back, change of cab)"
        ),
    ] = False,
    form: Annotated[str | None, typer.Option("--format", help="csv, jsonl or nmea; by default from the suffix")] = None,
    column: Annotated[
        list[str] | None,
        typer.Option("--column", help="WHAT=NAME (repeatable); WHAT: time, x, y, speed, flag, received"),
    ] = None,
    time_unit: Annotated[str, typer.Option(help="unit of numeric times: ms or s")] = "ms",
    speed_unit: Annotated[str, typer.Option(help="unit of speeds: m/s, km/h, mm/s or knots")] = "m/s",
    no_fix: Annotated[list[str] | None, typer.Option("--no-fix", help="flag that means no position")] = None,
    crs: Annotated[str, typer.Option(help="coordinate system of the positions")] = WGS84,
    sentence: Annotated[str, typer.Option(help="NMEA sentence to take: RMC, GGA, GNS or GLL")] = "RMC",
    where: Annotated[Path | None, typer.Option("--out", help="JSONL to write; else standard output")] = None,
    report: Annotated[
        Path | None, typer.Option("--report", help="write a page with map and intervals into this folder")
    ] = None,
    as_json: Annotated[bool, typer.Option("--json", help="print counts as JSON only; needs --out")] = False,
) -> None:
    """Filter a receiver's positions: pass each on with its interval along the track, or withhold it with a reason.

    Exit code 0: at least one position was passed on; 3: none was; 2: wrong input.
    """
    if as_json and where is None:
        raise typer.BadParameter("--json prints the counts; give the positions a file with --out.")
    columns = columns_of(column or [], time_unit=time_unit, speed_unit=speed_unit, no_fix=no_fix or [])
    kind = form_of(stream, form)
    if report is not None:
        usable(report)
    if where is not None:
        require_not_read(where, line, stream, path, config, vehicle)
    figures, network = _config(vehicle, config), line_of(line)
    route = route_of(network, Way(path, edges, direction(first)))
    clear, reach = figures.track_clearance_mm, figures.tolerance_mm
    tracks = Tracks(network, clear_mm=clear, reach_mm=reach, route=route, crs=crs, both_directions=both)
    made = Guard(figures, tracks)
    kept: list[Judgement] = []
    with opened(stream) as lines, _target(where) as target:
        judgements = made.judge_all(deliveries(lines, kind, columns, sentence, stream))
        counts, doubtful = _written(judgements, target, kept if report is not None else None)
    if report is not None:
        err.print(f"report: {write_guard_folder(report, kept, made.tracks, figures, stream)}", markup=False)
    _summary(counts, doubtful, as_json=as_json, to_stderr=where is None)
    raise typer.Exit(0 if counts["PASSED"] else _NOTHING_PASSED)


def _config(vehicle: str | None, file: Path | None) -> GuardConfig:
    """Return the guard's configuration; figures of the file override those of the vehicle."""
    chosen = {} if file is None else read_config(GuardConfig, file).model_dump(exclude_unset=True)
    return guard_config(None if vehicle is None else find_vehicle(vehicle), chosen)


def _written(
    judgements: Iterable[Judgement], target: IO[str], kept: list[Judgement] | None
) -> tuple[Counter[str], int]:
    """Write each judgement at once; count the reasons, and the fixes at which the way is doubtful, with a warning at the first.

    All judgements are appended to `kept`, if it is given.
    """
    counts: Counter[str] = Counter()
    doubtful = 0
    for judgement in judgements:
        target.write(json.dumps(as_data(judgement)) + "\n")
        target.flush()
        counts[judgement.reason] += 1
        if judgement.beside is not None and judgement.beside.doubtful:
            doubtful += 1
            if doubtful == 1:
                err.print(f"warning: line {judgement.delivery.number}: {doubt(judgement.beside)}", markup=False)
        if kept is not None:
            kept.append(judgement)
    return counts, doubtful


@contextmanager
def _target(where: Path | None) -> Iterator[IO[str]]:
    if where is None:
        yield sys.stdout
        return
    try:
        file = where.open("w", encoding="utf-8")
    except OSError as error:
        raise InputError(f"{where}: cannot be written: {error.strerror}.") from error
    with file:
        yield file


def _summary(counts: Counter[str], doubtful: int, *, as_json: bool, to_stderr: bool) -> None:
    if as_json:
        told = {"deliveries": counts.total(), "reasons": dict(counts.most_common()), "way_doubtful": doubtful}
        print_json({"schema": SCHEMA, **told})
        return
    reasons = ", ".join(f"{reason} {number}" for reason, number in counts.most_common())
    way = f"; the way is doubtful at {doubtful} of those passed on" if doubtful else ""
    (err if to_stderr else out).print(f"{counts.total()} deliveries: {reasons or 'none'}{way}", markup=False)
