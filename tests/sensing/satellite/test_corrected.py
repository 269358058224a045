"""Corrected ranges with places of satellites: the same residuals as by ephemerides, and what is refused."""

from __future__ import annotations

import math
from collections.abc import Mapping
from pathlib import Path

import pytest

from safeloc.errors import InputError, StreamError
from safeloc.sensing.satellite.corrected import COLUMNS, PLACE, VELOCITY, CorrectedSky, read_corrected
from safeloc.sensing.satellite.epochs import Epoch
from safeloc.sensing.satellite.figures import LIGHT_M_PER_S
from safeloc.sensing.satellite.navigation import Navigation, read_navigation
from safeloc.sensing.satellite.observations import read_observations
from safeloc.sensing.satellite.orbits import SatelliteState, satellite_state
from safeloc.sensing.satellite.predicted import predicted, predicted_of_state
from safeloc.sensing.satellite.residuals import residuals
from tests.data_sources import data_file
from tests.sensing.satellite.test_residuals import STILL, SURVEYED

GOOD: Mapping[str, str] = {
    "time_s": "1300000000.5", "satellite": "G05", "pseudorange_m": "21000000.125", "rate_m_per_s": "-300.5",
    "x_m": "26560000", "y_m": "0", "z_m": "0", "vx_m_per_s": "0", "vy_m_per_s": "2700", "vz_m_per_s": "1500",
}  # fmt: skip


def written(folder: Path, *rows: Mapping[str, str], header: str = ",".join(COLUMNS)) -> Path:
    """A file of these rows."""
    path = folder / "ranges.csv"
    path.write_text("\n".join([header, *(",".join(row.values()) for row in rows)]) + "\n", encoding="utf-8")
    return path


def corrected_of(epoch: Epoch, navigation: Navigation) -> list[dict[str, str]]:
    """What a program writes that corrects an epoch by its ephemerides, at the surveyed point."""
    rows = []
    for name, measured in epoch.satellites.items():
        ephemeris = navigation.valid(name, epoch.time_s)
        if ephemeris is None or not measured.complete():
            continue
        whole = predicted(ephemeris, epoch.time_s, SURVEYED, STILL, navigation.ionosphere)
        sent_s = epoch.time_s - measured.code() / LIGHT_M_PER_S
        state = satellite_state(ephemeris, sent_s)
        bare = predicted(ephemeris, epoch.time_s, SURVEYED, STILL, None)
        clock_m = LIGHT_M_PER_S * state.clock_s
        distance = _distance_m(state.position_m)
        air_m = whole.pseudorange_m - (distance - clock_m) if bare.elevation_rad > 0 else 0.0
        rows.append({
            "time_s": repr(epoch.time_s), "satellite": name,
            "pseudorange_m": repr(measured.code() + clock_m - air_m),
            "rate_m_per_s": repr(measured.rate() + LIGHT_M_PER_S * state.clock_drift),
            **dict(zip(PLACE, map(repr, state.position_m), strict=True)),
            **dict(zip(VELOCITY, map(repr, state.velocity_m_per_s), strict=True)),
        })  # fmt: skip
    return rows


def _distance_m(sent_m: tuple[float, float, float]) -> float:
    """The distance from the place at transmission to the surveyed point, with the correction of Sagnac in closed form."""
    rate = 7.2921151467e-5
    x, y, z = SURVEYED.earth_fixed_m()
    straight = ((x - sent_m[0]) ** 2 + (y - sent_m[1]) ** 2 + (z - sent_m[2]) ** 2) ** 0.5
    return float(straight + rate * (sent_m[0] * y - sent_m[1] * x) / LIGHT_M_PER_S)


def test_corrected_ranges_give_the_residuals_of_the_ephemerides(tmp_path: Path) -> None:
    """On a recorded epoch, to a centimetre and a millimetre a second; the correction for the turning Earth is another formula here."""
    navigation = read_navigation(data_file("gnss_septentrio/base.nav"))
    epoch = read_observations(data_file("gnss_septentrio/rover.obs"))[0]
    [one] = read_corrected(written(tmp_path, *corrected_of(epoch, navigation)))
    found = residuals(one.epoch, SURVEYED, STILL, CorrectedSky([one]))
    expected = residuals(epoch, SURVEYED, STILL, navigation)
    assert found.pseudorange_m.keys() == expected.pseudorange_m.keys() and len(found.pseudorange_m) > 10
    for name, value in expected.pseudorange_m.items():
        assert value == pytest.approx(found.pseudorange_m[name], abs=0.01), name
    for name, value in expected.rate_m_per_s.items():
        assert value == pytest.approx(found.rate_m_per_s[name], abs=0.001), name
    assert found.low == expected.low


def test_the_turn_of_the_earth_is_applied() -> None:
    """Against the closed form of Sagnac's correction, tens of metres, for satellites east and west; and the rate, by difference."""
    x, y, z = SURVEYED.earth_fixed_m()
    for turn in (-0.6, 0.0, 0.7):  # radians east of the place
        angle, radius = math.atan2(y, x) + turn, 26_560_000.0
        place = (radius * 0.8 * math.cos(angle), radius * 0.8 * math.sin(angle), radius * 0.6)
        velocity = (1_200.0, -2_100.0, 1_500.0)
        before, after = (
            _distance_m((place[0] + t * velocity[0], place[1] + t * velocity[1], place[2] + t * velocity[2]))
            for t in (-0.5, 0.5)
        )
        found = predicted_of_state(SatelliteState(place, velocity, 0.0, 0.0), SURVEYED, STILL)
        assert _distance_m(place) == pytest.approx(found.pseudorange_m, abs=0.001)
        assert after - before == pytest.approx(found.rate_m_per_s, abs=0.02)
        assert turn == 0 or abs(found.pseudorange_m - math.dist(place, (x, y, z))) > 5


def test_a_kilometre_away_shows(tmp_path: Path) -> None:
    """Against another place the same ranges are hundreds of metres off, and a false velocity shows in the rates."""
    navigation = read_navigation(data_file("gnss_septentrio/base.nav"))
    epoch = read_observations(data_file("gnss_septentrio/rover.obs"))[0]
    [one] = read_corrected(written(tmp_path, *corrected_of(epoch, navigation)))
    away = SURVEYED.degrees(35.1437, 136.9776, 104.9)
    sky = CorrectedSky([one])
    assert max(abs(value) for value in residuals(one.epoch, away, STILL, sky).pseudorange_m.values()) > 200
    assert max(abs(value) for value in residuals(one.epoch, SURVEYED, (9.0, 9.0, 9.0), sky).rate_m_per_s.values()) > 3
    with pytest.raises(InputError, match="velocity is not finite"):
        residuals(one.epoch, SURVEYED, (float("nan"), 0.0, 0.0), sky)


def test_an_epoch_without_states_is_not_predicted(tmp_path: Path) -> None:
    """States belong to the epoch they came with: of another one nothing is known, nor of a satellite that has none."""
    [one] = read_corrected(written(tmp_path, GOOD))
    sky = CorrectedSky([one])
    later = Epoch(one.epoch.time_s + 0.2, one.epoch.satellites)
    more = Epoch(one.epoch.time_s, {**one.epoch.satellites, "E11": one.epoch.satellites["G05"]})
    assert (["G05"], [], ["G05"]) == tuple(list(sky.signals(epoch)) for epoch in (one.epoch, later, more))
    assert residuals(later, SURVEYED, STILL, sky).expired == {"G05"}


def test_rows_of_one_time_are_an_epoch(tmp_path: Path) -> None:
    """Empty cells are not measured; other columns are not read; order of columns does not matter."""
    rows = [{**GOOD, "note": "x"}, {**GOOD, "satellite": "E11", "pseudorange_m": "", "note": ""}]
    rows += [{**GOOD, "time_s": "1300000001.5", "rate_m_per_s": "", "note": "y"}]
    path = written(tmp_path, *({"note": row["note"], **row} for row in rows), header=",".join(["note", *COLUMNS]))
    first, second = read_corrected(path)
    assert (1_300_000_000.5, ["G05", "E11"]) == (first.epoch.time_s, list(first.epoch.satellites))
    assert (21_000_000.125, None) == (
        first.epoch.satellites["G05"].pseudorange_m,
        first.epoch.satellites["E11"].pseudorange_m,
    )
    assert second.epoch.satellites["G05"].rate_m_per_s is None
    assert (0.0, 2_700.0, 1_500.0) == first.states["E11"].velocity_m_per_s
    assert [] == read_corrected(written(tmp_path))


@pytest.mark.parametrize(
    ("changed", "message"),
    [
        ({"satellite": "X05"}, "'X05' is no satellite"),
        ({"x_m": "26560"}, "its place is 27 km from the Earth's centre, where no navigation satellite runs; give m."),
        ({"vy_m_per_s": "270000"}, "Earth-fixed, no navigation satellite reaches 5000 m/s"),
        ({"pseudorange_m": "2_1"}, "pseudorange_m is '2_1', no number."),
        ({"rate_m_per_s": "nan"}, "rate_m_per_s is nan; give a finite number, or leave out the satellite."),
        ({"time_s": "inf"}, "time_s is inf; give a finite number"),
        ({"z_m": ""}, "z_m is '', no number."),
    ],
)
def test_wrong_cells_are_refused_with_their_line(tmp_path: Path, changed: dict[str, str], message: str) -> None:
    """By file, line, column and what to do."""
    with pytest.raises(StreamError) as refused:
        read_corrected(written(tmp_path, GOOD, {**GOOD, "satellite": "G06", **changed}))
    assert str(refused.value).startswith("ranges.csv:3: ") and message in str(refused.value)


def test_wrong_files_are_refused(tmp_path: Path) -> None:
    """A column that is missing or stands twice, a short row, a satellite twice, epochs out of order, no CSV."""
    with pytest.raises(StreamError, match=r"^ranges\.csv:1: needs each of these columns once: time_s, satellite"):
        read_corrected(written(tmp_path, header=",".join((*COLUMNS, "time_s", "satellite"))))
    with pytest.raises(StreamError, match=r"^ranges\.csv:2: 1 cells under 10 columns"):
        read_corrected(written(tmp_path, {"time_s": "1"}))
    with pytest.raises(StreamError, match=r"^ranges\.csv:3: G05 stands twice in one epoch"):
        read_corrected(written(tmp_path, GOOD, GOOD))
    with pytest.raises(InputError, match=r"does not come after"):
        read_corrected(written(tmp_path, GOOD, {**GOOD, "time_s": "1"}))
    with pytest.raises(StreamError, match=r"^ranges\.csv: not CSV"):
        read_corrected(written(tmp_path, {"time_s": '"1" 2'}))
