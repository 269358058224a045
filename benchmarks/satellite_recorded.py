"""Recorded signals of receivers at known points, disturbed on purpose, through the satellite chain.

A point that stands still is the degenerate track: a straight piece to the east through the known point, at rest in its
middle. What a signal is wrong by without the disturbance is its difference at the known point.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from benchmarks.satellite_tally import Cycle as Told
from safeloc.models.satellite.chain import ChainConfig, Cycle, EpochChain, Outcome, Reference
from safeloc.models.satellite.variables import ACCEPTED, FIX, SatelliteConfig
from safeloc.models.satellite_selection import SelectionConfig
from safeloc.sensing.satellite.android import read_android
from safeloc.sensing.satellite.channels import satellite_name
from safeloc.sensing.satellite.epochs import Epoch
from safeloc.sensing.satellite.navigation import Navigation, read_navigation
from safeloc.sensing.satellite.observations import read_observations
from safeloc.sensing.satellite.places import Place, Vector
from safeloc.sensing.satellite.residuals import Residuals, residuals
from safeloc.sensing.satellite.track_fit import slope_ppm
from safeloc.sensing.satellite.track_prediction import Portion
from safeloc.simulation.faults import Fault
from safeloc.simulation.satellite.disturbing import disturb

HALF_M = 300.0
REFERENCE_EPOCHS = 120
STILL: Vector = (0.0, 0.0, 0.0)


@dataclass(frozen=True)
class Recording:
    """Epochs with their ephemerides, the known point, and a configuration that fits the receiver."""

    name: str
    epochs: Sequence[Epoch]
    navigation: Navigation
    point: Place
    config: ChainConfig

    @property
    def east(self) -> Vector:
        """The direction of the degenerate track."""
        return -math.sin(self.point.longitude_rad), math.cos(self.point.longitude_rad), 0.0

    @property
    def track(self) -> Portion:
        """From 300 m west of the point to 300 m east of it."""
        x, y, z = self.point.earth_fixed_m()
        u, v, w = self.east
        ends = [(x + HALF_M * s * u, y + HALF_M * s * v, z + HALF_M * s * w) for s in (-1, 1)]
        return Portion(0.0, tuple(ends))


def geodetic(folder: Path) -> Recording:
    """Septentrio mosaic-X5, five minutes at 1 Hz; GPS, Galileo and QZSS on 1575.42 MHz."""
    at = folder / "gnss_septentrio"
    selection = SelectionConfig(
        channels=32, range_threshold_mm=11_000, range_noise_mm=5_000, range_prediction_mm=3_500, range_clock_mm=1_500,
        range_covariance_mm2=9_000_000, speed_threshold_mm_s=1_150, speed_noise_mm_s=300, speed_prediction_mm_s=700,
        speed_clock_mm_s=100, speed_covariance_mm2_s2=160_000,
    )  # fmt: skip
    return Recording(
        "geodetic",
        read_observations(at / "rover.obs"),
        read_navigation(at / "base.nav"),
        Place.degrees(35.13469901, 136.97757549, 104.8626),
        ChainConfig(satellite=_at_rest(selection, 30_000), window_epochs=3),
    )


def phone(folder: Path) -> Recording:
    """A phone on open ground, 223 epochs at 1 Hz, GPS alone, no ionosphere in its navigation file."""
    at = folder / "gnss_android"
    selection = SelectionConfig(
        range_threshold_mm=45_000, range_noise_mm=30_000, range_prediction_mm=3_500, range_clock_mm=10_000,
        range_covariance_mm2=100_000_000, speed_threshold_mm_s=2_000, speed_noise_mm_s=1_000, speed_prediction_mm_s=700,
        speed_clock_mm_s=200, speed_covariance_mm2_s2=1_000_000,
    )  # fmt: skip
    return Recording(
        "phone",
        read_android(at / "pseudoranges_log_2016_06_30_21_26_07.txt"),
        read_navigation(at / "hour1820.16n"),
        Place.degrees(37.422578, -122.081678, -28.0),
        ChainConfig(satellite=_at_rest(selection, 200_000), window_epochs=3),
    )


def _at_rest(selection: SelectionConfig, tolerance_mm: int) -> SatelliteConfig:
    """1 Hz, and a vehicle that may gain 0.25 m/s2."""
    return SatelliteConfig(
        selection=selection, period_ms=1_000, max_acceleration_mm_s2=250, tolerance_mm=tolerance_mm,
        protection_limit_mm=tolerance_mm,
    )  # fmt: skip


def truth(recording: Recording) -> list[Residuals]:
    """At the known point, without any disturbance."""
    return [residuals(epoch, recording.point, STILL, recording.navigation) for epoch in recording.epochs]


def slopes(recording: Recording, known: Sequence[Residuals]) -> Mapping[float, Mapping[str, float]]:
    """By an epoch's time: what a metre along the track does to every pseudorange."""
    return {
        epoch.time_s: {name: slope_ppm(one.direction, recording.east) / 1e6 for name, one in found.predictions.items()}
        for epoch, found in zip(recording.epochs, known, strict=True)
    }


def told(
    recording: Recording,
    known: Sequence[Residuals],
    disturbances: Sequence[Fault],
    chain_of: type[EpochChain] = EpochChain,
) -> Iterator[Told]:
    """The recording through the chain; the known point, at rest, is a reference at the beginning, and every two minutes."""
    by_time = slopes(recording, known)
    made = disturb(recording.epochs, disturbances, by_time.__getitem__)
    chain = chain_of(recording.config, recording.navigation, lambda *_: [recording.track])
    for number, (epoch, found, added) in enumerate(zip(made.epochs, known, made.error_m, strict=True)):
        reference = Reference(round(HALF_M * 1_000), 1_000, 0, 100) if number % REFERENCE_EPOCHS == 0 else None
        outcome = chain.step(Cycle(epoch, reference))
        errors = {name: found.pseudorange_m.get(name, 0.0) + added.get(name, 0.0) for name in outcome.standings}
        yield as_told(recording.config, outcome, round(HALF_M * 1_000), errors, added)


def as_told(
    config: ChainConfig, outcome: Outcome, truth_mm: int, error_m: Mapping[str, float], added_m: Mapping[str, float]
) -> Told:
    """A cycle for the tally: judged are the satellites that were compared, with a covariance."""
    outputs, inputs = outcome.outputs, outcome.inputs
    position, below, above = (
        int(outputs[f"position.{name}_mm"]) for name in ("position", "margin_below", "margin_above")
    )
    fix = inputs.get("position.fix_mm")
    judged = [name for name, standing in outcome.standings.items() if standing in ("USABLE", "EXCLUDED")]
    off_m = _differences_m(outcome, config.satellite.selection.channels)
    level_mm = 0
    if fix is not None:
        added_mm = int(inputs["position.fix_dilution_permille"]) * config.satellite.selection.usable_range_error_mm
        level_mm = math.ceil(added_mm / 1_000) + int(inputs["position.fix_further_mm"])
    return Told(
        truth_mm,
        (position - below, position, position + above) if outputs["position.valid"] else None,
        int(outputs["position.drift_bound_mm"]) if outputs["position.drift_checked"] else None,
        None if fix is None else (int(fix), level_mm),
        int(outputs["position.fix"]) == ACCEPTED.value,
        FIX[int(outputs["position.fix"])].label,
        outcome.usable,
        frozenset() if outcome.solution is None else outcome.solution.used,
        {name: error_m[name] for name in judged},
        added_m,
        {name: off_m[name] - error_m[name] for name in judged if name in off_m},
    )


def _differences_m(outcome: Outcome, channels: int) -> dict[str, float]:
    """Of every satellite whose pseudorange was compared: measured less predicted."""
    inputs, found = outcome.inputs, dict[str, float]()
    for channel in (f"selection.channel_{number}" for number in range(1, channels + 1)):
        if (off := inputs.get(f"{channel}_range_off_mm")) is not None:
            found[satellite_name(int(inputs[f"{channel}_satellite"]))] = int(off) / 1_000
    return found
