"""The nearest tolerance that some choice of references keeps, where the wanted one cannot be kept.

The smaller a tolerance is, the more places for references have to be considered: a question takes about four times as long for half of
it. So the greatest ones are asked first, and the search ends with what it has once its time is over.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from time import process_time

from pydantic import ValidationError

from safeloc.errors import InputError
from safeloc.models.layout_rules import LayoutConfig
from safeloc.railway.design.designing import Task, can_be_kept

_GREATEST_MM, _FIRST_STEP_MM = 500_000, 1_000


@dataclass(frozen=True)
class Nearest:
    """The nearest tolerance that was found to be kept, mm; None if none was. `searched`: the search came to its end."""

    kept_mm: int | None
    searched: bool


class _TimeOver(Exception):
    """The time of the search is over."""


def with_tolerance(layout: LayoutConfig, tolerance_mm: int) -> LayoutConfig:
    """Return the vehicle's figures with another tolerance; InputError if they do not go together."""
    try:
        return LayoutConfig.model_validate({**layout.model_dump(), "tolerance_mm": tolerance_mm})
    except ValidationError as error:
        why = error.errors(include_url=False)[0]["msg"].removeprefix("Value error, ").rstrip(".")
        raise InputError(f"the vehicle's figures do not go with it: {why}") from error


class _Search:
    def __init__(self, task: Task, limit_s: float, on_asked: Callable[[int, bool], None]) -> None:
        self._task, self._on_asked = task, on_asked
        self._limit_s, self._end_s = limit_s, process_time() + limit_s
        self.kept_mm: int | None = None

    def is_kept(self, tolerance_mm: int) -> bool:
        """Ask whether some choice keeps it. _TimeOver in place of an answer after the end of the time."""
        if process_time() > self._end_s:
            raise _TimeOver
        try:
            layout = with_tolerance(self._task.layout, tolerance_mm)
            found = can_be_kept(replace(self._task, layout=layout), self._limit_s)
        except InputError:
            found = False
        self._on_asked(tolerance_mm, found)
        if found:
            self.kept_mm = tolerance_mm
        return found

    def run(self, wanted_mm: int) -> None:
        """Ask greater ones, the greatest first; if none of them is kept, smaller ones."""
        unkept = wanted_mm
        for asked in _greater(wanted_mm):
            if not self.is_kept(asked) and self.kept_mm is not None:
                unkept = asked
                break
        below = wanted_mm
        while self.kept_mm is None and below > 1:
            below, unkept = below // 2, below
            self.is_kept(below)
        while self.kept_mm is not None and abs(self.kept_mm - unkept) > 1:
            middle = (self.kept_mm + unkept) // 2
            if not self.is_kept(middle):
                unkept = middle


def nearest_kept(
    task: Task, tolerance_mm: int, limit_s: float, on_asked: Callable[[int, bool], None] = lambda *_: None
) -> Nearest:
    """Return the tolerance next to an unkept one, in mm, that is kept: the next greater one first, else the next smaller one.

    limit_s   processor time of the search; it ends after the question that is beyond it
    on_asked  is told each tolerance that was asked, and whether it is kept
    Between a tolerance that is kept and one that is not the middle is asked, so it is the nearest one where all beyond it are kept.
    """
    search = _Search(task, limit_s, on_asked)
    try:
        search.run(tolerance_mm)
    except _TimeOver:
        return Nearest(search.kept_mm, searched=False)
    return Nearest(search.kept_mm, searched=True)


def _greater(tolerance_mm: int) -> Iterator[int]:
    """Yield greater tolerances, each about half as far away as the one before."""
    steps, away = [_GREATEST_MM], _FIRST_STEP_MM
    while tolerance_mm + away < _GREATEST_MM:
        steps.insert(1, tolerance_mm + away)
        away *= 2
    yield from (one for one in steps if one > tolerance_mm)
