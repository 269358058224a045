"""Assigns satellites to the channels of the selection machine, and makes the inputs of each cycle.

A satellite keeps its channel while it is in view, since its warm-up counts there; a new one takes the lowest free channel.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence, Set
from dataclasses import dataclass

from safeloc.errors import InputError
from safeloc.language.units import MM_PER_M
from safeloc.runtime.border import Fault, Reason
from safeloc.sensing.rounding import exactly
from safeloc.sensing.satellite.residuals import Residuals
from safeloc.sensing.satellite.windows import Window

_CONSTELLATIONS = "GRECJIS"
"""In RINEX order: GPS, GLONASS, Galileo, BeiDou, QZSS, NavIC, SBAS; each has a hundred identities."""
FARTHEST_MM, _FASTEST_MM_S, _WIDEST = 10**9, 10**8, 10**15
ChannelValues = dict[str, int | bool]


def identity(satellite: str) -> int:
    """Return a whole number for a satellite named as in RINEX: G05 is 5, E05 is 205. InputError for another name."""
    number = satellite[1:]
    if (
        satellite[:1] not in tuple(_CONSTELLATIONS)
        or not (number.isascii() and number.isdecimal())
        or not 0 < int(number) < 100
    ):
        raise InputError(
            f"{satellite!r} is no satellite; name it by constellation ({_CONSTELLATIONS}) and number, G05."
        )
    return _CONSTELLATIONS.index(satellite[0]) * 100 + int(number)


def satellite_name(number: int) -> str:
    """Return the name of an identity: 205 is E05. InputError for a number that is no identity."""
    constellation, within = divmod(number, 100)
    if number < 1 or within == 0 or constellation >= len(_CONSTELLATIONS):
        raise InputError(f"{number} is no identity of a satellite.")
    return f"{_CONSTELLATIONS[constellation]}{within:02d}"


@dataclass(frozen=True)
class Received:
    """The selection's inputs in a cycle by the names of its variables, the channel of every satellite, and faults."""

    inputs: ChannelValues
    channels: Mapping[str, int]
    faults: tuple[Fault, ...]


@dataclass(frozen=True, slots=True)
class Differences:
    """Differences of one look by satellite, in whole mm and mm/s, and what was left out."""

    off_mm: Mapping[str, int]
    speed_off_mm_s: Mapping[str, int]
    faults: tuple[Fault, ...]


def differences(look: Residuals) -> Differences:
    """Return the residuals in whole mm and mm/s, rounded away from zero. One that is not finite or too great is a fault."""
    faults: list[Fault] = []
    codes = _as_integers(look.pseudorange_m, FARTHEST_MM, faults)
    return Differences(codes, _as_integers(look.rate_m_per_s, _FASTEST_MM_S, faults), tuple(faults))


class Channels:
    """The channels with their windows. Call `hear` once in every cycle. InputError for fewer than one channel."""

    def __init__(self, count: int, window_epochs: int) -> None:
        if count < 1:
            raise InputError(f"{count} channels receive nothing; give at least one.")
        self._held: list[str | None] = [None] * count
        self._window_epochs = window_epochs
        self._windows: dict[str, tuple[Window, Window]] = {}

    def hear(self, visible: Set[str], valid: Set[str], looks: Sequence[Residuals]) -> Received:
        """Return the channel inputs for the visible satellites (LSV).

        valid   satellites with a valid ephemeris
        looks   residuals on every possible portion of track; empty without a prediction. The greatest difference of all
                counts, so a satellite has to fit on each portion.
        """
        without_channel = self._assign(visible)
        faults = [Fault(name, Reason.SURPLUS, "no free channel") for name in without_channel]
        every = [differences(look) for look in looks]
        faults += [fault for one in every for fault in one.faults]
        codes, rates = [one.off_mm for one in every], [one.speed_off_mm_s for one in every]
        inputs: ChannelValues = {}
        channels: dict[str, int] = {}
        for number, name in enumerate(self._held, 1):
            inputs[f"channel_{number}_ephemeris_valid"] = name in valid
            if name is not None:
                channels[name] = number
                inputs |= self._inputs(f"channel_{number}", name, _worst(codes, name), _worst(rates, name))
        faults += [Fault(name, Reason.STALE, "no valid ephemeris") for name in sorted(visible - valid)]
        return Received(inputs, channels, tuple(dict.fromkeys(faults)))

    def _assign(self, visible: Set[str]) -> list[str]:
        """Give every visible satellite a channel; return those for which none is free."""
        self._held = [name if name in visible else None for name in self._held]
        self._windows = {name: both for name, both in self._windows.items() if name in visible}
        waiting = sorted(visible - set(self._held))
        for number, name in enumerate(self._held):
            if name is None and waiting:
                self._held[number] = waiting.pop(0)
        return waiting

    def _inputs(self, channel: str, name: str, off: int | None, speed_off: int | None) -> ChannelValues:
        both = self._windows.setdefault(name, (Window(self._window_epochs), Window(self._window_epochs)))
        values = {
            "satellite": identity(name),
            "range_off_mm": off,
            "speed_off_mm_s": speed_off,
            "range_covariance_mm2": _narrow(both[0].add(off)),
            "speed_covariance_mm2_s2": _narrow(both[1].add(speed_off)),
        }
        return {f"{channel}_{key}": value for key, value in values.items() if value is not None}


def _as_integers(values: Mapping[str, float], most: int, faults: list[Fault]) -> dict[str, int]:
    """Return differences in whole mm or mm/s, rounded away from zero. One that is not finite or too great is a fault."""
    found: dict[str, int] = {}
    for name, value in values.items():
        if not math.isfinite(value):
            faults.append(Fault(name, Reason.NOT_FINITE, repr(value)))
        elif exactly(abs(value)) * MM_PER_M > most:
            faults.append(
                Fault(name, Reason.OUT_OF_RANGE, f"{value} differs from the prediction by more than the input's range")
            )
        else:
            exact = exactly(value) * MM_PER_M
            found[name] = math.ceil(exact) if value > 0 else math.floor(exact)
    return found


def _worst(looks: Sequence[Mapping[str, int]], name: str) -> int | None:
    """Return the greatest difference of all looks; None if one of them has none."""
    if not looks or any(name not in look for look in looks):
        return None
    return max((look[name] for look in looks), key=abs)


def _narrow(covariance: int | None) -> int | None:
    """Return None for a covariance beyond the input's range: such a satellite is not usable either way."""
    return None if covariance is None or covariance > _WIDEST else covariance
