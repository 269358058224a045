"""Simulates the epochs of a receiver on a train, with the true motion and the true errors of the signals."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np

from safeloc.errors import InputError
from safeloc.language.units import MS_PER_S, NM_PER_M
from safeloc.sensing.array_types import Flags, Floats
from safeloc.sensing.satellite.epochs import Epoch, Measured
from safeloc.sensing.satellite.navigation import Navigation
from safeloc.sensing.satellite.places import Place
from safeloc.sensing.satellite.track_prediction import Portion
from safeloc.simulation.faults import Fault, Kinds
from safeloc.simulation.motion import Motion
from safeloc.simulation.satellite.ranges import Seen, orbits, seen
from safeloc.simulation.satellite.receiver import (
    Healthy,
    ReceiverConfig,
    air_m,
    clock,
    code_of,
    healthy,
    rate_of,
    system_times_m,
)
from safeloc.simulation.satellite.scenery import Rays, Received, Scene, received

_LOWEST_RAD = math.radians(5)
"""A receiver tracks no satellite below this elevation."""


KINDS = Kinds(
    "a sky",
    {
        "false place": {"drift_m_per_s": 1.0, "gathering_m_per_s2": 0.05},
        "silence": {"period_s": 10.0, "silent_s": 3.0},
    },
)
"""Faults of one satellite or several (of all if none is named), in ms from the run's beginning.

false place  spoofed signals fit a place that leaves the true one along the track, up to the speed `drift_m_per_s`
silence      of every cycle of `period_s`, counted from `begin`, nothing is received in the last `silent_s`
"""


@dataclass(frozen=True)
class World:
    """A sky, a track with the scenes beside it, a receiver, and the faults of the signals."""

    navigation: Navigation
    track: Portion
    scenes: tuple[Scene, ...] = ()
    receiver: ReceiverConfig = field(default_factory=ReceiverConfig)
    faults: tuple[Fault, ...] = ()


@dataclass(frozen=True)
class Truth:
    """One epoch: true GPS time (s), place (m) and speed (m/s) along the track.

    error_m, error_m_per_s  errors of every measured satellite from detours, echoes and false places
    healthy_m, healthy_m_per_s  errors of every measured satellite that healthy signals have too
    elevation_rad           of every measured satellite
    reflected               satellites received by a detour only
    """

    time_s: float
    place_m: float
    speed_m_per_s: float
    error_m: Mapping[str, float]
    error_m_per_s: Mapping[str, float]
    healthy_m: Mapping[str, float]
    healthy_m_per_s: Mapping[str, float]
    elevation_rad: Mapping[str, float]
    reflected: frozenset[str]


@dataclass(frozen=True)
class SimulatedRun:
    """The receiver's measurements and the true values, epoch by epoch."""

    epochs: tuple[Epoch, ...]
    truth: tuple[Truth, ...]
    navigation: Navigation


def simulate(world: World, motion: Motion, *, seed: int) -> SimulatedRun:
    """Simulate the motion's epochs from the orbits' start on. InputError beyond the ends of track or orbits, and for a
    fault that would test nothing."""
    KINDS.require(world.faults, length=len(motion.position_nm) * motion.period_ms)
    rng = np.random.default_rng(seed)
    sky = orbits(world.navigation.ephemerides)
    times = np.arange(1, len(motion.position_nm) + 1) * motion.period_ms / 1_000
    place, speed = motion.position_nm / NM_PER_M, motion.speed_mm_s / 1_000
    antenna = _Antenna(world.track, place)
    true = seen(sky, times, antenna.points, antenna.along * speed[:, None])
    sights = _sights(world, sky.start_s, antenna, true, times)
    rays = Rays(sights.elevation, sights.azimuth - antenna.heading(), place, speed)
    got = received(world.scenes, rays, rng)
    usual = healthy(world.receiver, times, sights.elevation, rng)
    false_m, false_rate = _spoofed(world, antenna, true, times, sky.names)
    one, systems_m = clock(world.receiver, times, rng), system_times_m(world.receiver, sky.names, rng)
    error, error_rate = got.error_m + false_m, got.error_m_per_s + false_rate
    codes = code_of(true.way_m + systems_m + sights.air_m + usual.code_m + error, one)
    rates = rate_of(true.rate_m_per_s + usual.rate_m_per_s + error_rate, one)
    tracked = got.received & (sights.elevation > _LOWEST_RAD) & ~_silent(world.faults, times, sky.names)
    records = _Records(sky.names, tracked, codes, rates, error, error_rate, usual, sights.elevation, got)
    epochs = tuple(records.epoch(n, float(sky.start_s + times[n] + one.offset_s[n])) for n in range(len(times)))
    truth = tuple(
        records.truth(n, float(sky.start_s + times[n]), float(place[n]), float(speed[n])) for n in range(len(times))
    )
    return SimulatedRun(epochs, truth, world.navigation)


class _Antenna:
    """Earth-fixed points and directions along the track of every epoch, arrays [epoch, 3]."""

    def __init__(self, track: Portion, place_m: Floats) -> None:
        self._track = track
        at = [track.at(float(one)) for one in place_m]
        self.points = np.array([point for point, _ in at])
        self.along = np.array([along for _, along in at])
        self.places = [Place.of_earth_fixed((float(x), float(y), float(z))) for x, y, z in self.points]

    def heading(self) -> Floats:
        """Return the azimuth of the track, as a column."""
        pairs = zip(self.places, self.along, strict=True)
        return np.array(
            [[place.elevation_azimuth_rad((float(x), float(y), float(z)))[1]] for place, (x, y, z) in pairs]
        )


@dataclass(frozen=True)
class _Sights:
    elevation: Floats
    azimuth: Floats
    air_m: Floats


def _sights(world: World, start_s: float, antenna: _Antenna, true: Seen, times: Floats) -> _Sights:
    angles = np.array(
        [
            [place.elevation_azimuth_rad((float(x), float(y), float(z))) for x, y, z in directions]
            for place, directions in zip(antenna.places, true.direction, strict=True)
        ]
    )
    elevation, azimuth = angles[..., 0], angles[..., 1]
    rows = zip(antenna.places, elevation, azimuth, times, strict=True)
    air = [air_m(world.navigation, place, up, around, start_s + float(time)) for place, up, around, time in rows]
    return _Sights(elevation, azimuth, np.array(air))


def _spoofed(world: World, antenna: _Antenna, true: Seen, times: Floats, names: Sequence[str]) -> tuple[Floats, Floats]:
    """Return the errors from false places, to first order: distance along the track times slope of the line of sight."""
    error, rate = np.zeros(true.way_m.shape), np.zeros(true.way_m.shape)
    slope = -np.einsum("esk,ek->es", true.direction, antenna.along)
    for fault in world.faults:
        if fault.kind == "false place":
            struck = _struck(fault, times, names)
            away, speed = _away(fault, times)
            error += np.where(struck, slope * away[:, None], 0.0)
            rate += np.where(struck, slope * speed[:, None], 0.0)
    return error, rate


def _away(fault: Fault, times: Floats) -> tuple[Floats, Floats]:
    """Return the distance (m) and speed (m/s) of a false place from the true one."""
    drift, gathering = _figure(fault, "drift_m_per_s"), _figure(fault, "gathering_m_per_s2")
    if not gathering > 0:
        raise InputError("a false place gathers speed from 0: gathering_m_per_s2 must be above 0.")
    since = np.maximum(times - fault.begin / MS_PER_S, 0)
    gathers = abs(drift) / gathering
    way = gathering / 2 * np.minimum(since, gathers) ** 2
    way = way + abs(drift) * np.maximum(since - gathers, 0)
    sign = math.copysign(1, drift)
    return sign * way, sign * gathering * np.minimum(since, gathers)


def _figure(fault: Fault, name: str) -> float:
    return float(KINDS.figure(fault, name))


def _struck(fault: Fault, times: Floats, names: Sequence[str]) -> Flags:
    """Return where the fault acts, [epoch, satellite]."""
    end_s = math.inf if fault.end is None else fault.end / MS_PER_S
    active = (fault.begin / MS_PER_S <= times) & (times < end_s)
    return np.asarray(active[:, None] & np.array([fault.strikes(name) for name in names]), np.bool_)


def _silent(faults: Sequence[Fault], times: Floats, names: Sequence[str]) -> Flags:
    silent = np.zeros((len(times), len(names)), np.bool_)
    for fault in faults:
        if fault.kind == "silence":
            period, length = _figure(fault, "period_s"), _figure(fault, "silent_s")
            if not 0 < length < period:
                raise InputError(f"{fault}: silent_s has to be a part of period_s.")
            late = (times - fault.begin / MS_PER_S) % period >= period - length
            silent |= late[:, None] & _struck(fault, times, names)
    return silent


@dataclass(frozen=True)
class _Records:
    """Converts arrays [epoch, satellite] to records of each epoch."""

    names: Sequence[str]
    received: Flags
    codes: Floats
    rates: Floats
    error: Floats
    error_rate: Floats
    usual: Healthy
    elevation: Floats
    got: Received

    def epoch(self, n: int, time_s: float) -> Epoch:
        """Return the receiver's measurements."""
        received = self._received(n)
        return Epoch(time_s, {name: Measured(float(self.codes[n, j]), float(self.rates[n, j])) for j, name in received})

    def truth(self, n: int, time_s: float, place_m: float, speed_m_per_s: float) -> Truth:
        """Return the true values of the same satellites."""
        received = self._received(n)
        return Truth(
            time_s,
            place_m,
            speed_m_per_s,
            {name: float(self.error[n, j]) for j, name in received},
            {name: float(self.error_rate[n, j]) for j, name in received},
            {name: float(self.usual.code_m[n, j]) for j, name in received},
            {name: float(self.usual.rate_m_per_s[n, j]) for j, name in received},
            {name: float(self.elevation[n, j]) for j, name in received},
            frozenset(name for j, name in received if self.got.reflected[n, j]),
        )

    def _received(self, n: int) -> list[tuple[int, str]]:
        return [(j, name) for j, name in enumerate(self.names) if self.received[n, j]]
