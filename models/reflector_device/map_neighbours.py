"""The map's models on both sides of a group that a simulated vehicle reads."""

from __future__ import annotations

from collections.abc import Iterator

from safeloc.models.reflector.simulate import Reflector
from safeloc.runtime.streams.steps import Cell


def neighbours(
    reflectors: tuple[Reflector, ...], here_mm: int, *, along: bool, read: bool
) -> Iterator[tuple[str, Cell]]:
    """Yield what the map tells the direction in a cycle: the models before and after a group that is read; and the true direction.

    here_mm  the front end; places grow in the direction of travel
    along    the line's counting direction is that of the run
    read     a group is read in this cycle
    """
    behind = [one.model for one in reflectors if one.position_mm <= here_mm]
    ahead = [one.model for one in reflectors if one.position_mm > here_mm]
    sides = (behind[-1:], ahead[:1])
    for name, side in zip(("model_before", "model_after"), sides if along else sides[::-1], strict=True):
        yield name, side[0] if read and side else "NONE"
    yield "next_runs_along", along
