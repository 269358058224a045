"""The map's models on both sides of a group that a simulated vehicle reads."""

from __future__ import annotations

from collections.abc import Iterator

from safeloc.models.reflector.simulate import Reflector
from safeloc.runtime.streams.steps import Cell


def neighbours(reflectors: tuple[Reflector, ...], group_mm: int | None, *, along: bool) -> Iterator[tuple[str, Cell]]:
    """Yield what the map tells the direction in a cycle: the models before and after a group that is read; and the true direction.

    group_mm  place of the group; None: none is read. Places grow in the direction of travel
    along     the line's counting direction is that of the run
    """
    before = [one.model for one in reflectors if group_mm is not None and one.position_mm <= group_mm]
    after = [one.model for one in reflectors if group_mm is not None and one.position_mm > group_mm]
    sides = (before[-1:], after[:1]) if along else (after[:1], before[-1:])
    for name, side in zip(("model_before", "model_after"), sides, strict=True):
        yield name, side[0] if side else "NONE"
    yield "next_runs_along", along
