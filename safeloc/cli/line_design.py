"""`safeloc margins LINE --for tolerance=30m`: design a line, print it, check it, and write it as a file."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TypeVar

import typer
from pydantic import BaseModel, ValidationError

from safeloc.cli.console import err, out, print_json
from safeloc.cli.show import EXIT_CODES, Progressing
from safeloc.errors import InputError
from safeloc.models.layout_rules import LayoutConfig
from safeloc.railway.audit.vehicle import find_layout
from safeloc.railway.design.checks import Held, held_by_the_machine, machine_config, written
from safeloc.railway.design.design_data import design_data, lines
from safeloc.railway.design.designing import Design, Task, design
from safeloc.railway.design.figures import Added, Costs
from safeloc.railway.design.nearest import nearest_kept, with_tolerance
from safeloc.railway.design.options import kept
from safeloc.railway.map.toml_files import find_line
from safeloc.runtime.streams.steps import write_steps

_TOLERANCE = re.compile(r"tolerance=(\d+(?:\.\d{1,3})?)(m|mm)")
_SEARCH_SECONDS = 60.0
_NEAREST_SECONDS, _QUESTIONS = 30.0, 28
"""Processor time of the search for the nearest tolerance, and about as many tolerances as it asks."""
_Figures = TypeVar("_Figures", bound=BaseModel)


@dataclass(frozen=True)
class DesignOptions:
    """The options of the command line that apply to a design."""

    vehicle: str | None = None
    costs: Sequence[str] = ()
    added: Sequence[str] = ()
    keep: Sequence[str] = ()
    folder: Path | None = None
    seconds: float = 10.0
    as_json: bool = False

    def named(self) -> list[str]:
        """Return the names of the options that were given and are of a design only."""
        given = {"--vehicle": self.vehicle, "--cost": self.costs, "--add": self.added, "--keep": self.keep}
        return [name for name, value in given.items() if value]


def design_line(name: str, wanted: str, options: DesignOptions) -> None:
    """Design a line; InputError if the tolerance cannot be kept, with the nearest one that can."""
    line, base = find_line(name), find_layout(options.vehicle) if options.vehicle else LayoutConfig()
    tolerance_mm = _tolerance_mm(wanted)
    task = Task(line, base, _figures(Costs, options.costs), _figures(Added, options.added), options.keep)
    kept(line, options.keep)
    if task.added.markers and base.markers is None:
        raise InputError(
            "--add markers=N is for a vehicle that reads them: give one with --vehicle whose file has the table [localization.markers] "
            "(docs/line.md)."
        )
    found, why = None, ""
    try:
        found = design(replace(task, layout=with_tolerance(base, tolerance_mm)), _SEARCH_SECONDS)
    except InputError as error:
        why = f" ({str(error).rstrip('.')})"
    if found is None:
        raise InputError(_unkept(task, tolerance_mm, why, quiet=options.as_json))
    _tell(found, options)


def _tell(found: Design, options: DesignOptions) -> None:
    text, audited = written(found)
    held = list(held_by_the_machine(found, options.seconds))
    if options.folder is not None:
        _write(found, text, held, options.folder)
    if options.as_json:
        print_json(design_data(found, audited, held))
    else:
        for one in lines(found, audited, held):
            out.print(one, markup=False, soft_wrap=True)
    if audited.violated or not all(one.is_shown for one in held):
        raise typer.Exit(EXIT_CODES["unknown"])


def _write(found: Design, text: str, held: Sequence[Held], folder: Path) -> None:
    """Write the designed line, and for `safeloc replay` of the machine the runs that lose the position, with their configuration."""
    config, machine = (
        machine_config(found).model_dump_json(indent=2),
        "odometry" if found.task.layout.markers else "balise",
    )
    try:
        folder.mkdir(parents=True, exist_ok=True)
        (folder / f"{found.line.name}.toml").write_text(text, encoding="utf-8")
        (folder / f"{machine}.json").write_text(config, encoding="utf-8")
        for one in held:
            path = folder / f"lost-after-{one.held.accuracy_mm}.jsonl"
            write_steps(path, one.held.steps, machine=machine, first=one.held.first)
    except OSError as error:
        raise InputError(f"{folder}: cannot be written: {error}") from error
    err.print(str(folder / f"{found.line.name}.toml"), markup=False)


def _unkept(task: Task, tolerance_mm: int, why: str, *, quiet: bool) -> str:
    with Progressing(_QUESTIONS, quiet=quiet) as progress:
        progress.say("nearest tolerance", _QUESTIONS)
        nearest = nearest_kept(
            task,
            tolerance_mm,
            _NEAREST_SECONDS,
            lambda asked, kept: progress.tick(f"{asked / 1000:.3f} m: {'kept' if kept else 'not kept'}"),
        )
    start = (
        f"{task.line.name}: no choice of balise groups, reflectors and markers keeps {tolerance_mm / 1000:.3f} m{why}"
    )
    within = f"within {_NEAREST_SECONDS:g} s of processor time"
    if nearest.kept_mm is None:
        return f"{start}, nor any other tolerance up to 500 m{'' if nearest.searched else f' that was asked {within}'}."
    kept = f"{nearest.kept_mm / 1000:.3f} m"
    if not nearest.searched:
        return f"{start}; one keeps {kept}, and no nearer one was found {within}."
    return f"{start}; the nearest tolerance that one keeps is {kept}."


def _tolerance_mm(wanted: str) -> int:
    found = _TOLERANCE.fullmatch(wanted.replace(" ", ""))
    if found is None:
        raise typer.BadParameter(f"--for takes a tolerance, as tolerance=30m or tolerance=30000mm, not {wanted!r}.")
    number, unit = found.groups()
    millimetres = round(float(number) * 1000) if unit == "m" else float(number)
    if millimetres != int(millimetres) or millimetres < 1:
        raise typer.BadParameter(f"--for takes a tolerance of whole millimetres, at least 1 mm, not {wanted!r}.")
    return int(millimetres)


def _figures(model: type[_Figures], given: Sequence[str]) -> _Figures:
    """Return the figures with those that were given as NAME=VALUE."""
    values: dict[str, int] = {}
    for text in given:
        name, equals, value = text.partition("=")
        if name not in model.model_fields or not equals or not re.fullmatch(r"-?\d{1,12}", value):
            raise typer.BadParameter(f"{text!r}: give NAME=WHOLE NUMBER; there are {', '.join(model.model_fields)}.")
        values[name] = int(value)
    try:
        return model.model_validate(values)
    except ValidationError as error:
        first = error.errors()[0]
        raise typer.BadParameter(f"{'.'.join(map(str, first['loc']))}: {first['msg']}") from None
