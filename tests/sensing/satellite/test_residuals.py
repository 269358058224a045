"""Residuals at known points: orbits, clocks, atmosphere and readers together, on recorded signals."""

from __future__ import annotations

import math
from collections.abc import Iterable

import pytest

from safeloc.errors import InputError
from safeloc.sensing.satellite.android import read_android
from safeloc.sensing.satellite.ephemeris import usable
from safeloc.sensing.satellite.epochs import Epoch, Measured
from safeloc.sensing.satellite.figures import LIGHT_M_PER_S
from safeloc.sensing.satellite.navigation import Navigation, read_navigation
from safeloc.sensing.satellite.observations import read_observations
from safeloc.sensing.satellite.orbits import satellite_state
from safeloc.sensing.satellite.places import Place
from safeloc.sensing.satellite.residuals import residuals
from tests.data_sources import data_file

STILL = (0.0, 0.0, 0.0)
SURVEYED = Place.degrees(35.13469901, 136.97757549, 104.8626)


def _rms(values: Iterable[float]) -> float:
    squares = [value**2 for value in values]
    return math.sqrt(sum(squares) / len(squares))


def _both_rms(epochs: list[Epoch], place: Place, navigation: Navigation, system: str = "G") -> tuple[float, float]:
    every = [residuals(epoch, place, STILL, navigation) for epoch in epochs]
    codes = (value for one in every for name, value in one.pseudorange_m.items() if name[0] == system)
    rates = (value for one in every for name, value in one.rate_m_per_s.items() if name[0] == system)
    return _rms(codes), _rms(rates)


def test_the_geodetic_receiver_stands_where_it_stands() -> None:
    """1.6 m and 0.012 m/s RMS (published with the recording) are met at the surveyed point."""
    navigation = read_navigation(data_file("gnss_septentrio/base.nav"))
    epochs = read_observations(data_file("gnss_septentrio/rover.obs"))
    assert len(epochs) == 301
    code_m, rate_m_per_s = _both_rms(epochs[::20], Place.degrees(35.13469901, 136.97757549, 104.8626), navigation)
    assert code_m < 1.8
    assert rate_m_per_s < 0.016


def test_galileo_fits_as_well() -> None:
    """Its own orbits, group delay and clock, at the same point: 1.1 m and 0.010 m/s RMS over the whole recording."""
    navigation = read_navigation(data_file("gnss_septentrio/base.nav"))
    epochs = read_observations(data_file("gnss_septentrio/rover.obs"))
    code_m, rate_m_per_s = _both_rms(epochs[::20], SURVEYED, navigation, "E")
    assert code_m < 1.4
    assert rate_m_per_s < 0.014


def test_a_wrong_receiver_clock_is_taken_off() -> None:
    """A clock 20 ms ahead, as the ranges and the time of the epoch show it: the same residuals to a millimetre."""
    navigation = read_navigation(data_file("gnss_septentrio/base.nav"))
    epoch = read_observations(data_file("gnss_septentrio/rover.obs"))[0]
    early = {
        name: Measured(one.code() + 0.02 * LIGHT_M_PER_S, one.rate())
        for name, one in epoch.satellites.items()
        if one.complete()
    }
    right, wrong = (residuals(one, SURVEYED, STILL, navigation) for one in (epoch, Epoch(epoch.time_s + 0.02, early)))
    assert abs(wrong.clock_s - right.clock_s - 0.02) < 1e-7
    for name, value in right.pseudorange_m.items():
        assert abs(wrong.pseudorange_m[name] - value) < 0.001, name


def test_half_a_measurement_is_half_a_residual() -> None:
    """Without Doppler there is a pseudorange residual and no rate, and the other way round; without both, none."""
    navigation = read_navigation(data_file("gnss_septentrio/base.nav"))
    epoch = read_observations(data_file("gnss_septentrio/rover.obs"))[0]
    names = sorted(residuals(epoch, SURVEYED, STILL, navigation).pseudorange_m)[:2]
    halves = {names[0]: Measured(epoch.satellites[names[0]].code(), None), names[1]: Measured(None, 1.0)}
    found = residuals(Epoch(epoch.time_s, {**epoch.satellites, **halves}), SURVEYED, STILL, navigation)
    assert (True, False) == (names[0] in found.pseudorange_m, names[0] in found.rate_m_per_s)
    assert (False, True) == (names[1] in found.pseudorange_m, names[1] in found.rate_m_per_s)
    silent = Epoch(epoch.time_s, {names[0]: Measured(None, None)})
    assert not residuals(silent, SURVEYED, STILL, navigation).pseudorange_m


def test_the_phone_stands_where_it_stands() -> None:
    """7.2 m and 0.10 m/s RMS (published with the recording) are met at the surveyed point."""
    navigation = read_navigation(data_file("gnss_android/hour1820.16n"))
    epochs = read_android(data_file("gnss_android/pseudoranges_log_2016_06_30_21_26_07.txt"))
    code_m, rate_m_per_s = _both_rms(epochs[::10], Place.degrees(37.422578, -122.081678, -28.0), navigation)
    assert code_m < 9
    assert rate_m_per_s < 0.13


def test_a_kilometre_away_shows() -> None:
    """Against a state a kilometre away the same signals are hundreds of metres off: the test above can fail."""
    navigation = read_navigation(data_file("gnss_septentrio/base.nav"))
    epochs = read_observations(data_file("gnss_septentrio/rover.obs"))
    assert _both_rms(epochs[:1], Place.degrees(35.1437, 136.9776, 104.9), navigation)[0] > 200


def test_without_valid_ephemeris_there_are_no_values() -> None:
    """With one ephemeris kept, every other satellite is named expired and none of them is predicted (SAT-D1)."""
    navigation = read_navigation(data_file("gnss_septentrio/base.nav"))
    epoch = read_observations(data_file("gnss_septentrio/rover.obs"))[0]
    place = Place.degrees(35.13469901, 136.97757549, 104.8626)
    kept = Navigation(navigation.ephemerides[:1], navigation.ionosphere)
    assert residuals(epoch, place, STILL, kept).expired == frozenset(epoch.satellites) - {"G05"}


def test_an_ephemeris_ends_with_its_window() -> None:
    """Usable to the last second of its four hours, and not one second later (SAT-D1)."""
    one = read_navigation(data_file("gnss_septentrio/base.nav")).ephemerides[0]
    end_s = one.orbit_time_s + one.fit_hours * 1800
    assert usable([one], one.satellite, end_s) is one
    assert usable([one], one.satellite, end_s + 1) is None
    with pytest.raises(InputError, match="not valid"):
        satellite_state(one, end_s + 1)
