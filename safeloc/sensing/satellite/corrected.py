"""Reads epochs of satellites that come with their own places and corrected ranges, so that no ephemeris is needed (CSV).

    time_s             the receiver's time in GPS seconds since 1980-01-06, with its clock error
    satellite          its name as in RINEX: G05, E11
    pseudorange_m      corrected for the satellite's clock, the ionosphere, the troposphere and the bias between signals
    rate_m_per_s       change of the range, corrected for the drift of the satellite's clock; positive if it grows
    x_m, y_m, z_m      the satellite's place at transmission, Earth-fixed (ECEF) at that time
    vx_m_per_s, vy_m_per_s, vz_m_per_s   its velocity in the same frame

The receiver's own clock is not to be removed: that is done here. A cell of pseudorange or rate may be empty: not measured. Rows
of one epoch stand together. Other columns are not read. Whether the ephemerides behind the places were valid (SAT-D1) only
the program can tell that wrote the file; leave out the satellites for which they were not.
"""

from __future__ import annotations

import csv
import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import groupby
from pathlib import Path

from safeloc.errors import InputError, StreamError
from safeloc.runtime.outside import quoted, reading_file
from safeloc.sensing.satellite.channels import identity
from safeloc.sensing.satellite.epochs import Epoch, Measured, in_order
from safeloc.sensing.satellite.log_lines import decimal, log_lines
from safeloc.sensing.satellite.orbits import SatelliteState
from safeloc.sensing.satellite.places import Place, Vector
from safeloc.sensing.satellite.predicted import Predicted, Signal, predicted_of_state

PLACE, VELOCITY = ("x_m", "y_m", "z_m"), ("vx_m_per_s", "vy_m_per_s", "vz_m_per_s")
COLUMNS = ("time_s", "satellite", "pseudorange_m", "rate_m_per_s", *PLACE, *VELOCITY)
_NEAREST_M, _FARTHEST_M = 2.4e7, 4.7e7
"""From the Earth's centre: Galileo, GPS, BeiDou and QZSS run between 25 500 and 45 400 km."""
_FASTEST_M_PER_S = 5_000
_Cells = dict[str, str]


@dataclass(frozen=True, slots=True)
class CorrectedEpoch:
    """The measurements of an epoch, and the state of each of its satellites at transmission."""

    epoch: Epoch
    states: Mapping[str, SatelliteState]


def read_corrected(path: Path) -> list[CorrectedEpoch]:
    """Return all epochs. StreamError names file and line; InputError for epochs out of order."""
    with reading_file(path, path.name):
        rows = list(_rows(csv.reader(log_lines(path, "utf-8"), strict=True), path))
        found = [_epoch(list(group), path) for _, group in groupby(rows, key=lambda row: row[1]["time_s"])]
        list(in_order(one.epoch for one in found))
        return found


@dataclass(frozen=True)
class CorrectedSky:
    """Predicts the signals of epochs from the states that came with them, in place of ephemerides."""

    epochs: Sequence[CorrectedEpoch]

    def signals(self, epoch: Epoch) -> dict[str, Signal]:
        """Return how the signal of each satellite of an epoch is predicted that has a state at the epoch's time."""
        states = self._states.get(epoch.time_s, {})
        return {name: _signal(states[name]) for name in epoch.satellites if name in states}

    @cached_property
    def _states(self) -> dict[float, Mapping[str, SatelliteState]]:
        return {one.epoch.time_s: one.states for one in self.epochs}


def _signal(state: SatelliteState) -> Signal:
    def signal(_time_s: float, place: Place, velocity_m_per_s: Vector) -> Predicted:
        return predicted_of_state(state, place, velocity_m_per_s)

    return signal


def _rows(reader: Iterator[Sequence[str]], path: Path) -> Iterator[tuple[int, _Cells]]:
    try:
        header = [name.strip() for name in next(reader, [])]
        missing = [name for name in COLUMNS if header.count(name) != 1]
        if missing:
            raise StreamError(f"{path.name}:1: needs each of these columns once: {', '.join(missing)}.")
        for number, cells in enumerate(reader, 2):
            if len(cells) != len(header):
                raise StreamError(
                    f"{path.name}:{number}: {len(cells)} cells under {len(header)} columns; mend the row."
                )
            yield number, dict(zip(header, (cell.strip() for cell in cells), strict=True))
    except csv.Error as error:
        raise StreamError(f"{path.name}: not CSV ({error}).") from error


def _epoch(rows: Sequence[tuple[int, _Cells]], path: Path) -> CorrectedEpoch:
    time_s = 0.0
    measured: dict[str, Measured] = {}
    states: dict[str, SatelliteState] = {}
    for number, cells in rows:
        name = cells["satellite"]
        try:
            identity(name)
            if name in states:
                raise InputError(f"{name} stands twice in one epoch; drop the epoch.")
            time_s, states[name] = _number(cells, "time_s"), _state(cells)
            code, rate = (_number(cells, key) if cells[key] else None for key in ("pseudorange_m", "rate_m_per_s"))
            measured[name] = Measured(code, rate)
        except InputError as error:
            raise StreamError(f"{path.name}:{number}: {error}") from error
    return CorrectedEpoch(Epoch(time_s, measured), states)


def _state(cells: _Cells) -> SatelliteState:
    place, velocity = (_vector(cells, names) for names in (PLACE, VELOCITY))
    away, speed = math.hypot(*place), math.hypot(*velocity)
    if not _NEAREST_M <= away <= _FARTHEST_M:
        raise InputError(
            f"its place is {away / 1e3:.0f} km from the Earth's centre, where no navigation satellite runs; give m."
        )
    if not speed <= _FASTEST_M_PER_S:
        raise InputError(
            f"its velocity is {speed:g} m/s; Earth-fixed, no navigation satellite reaches {_FASTEST_M_PER_S} m/s."
        )
    return SatelliteState(place, velocity, clock_s=0.0, clock_drift=0.0)


def _vector(cells: _Cells, names: tuple[str, str, str]) -> Vector:
    x, y, z = (_number(cells, name) for name in names)
    return x, y, z


def _number(cells: _Cells, name: str) -> float:
    try:
        value = decimal(cells[name])
    except ValueError as error:
        raise InputError(f"{name} is {quoted(cells[name])}, no number.") from error
    if not math.isfinite(value):
        raise InputError(f"{name} is {value}; give a finite number, or leave out the satellite.")
    return value
