"""Residual-based fault exclusion as gnss_lib_py does it (`solve_fde`, method "residual": Blanch, Walter, Enge 2015).

It solves place and clock in three dimensions from all satellites, and removes the worst residual until the sum of squares
passes. Its solver wants satellites in the frame of reception and has to be told so; `solve_fde` does not pass that on, and
its residuals would be off by Earth's rotation, up to 40 m: the caller of this module sets it right (see `told_of_frame`).
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial
from typing import Any

import numpy as np
import pytest

from safeloc.sensing.satellite.epochs import Epoch
from safeloc.sensing.satellite.figures import EARTH_RATE_RAD_PER_S, LIGHT_M_PER_S
from safeloc.sensing.satellite.navigation import Navigation
from safeloc.sensing.satellite.orbits import satellite_state
from safeloc.sensing.satellite.places import Place
from safeloc.sensing.satellite.residuals import residuals

STILL = (0.0, 0.0, 0.0)


def told_of_frame(monkeypatch: pytest.MonkeyPatch) -> Any:
    """The library's `solve_fde`, whose solver now knows the frame; skips without the extra `raim`."""
    pytest.importorskip("gnss_lib_py", reason="residual-based exclusion needs the extra raim")
    from gnss_lib_py.algorithms import fde

    monkeypatch.setattr(fde, "solve_wls", partial(fde.solve_wls, sv_rx_time=True))
    return fde.solve_fde


def excluded_by_raim(
    solve_fde: Any, epochs: Sequence[Epoch], navigation: Navigation, place: Place, threshold_m2: float
) -> list[frozenset[str]]:
    """Of every epoch the satellites that it excludes, among those that safeloc predicts for a receiver at `place`.

    The place serves the delays of the air and the mask alone, so that both see the same signals.
    """
    made = [_columns(number, epoch, navigation, place) for number, epoch in enumerate(epochs)]
    every = {name: np.concatenate([columns[name] for _, columns in made]) for name in made[0][1]}
    from gnss_lib_py.navdata.navdata import NavData

    data = NavData()
    for name, values in every.items():
        data[name] = values
    found = np.atleast_1d(solve_fde(data, method="residual", threshold=threshold_m2)["fault_residual"])
    ends = np.cumsum([len(names) for names, _ in made])
    faults = np.split(found, ends[:-1])
    return [
        frozenset(name for name, fault in zip(names, told, strict=True) if fault == 1)
        for (names, _), told in zip(made, faults, strict=True)
    ]


def _columns(
    number: int, epoch: Epoch, navigation: Navigation, place: Place
) -> tuple[list[str], dict[str, np.ndarray[Any, Any]]]:
    """Corrected pseudoranges and satellites in the frame of reception."""
    found = residuals(epoch, place, STILL, navigation)
    names = sorted(name for name in found.pseudorange_m if name.startswith("G"))
    points, codes = [], []
    for name in names:
        point, clock_s = _received(epoch, navigation, name)
        ways = found.predictions[name].pseudorange_m
        air = ways - float(np.linalg.norm(point - np.array(place.earth_fixed_m()))) + LIGHT_M_PER_S * clock_s
        points.append(point)
        codes.append(epoch.satellites[name].code() + LIGHT_M_PER_S * clock_s - air)
    at = np.array(points).reshape(-1, 3)
    return names, {
        "gps_millis": np.full(len(names), 1e12 + number * 1_000.0),
        "x_sv_m": at[:, 0], "y_sv_m": at[:, 1], "z_sv_m": at[:, 2],
        "b_sv_m": np.zeros(len(names)), "corr_pr_m": np.array(codes),
    }  # fmt: skip


def _received(epoch: Epoch, navigation: Navigation, name: str) -> tuple[np.ndarray[Any, Any], float]:
    """Where the satellite was when it sent, in the frame of reception, and its clock."""
    ephemeris = navigation.valid(name, epoch.time_s)
    assert ephemeris is not None
    sent_s = epoch.time_s - epoch.satellites[name].code() / LIGHT_M_PER_S
    state = satellite_state(ephemeris, sent_s)
    angle = EARTH_RATE_RAD_PER_S * (epoch.time_s - sent_s)
    x, y, z = state.position_m
    turned = (x * np.cos(angle) + y * np.sin(angle), y * np.cos(angle) - x * np.sin(angle), z)
    return np.array(turned), state.clock_s
