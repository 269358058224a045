"""Converts a frame's echoes to the inputs of a reflector machine's step.

Reflectors come before echoes without a model, each strongest first: near clutter is stronger than a distant reflector, and a
machine with few slots must not lose the reflector because of it. Echoes without a slot are reported.
"""

from __future__ import annotations

from dataclasses import dataclass

from safeloc.errors import InputError
from safeloc.sensing.along_track import Delay, distance_now, lateral
from safeloc.sensing.echoes import Echo
from safeloc.sensing.figures import RadarConfig
from safeloc.sensing.images import NoFrame
from safeloc.sensing.radar import Outcome
from safeloc.sensing.rounding import outward
from safeloc.sensing.signature import Model

_NO_MODEL = "NONE"
StepValues = dict[str, int | bool | str]


@dataclass(frozen=True)
class StepInputs:
    """The inputs of a step.

    inputs   values by input name
    dropped  echoes without a slot, and those that the vehicle has presumably passed
    missing  why there is no frame; None if there is one
    """

    inputs: StepValues
    dropped: tuple[Echo, ...]
    missing: NoFrame | None


def step_inputs(outcome: Outcome, config: RadarConfig, delay: Delay, slots: int = 2) -> StepInputs:
    """Return `frame_present`, and for the first `slots` echoes `echo_1_range_mm`, `_error_mm`, `_model`, `_intensity_cdb`
    (below full scale) and `_lateral_mm` (positive to the left).

    Ranges are distances along the track at the end of the delay. For a machine that adds the error of the frame's age itself,
    give an age of 0 (the speeds still compensate the Doppler shift).
    """
    if slots < 1:
        raise InputError(f"a machine has at least one slot for echoes; got {slots}.")
    if isinstance(outcome, NoFrame):
        return StepInputs({"frame_present": False}, (), outcome)
    inputs: StepValues = {"frame_present": True}
    dropped: list[Echo] = []
    used = 0
    for echo in sorted(outcome.echoes, key=_rank):
        values = _values(f"echo_{used + 1}", echo, config, delay) if used < slots else None
        if values is None:
            dropped.append(echo)
        else:
            inputs |= values
            used += 1
    return StepInputs(inputs, tuple(dropped), None)


def _rank(echo: Echo) -> tuple[bool, int, int]:
    return echo.model is Model.UNKNOWN, -echo.intensity_cdb, echo.range_mm


def _values(name: str, echo: Echo, config: RadarConfig, delay: Delay) -> StepValues | None:
    """Return the inputs of one echo; None if the vehicle has presumably passed it."""
    range_mm, error_mm = outward(distance_now(echo, config, delay))
    if range_mm < 0:
        return None
    return {
        f"{name}_range_mm": range_mm,
        f"{name}_error_mm": error_mm,
        f"{name}_model": _NO_MODEL if echo.model is Model.UNKNOWN else echo.model.value,
        f"{name}_intensity_cdb": echo.intensity_cdb - config.sensor.full_scale_cdb,
        f"{name}_lateral_mm": outward(lateral(echo, config, delay))[0],
    }
