"""Disturbances put on recorded epochs, with the truth of which satellite was disturbed when, and by how much.

Step, ramp and wave are errors of the pseudorange with the rate that belongs to them; `code_only` leaves the rate as it was
(an echo bends the code, and the carrier's rate hardly). A false place drags pseudoranges and rates along the satellite's
own slope; silence takes measurements away. Nothing else of a recording is changed.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Literal

from safeloc.errors import InputError
from safeloc.sensing.satellite.epochs import Epoch, Measured

Kind = Literal["step", "ramp", "wave", "false place", "silence"]
Slopes = Callable[[float], Mapping[str, float]]
"""From an epoch's time: the slope of each satellite, the change of its pseudorange per metre along the track."""


@dataclass(frozen=True)
class Disturbance:
    """One fault of some satellites (empty: all), from `from_s` to before `to_s`, in s of the recording.

    size_m       height of a step or wave; what a ramp or a false place has reached at its end
    period_s     of a wave, or of a cycle of silence; silent for the last `silent_s` of every cycle
    code_only    the rate stays as it was
    """

    kind: Kind
    from_s: float
    to_s: float
    size_m: float = 0.0
    satellites: frozenset[str] = frozenset()
    period_s: float = 10.0
    silent_s: float = 3.0
    code_only: bool = False

    def __post_init__(self) -> None:
        figures = (self.from_s, self.to_s, self.size_m, self.period_s, self.silent_s)
        if not all(map(math.isfinite, figures)) or not self.from_s < self.to_s:
            raise InputError(
                f"a {self.kind} from {self.from_s} s to {self.to_s} s of {self.size_m} m is none; mend it."
            )
        if not 0 < self.silent_s < self.period_s:
            raise InputError(f"{self.silent_s} s of every {self.period_s} s: give a part of the cycle.")

    def strikes(self, satellite: str, time_s: float) -> bool:
        """Whether it acts on a satellite now."""
        return self.from_s <= time_s < self.to_s and (not self.satellites or satellite in self.satellites)

    def error(self, time_s: float, slope: float) -> tuple[float, float]:
        """What it adds: m, m/s."""
        since, length = time_s - self.from_s, self.to_s - self.from_s
        match self.kind:
            case "step":
                return self.size_m, 0.0
            case "ramp":
                added, rate = self.size_m * since / length, self.size_m / length
            case "wave":
                angle = 2 * math.pi / self.period_s
                added, rate = self.size_m * math.sin(angle * since), self.size_m * angle * math.cos(angle * since)
            case "false place":
                added, rate = slope * self.size_m * since / length, slope * self.size_m / length
            case "silence":
                return 0.0, 0.0
        return added, 0.0 if self.code_only else rate

    def silences(self, time_s: float) -> bool:
        """Whether it takes the measurement away."""
        return self.kind == "silence" and (time_s - self.from_s) % self.period_s >= self.period_s - self.silent_s


@dataclass(frozen=True)
class Disturbed:
    """The epochs, and of each epoch what was added to the pseudorange (m) and rate (m/s) of every satellite struck."""

    epochs: tuple[Epoch, ...]
    error_m: tuple[Mapping[str, float], ...]
    error_m_per_s: tuple[Mapping[str, float], ...]


def disturb(epochs: Sequence[Epoch], disturbances: Sequence[Disturbance], slopes: Slopes | None = None) -> Disturbed:
    """Times count from the first epoch. InputError for a false place without slopes: it needs the track."""
    if slopes is None and any(one.kind == "false place" for one in disturbances):
        raise InputError("a false place lies along the track: give the slopes of the satellites.")
    made = [_epoch(epoch, epoch.time_s - epochs[0].time_s, disturbances, slopes) for epoch in epochs]
    return Disturbed(
        tuple(one for one, _, _ in made), tuple(codes for _, codes, _ in made), tuple(rates for _, _, rates in made)
    )


def _epoch(
    epoch: Epoch, time_s: float, disturbances: Sequence[Disturbance], slopes: Slopes | None
) -> tuple[Epoch, dict[str, float], dict[str, float]]:
    struck = {name: [one for one in disturbances if one.strikes(name, time_s)] for name in epoch.satellites}
    known = slopes(epoch.time_s) if slopes and any(struck.values()) else {}
    codes, rates, kept = dict[str, float](), dict[str, float](), dict[str, Measured]()
    for name, measured in epoch.satellites.items():
        if any(one.silences(time_s) for one in struck[name]):
            continue
        added = [one.error(time_s, known.get(name, 0.0)) for one in struck[name] if one.kind != "silence"]
        kept[name] = _shifted(measured, sum(code for code, _ in added), sum(rate for _, rate in added))
        if added:
            codes[name], rates[name] = sum(code for code, _ in added), sum(rate for _, rate in added)
    return replace(epoch, satellites=kept), codes, rates


def _shifted(measured: Measured, code_m: float, rate_m_per_s: float) -> Measured:
    """None stays None."""
    return Measured(
        None if measured.pseudorange_m is None else measured.pseudorange_m + code_m,
        None if measured.rate_m_per_s is None else measured.rate_m_per_s + rate_m_per_s,
    )
