"""`safeloc drive`: turn the log of a recorded train into records for `replay`."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path
from typing import Annotated

import typer

from safeloc.cli.console import err
from safeloc.cli.options import direction
from safeloc.errors import InputError
from safeloc.railway.guard.other_way import doubt
from safeloc.railway.guard.recorded_train import equipped, recorded_train
from safeloc.railway.map.imports.geojson import read_geojson
from safeloc.railway.map.imports.geojson_path import read_path, route_over
from safeloc.railway.map.model import Line
from safeloc.railway.map.recorded_run import Reading, Trust
from safeloc.railway.map.routes import Route
from safeloc.railway.map.toml_files import load_line
from safeloc.railway.map.topology import Topology
from safeloc.runtime.streams.record_files import write_records


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
        typer.Option("--satellite", help="FLAG=MM: fixes with this quality flag become markers of this accuracy"),
    ] = None,
    length_mm: Annotated[int, typer.Option("--vehicle-length-mm", min=0)] = 100_000,
    accuracy_mm: Annotated[int, typer.Option("--balise-accuracy-mm", min=0)] = 1_000,
    offset_limit_mm: Annotated[int, typer.Option(help="a fix farther off the track is not trusted", min=0)] = 15_000,
    max_speed_mm_s: Annotated[int, typer.Option(help="a fix that needs more is not trusted", min=1)] = 44_445,
) -> None:
    """Drive a recorded train over a network: write records of odometers, balise readers, satellites and the true position.

    Only fixes that the guard (`safeloc guard`) passes on this route become truth, markers or balise readings.
    """
    route = equipped(_route(_line(line), path, edges, first), spacing_mm, at_mm or [], accuracy_mm)
    trust, reading = Trust(offset_limit_mm, max_speed_mm_s), Reading(length_mm, accuracy_mm)
    train = recorded_train(log, route, trust, reading, _accuracies(satellites or []))
    write_records(where, train.records)
    if train.doubt is not None:
        err.print(f"warning: at {train.doubtful} fixes the route is doubtful: {doubt(train.doubt)}", markup=False)
    err.print(
        f"{train.fixes} fixes, {train.near} near the track, {train.trusted} of them trusted by the guard, "
        f"{train.balises} balise readings: {where}",
        markup=False,
    )


def _line(file: Path) -> Line:
    return load_line(file) if file.suffix == ".toml" else read_geojson(file).line


def _route(line: Line, path: Path | None, edges: str | None, first: str | None) -> Route:
    way = direction(first)
    if (path is None) == (edges is None):
        raise InputError("give the train's route: either --path or --edges.")
    topology = Topology(line)
    if path is not None:
        return read_path(path, topology, first=way).route
    return route_over([edge.strip() for edge in (edges or "").split(",")], topology, first=way)


def _accuracies(given: Iterable[str]) -> dict[str, int]:
    """Return the accuracy in mm of each quality flag in --satellite."""
    accuracies = {}
    for one in given:
        flag, _, accuracy = one.partition("=")
        if not flag or not (accuracy.isascii() and accuracy.isdecimal()):
            raise InputError(f"--satellite {one!r}: expected FLAG=MM, for instance NARROW_INT3=1000.")
        accuracies[flag] = int(accuracy)
    return accuracies
