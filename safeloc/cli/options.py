"""Arguments and options that several commands share."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Annotated, Literal

import typer

from safeloc.errors import InputError
from safeloc.proof.provers.limits import CLOCK

TargetArgument = Annotated[
    str, typer.Argument(help="a name from `safeloc list`, or package.module:name, or file.py:name")
]
ConfigOption = Annotated[Path | None, typer.Option("--config", help="TOML or JSON with the machine's configuration")]
JsonOption = Annotated[bool, typer.Option("--json", help="print JSON only (schema safeloc-report/5)")]
DepthOption = Annotated[int, typer.Option(help="steps of bounded search", min=1)]


def _finite(seconds: float) -> float:
    if not math.isfinite(seconds):
        raise typer.BadParameter(f"{seconds} is no time limit; give a number of seconds.")
    return seconds


SecondsOption = Annotated[
    float,
    typer.Option(
        help=f"limit of effort for each property, in seconds of an idle computer; the clock ends it after {CLOCK:g} times that",
        min=0.1,
        callback=_finite,
    ),
]
JobsOption = Annotated[int, typer.Option(help="processes", min=1)]
SeedOption = Annotated[int, typer.Option(help="seed of solvers and random runs")]
ExamplesOption = Annotated[int, typer.Option(help="property-test runs", min=1)]
SingleOption = Annotated[bool, typer.Option("--single-file", help="write one self-contained page")]
StepsOption = Annotated[int, typer.Option(help="steps of each property-test run", min=1)]
_Direction = Literal["increasing", "decreasing"]


def direction(given: str | None) -> _Direction | None:
    """Return the value of --first: increasing, decreasing or None. InputError for anything else."""
    match given:
        case None | "increasing" | "decreasing":
            return given
        case _:
            raise InputError(f"--first {given!r}: choose increasing or decreasing.")
