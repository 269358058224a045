"""A run at the limits of what is assumed: every reading, and every distance, is as wrong as the laws of the world allow."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from safeloc.language.units import NM_PER_MM
from safeloc.models.balise.groups import Group, telegram
from safeloc.models.unlinked_group.variables import UnlinkedGroupConfig
from safeloc.proof.drawn_runs.worked import Steps
from safeloc.runtime.streams.steps import Cell

_MEASURED_MM = (0, 50, 50, 0, -50, -50, 0, None, 0)
"""Distances of the cycles in which groups are read, from cycle to cycle no farther apart than a vehicle can brake."""
_COUNTED_MM = 2_000
PLACE = ("telegram_position_mm", "telegram_orientation")


def at_the_limits(config: UnlinkedGroupConfig) -> Steps:
    """Return the run: forwards, standing, backwards and without a distance, with every error at either end of its law."""
    steps: Steps = []
    wander, half = 0, config.odometer.wander_nm
    for side in (1, -1):
        for distance in _MEASURED_MM:
            for read in _readings(config, side):
                slipped = 0 if distance is None else _towards(side * half, wander)
                wander += slipped
                moved = _moved(config, distance, side, slipped)
                if _taken_in_cycle(config, read):
                    read["true_since_nm"] = _farthest_in_cycle(config, side, int(moved["true_cycle_distance_nm"]))
                since = int(read["true_since_nm"]) + (wander + side * half if "telegram_since_mm" in read else 0)
                steps.append(moved | read)
                steps[-1] |= {
                    "telegram_group": len(steps),
                    "true_since_nm": since,
                    "reading_wander_nm": -side * half,
                    "odometer_next_wander_nm": wander,
                }
    return steps


def _taken_in_cycle(config: UnlinkedGroupConfig, read: Mapping[str, Cell]) -> bool:
    """Return whether a reading without a counter was taken in its cycle."""
    return "telegram_since_mm" not in read and int(read["telegram_age_ms"]) <= config.period_ms


def _farthest_in_cycle(config: UnlinkedGroupConfig, side: int, ran_nm: int) -> int:
    """Return the farthest run to one side since a reading of the cycle, in which the vehicle ran `ran_nm`, nm."""
    return side * (max(0, side * ran_nm) + config.measuring_step_mm * NM_PER_MM)


def _towards(wanted: int, wander: int) -> int:
    """Return the change of the one-off error in a cycle: to the limit, from the other limit by way of zero."""
    return -wander if wander * wanted < 0 else wanted - wander


def _moved(config: UnlinkedGroupConfig, distance: int | None, side: int, slipped: int) -> dict[str, Cell]:
    """Return a distance that is wrong by its rate and a slip, nm, or the farthest run where nothing is measured."""
    if distance is None:
        return {"true_cycle_distance_nm": side * config.max_speed_mm_s * config.period_ms * 1_000}
    error = side * abs(distance) * config.odometer.rate_ppm
    return {"odometer_mm": distance, "true_cycle_distance_nm": distance * NM_PER_MM + error + slipped}


def _readings(config: UnlinkedGroupConfig, side: int) -> Iterator[dict[str, Cell]]:
    """Yield readings with a counter, then one of this cycle and an older one without; the run since then without one-off errors."""
    for since in (_COUNTED_MM, -_COUNTED_MM):
        off = side * abs(since) * config.odometer.rate_ppm
        yield _reading(config, side, config.period_ms, since) | {"true_since_nm": since * NM_PER_MM + off}
    for age in (config.period_ms, config.period_ms + 1):
        run = side * (age * config.max_speed_mm_s * 1_000 + config.measuring_step_mm * NM_PER_MM)
        yield _reading(config, side, age, None) | {"true_since_nm": run}


def _reading(config: UnlinkedGroupConfig, side: int, age_ms: int, since_mm: int | None) -> dict[str, Cell]:
    read = telegram(Group(1, 0, balises=2, linked=False), age_ms=age_ms, since_mm=since_mm)
    inputs = {name: value for name, value in read.items() if name not in PLACE}
    return {**inputs, "read_beyond_nm": side * config.detection_mm * NM_PER_MM}
