"""Inputs of the axle counters at both ends of a simulated area: the sweep before anything is clear, and every axle that passes."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from safeloc.models.axle_section import AxleSectionConfig
from safeloc.models.axle_section.simulate import QUIET, RESET, Event, happened, quiet, through
from safeloc.runtime.streams.steps import Cell

_PASSES = ("axles_in_low", "axles_out_low", "axles_in_high", "axles_out_high")


def sweep(config: AxleSectionConfig) -> list[dict[str, Cell]]:
    """Return the steps from power-up until the counters are clear: a trolley of four axles runs through on sight, which no fibre hears."""
    report = Event({"sweep_reported_clear": True})
    return happened([quiet(config.lead_cycles), RESET, *through(4, 1, sweeps=True), quiet(1), report])


def passed(before: Sequence[float], now: Sequence[float], ends: tuple[float, float]) -> dict[str, int]:
    """Return how many axles passed each end, in and out, from the places of all axles before and after the cycle."""
    made = dict.fromkeys(_PASSES, 0)
    for then, here in zip(before, now, strict=True):
        for end, place, up in (("low", ends[0], "in"), ("high", ends[1], "out")):
            if (then <= place) != (here <= place):
                way = up if here > then else {"in": "out", "out": "in"}[up]
                made[f"axles_{way}_{end}"] += 1
    return made


def come_in(whose: str, passes: Mapping[str, int]) -> dict[str, Cell]:
    """Return how many axles of the train ("own") or of others ("other") came in at either end, less those that went out."""
    return {
        f"entry.{whose}_axles_{end}": passes[f"axles_in_{end}"] - passes[f"axles_out_{end}"] for end in ("low", "high")
    }


def heads(counted: Mapping[str, int], true: Mapping[str, int]) -> dict[str, Cell]:
    """Return the inputs of the axle section: axles counted, and those that really passed."""
    truth = {f"true_{name}": number for name, number in true.items()}
    cells: dict[str, Cell] = {**QUIET, **counted, **truth, "true_sweep_passes": "NO_HEAD"}
    return {f"axle_section.{name}": cell for name, cell in cells.items()}


def inside(places: Sequence[float], ends: tuple[float, float]) -> int:
    """Return how many axles are between both ends."""
    return sum(ends[0] < place <= ends[1] for place in places)
