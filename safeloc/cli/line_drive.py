"""`safeloc drive`: a recorded train over a network, as records that `replay` takes."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path
from typing import Annotated, Literal

import typer

from safeloc.cli.console import err
from safeloc.errors import InputError
from safeloc.railway.guard.believed import believed_times
from safeloc.railway.map.imports.geojson import read_geojson
from safeloc.railway.map.imports.geojson_path import read_path, route_over
from safeloc.railway.map.model import Line
from safeloc.railway.map.placing import with_balise_groups
from safeloc.railway.map.recorded_run import (
    Reading,
    Trust,
    balise_records,
    in_order,
    odometer_records,
    on_route,
    read_fixes,
    satellite_records,
    trusted_times,
    truth_records,
)
from safeloc.railway.map.routes import Route
from safeloc.railway.map.toml_files import load_line
from safeloc.railway.map.topology import Topology
from safeloc.runtime.streams.record_files import write_records

FIRST_FIX_IDENTITY = 500_000
"""Fixes as virtual markers are numbered from here on, beyond every NID_BG."""

Direction = Literal["increasing", "decreasing"]


def drive(
    line: Annotated[Path, typer.Argument(help="network with the course of its edges: line (TOML) or GeoJSON")],
    log: Annotated[Path, typer.Argument(help="CSV: timestamp, longitude, latitude, position_type")],
    where: Annotated[Path, typer.Option("--out", help="records to write: .jsonl, .jsonl.gz, .csv or .parquet")],
    path: Annotated[
        Path | None, typer.Option("--path", help="GeoJSON with the elements of the route, in order")
    ] = None,
    edges: Annotated[str | None, typer.Option("--edges", help="the edges of the route, separated by commas")] = None,
    first: Annotated[
        str | None, typer.Option("--first", help="direction along the first edge: increasing or decreasing")
    ] = None,
    spacing_mm: Annotated[
        int | None, typer.Option("--balise-spacing-mm", help="place groups this far apart", min=1)
    ] = None,
    at_mm: Annotated[list[int] | None, typer.Option("--balise-at-mm", help="place a group there (repeatable)")] = None,
    satellites: Annotated[
        list[str] | None,
        typer.Option("--satellite", help="FLAG=MM: fixes of this quality are markers of this accuracy"),
    ] = None,
    length_mm: Annotated[int, typer.Option("--vehicle-length-mm", min=0)] = 100_000,
    accuracy_mm: Annotated[int, typer.Option("--balise-accuracy-mm", min=0)] = 1_000,
    offset_limit_mm: Annotated[int, typer.Option(help="a fix farther off the track is not trusted", min=0)] = 15_000,
    max_speed_mm_s: Annotated[int, typer.Option(help="a fix that needs more is not trusted", min=1)] = 44_445,
) -> None:
    """Drive a recorded train over a network: odometers, balise readers at both ends, satellites and the ground truth.

    No fix that the guard of a receiver withholds on this route (`safeloc guard`) is truth, marker or balise reading.
    """
    route = _equipped(_route(_line(line), path, edges, first), spacing_mm, at_mm or [], accuracy_mm)
    said = read_fixes(log)
    fixes = on_route(said, route)
    believed = believed_times(said, route, max_speed_mm_s=max_speed_mm_s)
    passed = [fix for fix in fixes if fix.time_ms in believed]
    trusted = trusted_times(passed, Trust(offset_limit_mm, max_speed_mm_s))
    balises = list(balise_records(fixes, route, Reading(length_mm, accuracy_mm), trusted))
    records = in_order(
        balises,
        satellite_records(fixes, _claims(satellites or []), FIRST_FIX_IDENTITY, trusted),
        odometer_records(fixes, along="radar", straight="wheel"),
        truth_records(fixes, trusted),
    )
    write_records(where, records)
    near = sum(abs(fix.offset_mm) <= offset_limit_mm for fix in fixes)
    told = (
        f"{len(fixes)} fixes, {near} near the track, {len(trusted)} of them trusted by the guard, "
        f"{len(balises)} balise readings: {where}"
    )
    err.print(told, markup=False)


def _line(file: Path) -> Line:
    return load_line(file) if file.suffix == ".toml" else read_geojson(file).line


def _route(line: Line, path: Path | None, edges: str | None, first: str | None) -> Route:
    way: Direction | None = None
    if first is not None:
        if first not in ("increasing", "decreasing"):
            raise InputError(f"--first {first!r}: choose increasing or decreasing.")
        way = "increasing" if first == "increasing" else "decreasing"
    if (path is None) == (edges is None):
        raise InputError("give the train's route: either --path or --edges.")
    topology = Topology(line)
    if path is not None:
        return read_path(path, topology, first=way).route
    return route_over([edge.strip() for edge in (edges or "").split(",")], topology, first=way)


def _equipped(route: Route, spacing_mm: int | None, at_mm: Iterable[int], accuracy_mm: int) -> Route:
    """The route with the groups placed on it, numbered after those that are there."""
    spaced = [] if spacing_mm is None else range(spacing_mm, route.length_mm, spacing_mm)
    places = sorted({*spaced, *at_mm})
    there = max((group.identity for group in route.topology.line.balise_groups), default=0)
    line = with_balise_groups(route, places, first_identity=there + 1, accuracy_mm=accuracy_mm)
    return Route(Topology(line), route.runs, route.start_mm, route.end_mm)


def _claims(told: Iterable[str]) -> dict[str, int]:
    """Quality flag -> accuracy in mm."""
    claims = {}
    for one in told:
        flag, _, accuracy = one.partition("=")
        if not flag or not (accuracy.isascii() and accuracy.isdecimal()):
            raise InputError(f"--satellite {one!r}: expected FLAG=MM, for instance NARROW_INT3=1000.")
        claims[flag] = int(accuracy)
    return claims
