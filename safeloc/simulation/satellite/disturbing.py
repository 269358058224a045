"""Puts faults into recorded epochs, and returns the errors added to each satellite.

Step, ramp and wave are errors of the pseudorange and of the rate that belongs to it; `code_only` leaves the rate unchanged (an
echo shifts the code, but hardly the rate of the carrier). A false place shifts pseudoranges and rates by the slope of each
satellite; silence removes measurements. Nothing else of a recording is changed.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace

from safeloc.errors import InputError
from safeloc.language.units import MS_PER_S
from safeloc.sensing.satellite.epochs import Epoch, Measured
from safeloc.simulation.faults import Fault, Figure, Kinds

Slopes = Callable[[float], Mapping[str, float]]
"""Time of an epoch -> slope of each satellite: the change of its pseudorange per metre along the track."""


_ALWAYS = {"size_m": 0.0, "code_only": False}
KINDS = Kinds(
    "a recording of satellites",
    {
        "step": _ALWAYS,
        "ramp": _ALWAYS,
        "wave": {**_ALWAYS, "period_s": 10.0},
        "false place": _ALWAYS,
        "silence": {"period_s": 10.0, "silent_s": 3.0},
    },
)
"""Faults of one satellite or several (of all if none is named), in ms of the recording; an end is required.

size_m       height of a step or wave; final size of a ramp or false place
code_only    the rate stays unchanged
period_s     period of a wave, or of silence, which lasts for the last `silent_s` of every period
"""


def _require(faults: Sequence[Fault]) -> None:
    KINDS.require(faults)
    for fault in faults:
        if fault.end is None or not all(map(_is_finite, fault.figures.values())):
            raise InputError(f"{fault}: give its end, and figures that are numbers.")
        if fault.kind == "silence" and not 0 < _figure(fault, "silent_s") < _figure(fault, "period_s"):
            raise InputError(f"{fault}: silent_s has to be a part of period_s.")


def _is_finite(figure: Figure) -> bool:
    return isinstance(figure, (int, float)) and math.isfinite(figure)


def _active(fault: Fault, time_s: float) -> bool:
    return fault.end is not None and fault.begin / MS_PER_S <= time_s < fault.end / MS_PER_S


def _figure(fault: Fault, name: str) -> float:
    return float(KINDS.figure(fault, name))


def _error(fault: Fault, time_s: float, slope: float) -> tuple[float, float]:
    """Return the errors that the fault adds, m and m/s."""
    assert fault.end is not None
    begin_s, size_m = fault.begin / MS_PER_S, _figure(fault, "size_m")
    since, length = time_s - begin_s, fault.end / MS_PER_S - begin_s
    match fault.kind:
        case "step":
            return size_m, 0.0
        case "ramp":
            added, rate = size_m * since / length, size_m / length
        case "wave":
            angle = 2 * math.pi / _figure(fault, "period_s")
            added, rate = size_m * math.sin(angle * since), size_m * angle * math.cos(angle * since)
        case _:
            added, rate = slope * size_m * since / length, slope * size_m / length
    return added, 0.0 if KINDS.figure(fault, "code_only") else rate


def _silences(fault: Fault, time_s: float) -> bool:
    """Return whether the fault removes the measurement."""
    if fault.kind != "silence":
        return False
    period = _figure(fault, "period_s")
    return (time_s - fault.begin / MS_PER_S) % period >= period - _figure(fault, "silent_s")


@dataclass(frozen=True)
class Disturbed:
    """The epochs, and for each the errors added to pseudorange (m) and rate (m/s) of every disturbed satellite."""

    epochs: tuple[Epoch, ...]
    error_m: tuple[Mapping[str, float], ...]
    error_m_per_s: tuple[Mapping[str, float], ...]


def disturb(epochs: Sequence[Epoch], disturbances: Sequence[Fault], slopes: Slopes | None = None) -> Disturbed:
    """Put the faults into the epochs; times count from the first epoch.

    slopes  needed for a false place
    InputError for a false place without slopes, and for a fault that no recording can have.
    """
    _require(disturbances)
    if slopes is None and any(one.kind == "false place" for one in disturbances):
        raise InputError("a false place lies along the track: give the slopes of the satellites.")
    made = [_epoch(epoch, epoch.time_s - epochs[0].time_s, disturbances, slopes) for epoch in epochs]
    return Disturbed(
        tuple(one for one, _, _ in made), tuple(codes for _, codes, _ in made), tuple(rates for _, _, rates in made)
    )


def _epoch(
    epoch: Epoch, time_s: float, disturbances: Sequence[Fault], slopes: Slopes | None
) -> tuple[Epoch, dict[str, float], dict[str, float]]:
    struck = {
        name: [one for one in disturbances if one.strikes(name) and _active(one, time_s)] for name in epoch.satellites
    }
    known = slopes(epoch.time_s) if slopes and any(struck.values()) else {}
    codes, rates, kept = dict[str, float](), dict[str, float](), dict[str, Measured]()
    for name, measured in epoch.satellites.items():
        if any(_silences(one, time_s) for one in struck[name]):
            continue
        added = [_error(one, time_s, known.get(name, 0.0)) for one in struck[name] if one.kind != "silence"]
        kept[name] = _shifted(measured, sum(code for code, _ in added), sum(rate for _, rate in added))
        if added:
            codes[name], rates[name] = sum(code for code, _ in added), sum(rate for _, rate in added)
    return replace(epoch, satellites=kept), codes, rates


def _shifted(measured: Measured, code_m: float, rate_m_per_s: float) -> Measured:
    """Return the values with the errors; None stays None."""
    return Measured(
        None if measured.pseudorange_m is None else measured.pseudorange_m + code_m,
        None if measured.rate_m_per_s is None else measured.rate_m_per_s + rate_m_per_s,
    )
