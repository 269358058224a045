"""`safeloc simulate`: write streams for `replay`, of one machine or of vehicles on a line."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from safeloc.catalogue import ENTRIES, load_target
from safeloc.cli.console import err, out
from safeloc.errors import InputError
from safeloc.railway.map.toml_files import shipped_lines
from safeloc.runtime.streams.steps import write_steps
from safeloc.simulated import first_values


def simulate(
    target: Annotated[
        str, typer.Argument(help="a machine (see `safeloc list`), or a line: file (TOML or JSON), fig1, fig2, fig3")
    ],
    where: Annotated[
        Path | None,
        typer.Option(
            "--out",
            help="stream to write (.jsonl, .jsonl.gz, .csv, .parquet), in place of an older one; of a line: folder",
        ),
    ] = None,
    config: Annotated[
        Path | None, typer.Option("--config", help="TOML or JSON with the machine's configuration")
    ] = None,
    seed: Annotated[
        int, typer.Option(help="seed of sensors and driving; the next vehicle has the next seed", min=0)
    ] = 0,
    machines: Annotated[
        list[str] | None, typer.Option("--machine", help="of a line: which machines (repeatable); else all")
    ] = None,
    vehicles: Annotated[
        list[str] | None, typer.Option("--vehicle", help="of a line: file or shipped vehicle (repeatable)")
    ] = None,
    routes: Annotated[
        list[str] | None, typer.Option("--route", help="of a line: edges of a route, separated by commas (repeatable)")
    ] = None,
    start: Annotated[str | None, typer.Option("--from", help="of a line: EDGE@MM, the start of all routes")] = None,
    end: Annotated[str | None, typer.Option("--to", help="of a line: EDGE@MM, the end of all routes")] = None,
    faults: Annotated[
        list[str] | None, typer.Option("--faults", help="of a line: NAME or NAME:PLACE, with commas; `help` lists them")
    ] = None,
    trust_first: Annotated[
        bool,
        typer.Option("--trust-first", help="of a line: accept the first balise group of a run without a second one"),
    ] = False,
    unaudited: Annotated[
        bool, typer.Option("--unaudited", help="drive the line although its audit finds violated rules")
    ] = False,
) -> None:
    """Write simulated sensor data with the true position: for one machine, or for vehicles on a line."""
    from safeloc.cli.simulate_line import LineOptions, simulate_line  # numpy is loaded only where it is needed
    from safeloc.models.line_runs.faults import fault_table

    options = LineOptions(
        tuple(machines or ()), tuple(vehicles or ()), tuple(routes or ()), start, end, tuple(faults or ()),
        trust_first, unaudited, seed,
    )  # fmt: skip
    if "help" in options.faults:
        out.print(fault_table(), markup=False)
    elif where is None:
        raise typer.BadParameter("give an output: --out FILE for a machine, --out FOLDER for a line.")
    elif not _is_line(target):
        _machine(target, where, config, options.named(), seed)
    elif config is not None:
        raise typer.BadParameter("--config applies to one machine; on a line, --vehicle configures the machines.")
    else:
        simulate_line(target, where, options)


def _is_line(target: str) -> bool:
    """Return whether the target names a shipped line or a file of a line."""
    return target in shipped_lines() or (target not in ENTRIES and Path(target).suffix in (".toml", ".json"))


def _machine(target: str, where: Path, config: Path | None, of_lines: list[str], seed: int) -> None:
    if of_lines:
        raise typer.BadParameter(f"{', '.join(of_lines)} is for lines, and {target!r} is no line.")
    loaded = load_target(target, config, with_recordings=False)
    if loaded.simulate is None:
        able = [name for name, entry in ENTRIES.items() if entry.simulates]
        own = (
            "; declare a function `simulate` of a seed beside it, which returns the steps of a run"
            if ":" in target
            else ""
        )
        raise InputError(f"{loaded.name} has no simulation{own}; these machines have one: {', '.join(able)}.")
    steps, replaced = loaded.simulate(seed), " (replaced)" if where.exists() else ""
    try:
        write_steps(where, steps, machine=loaded.name, first=first_values(steps))
    except OSError as error:
        raise InputError(f"{where}: cannot be written: {error.strerror or error}.") from error
    err.print(f"{len(steps)} steps: {where}{replaced}", markup=False)
