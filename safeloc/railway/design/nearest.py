"""The nearest tolerance that some choice of references keeps, where the wanted one cannot be kept."""

from __future__ import annotations

from dataclasses import replace

from pydantic import ValidationError

from safeloc.errors import InputError
from safeloc.models.layout_rules import LayoutConfig
from safeloc.railway.design.designing import Task, can_be_kept

_GREATEST_MM = 500_000


def with_tolerance(layout: LayoutConfig, tolerance_mm: int) -> LayoutConfig | None:
    """Return the vehicle's figures with another tolerance; None if they do not go together."""
    try:
        return LayoutConfig.model_validate({**layout.model_dump(), "tolerance_mm": tolerance_mm})
    except ValidationError:
        return None


def is_kept(task: Task, tolerance_mm: int, seconds: float) -> bool:
    """Return whether some choice of references keeps this tolerance."""
    layout = with_tolerance(task.layout, tolerance_mm)
    if layout is None:
        return False
    try:
        return can_be_kept(replace(task, layout=layout), seconds)
    except InputError:
        return False


def nearest_kept(task: Task, tolerance_mm: int, seconds: float) -> int | None:
    """Return the tolerance next to an unkept one, in mm, that is kept: the next greater one first, else the next smaller one.

    Between a tolerance that is kept and one that is not the middle is asked, so it is the nearest one where all beyond it are kept.
    """
    kept, step = tolerance_mm, 1_000
    while kept < _GREATEST_MM:
        kept, below = min(kept + step, _GREATEST_MM), kept
        if is_kept(task, kept, seconds):
            return _between(task, below, kept, seconds)
        step *= 2
    kept = tolerance_mm
    while kept > 1:
        kept, above = kept // 2, kept
        if is_kept(task, kept, seconds):
            return _between(task, above, kept, seconds)
    return None


def _between(task: Task, unkept: int, kept: int, seconds: float) -> int:
    while abs(kept - unkept) > 1:
        middle = (kept + unkept) // 2
        if is_kept(task, middle, seconds):
            kept = middle
        else:
            unkept = middle
    return kept
