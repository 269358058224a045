"""The models of reflectors that a simulated vehicle meets: those that it passes and sees ahead, and the map's neighbours of a group."""

from __future__ import annotations

from collections.abc import Iterator

from safeloc.models.reflector.simulate import Reflector
from safeloc.runtime.streams.steps import Cell

_SEEN_MM = 100_000
"""A reflector is recognised from this distance on."""


def met_models(
    reflectors: tuple[Reflector, ...], last_mm: int, here_mm: int, *, along: bool, read: bool
) -> Iterator[tuple[str, Cell]]:
    """Yield what the direction hears in a cycle: the reflectors passed and ahead, and the map's neighbours of a group that is read.

    last_mm, here_mm  the front end after the last cycle and after this one; places grow in the direction of travel
    along             the line's counting direction is that of the run
    read              a group is read in this cycle
    """
    behind = [one for one in reflectors if one.position_mm <= here_mm]
    ahead = [one for one in reflectors if one.position_mm > here_mm]
    passed = [one for one in behind if one.position_mm > last_mm]
    near = [one for one in ahead if one.position_mm - here_mm <= _SEEN_MM]
    sides = (behind[-1:], ahead[:1])
    yield "passed_model", _model(passed[-1:])
    yield "ahead_model", _model(near[:1])
    for name, side in zip(("model_before", "model_after"), sides if along else sides[::-1], strict=True):
        yield name, _model(side if read else [])
    yield "next_runs_along", along


def _model(reflectors: list[Reflector]) -> str:
    return reflectors[0].model if reflectors else "NONE"
