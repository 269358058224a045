"""Simulated radar images agree with the radar equation, Fourier's and Doppler's, apart from the front end that reads them."""

from __future__ import annotations

import numpy as np
import pytest

from safeloc.sensing.figures import RadarConfig, Sensor
from safeloc.simulation.radar import Bias, Interference, Points, Weather, image, points, rain_cdb_per_km

QUIET = RadarConfig(sensor=Sensor(ground_reflection_percent=0, scale_error_ppm=1_000))
CELL = float(QUIET.sensor.cell_mm)


def one(cells: float, sine: float = 0.0, section_m2: float = 100.0, *, on_ground: bool = False) -> Points:
    """One point so many range cells away."""
    return points(np.array([cells * CELL]), np.array([sine]), section_m2, on_ground=on_ground)


def top(power: np.ndarray) -> tuple[int, int]:
    """The highest cell."""
    row, column = np.unravel_index(int(np.argmax(power)), power.shape)
    return int(row), int(column)


def rng() -> np.random.Generator:
    """The same one every time."""
    return np.random.default_rng(5)


def test_nothing_is_noise_of_mean_one() -> None:
    """In every part of the image; exponential: its median is ln 2."""
    power = image(points(np.zeros(0), np.zeros(0), 1.0), QUIET, rng())
    assert QUIET.sensor.shape == power.shape
    assert power.mean() == pytest.approx(1.0, abs=0.04)
    assert np.median(power) == pytest.approx(np.log(2), abs=0.04)
    assert power[:100].mean() == pytest.approx(power[-100:].mean(), abs=0.2)


@pytest.mark.parametrize(("cells", "sine"), [(500, 0.0), (100, 0.25), (900, -0.375)])
def test_a_point_is_where_it_is_and_as_strong_as_the_equation_has_it(cells: int, sine: float) -> None:
    """Cell by range and sine, to the left growing; power by section / range^4."""
    power = image(one(cells, sine), QUIET, rng())
    column = QUIET.sensor.side_cells + round(sine * QUIET.sensor.antennas / 2)
    assert (cells, column) == top(power)
    expected = 10 ** (QUIET.reference_cdb / 1_000) * 100.0 * (100_000 / (cells * CELL)) ** 4
    assert power[cells, column] == pytest.approx(expected, rel=0.25 if cells > 800 else 0.05)


def test_points_add_up() -> None:
    """Two points are two peaks."""
    power = image(one(300).together(one(400, 0.25)), QUIET, rng())
    assert power[300, 8] > 1e3
    assert power[400, 12] > 1e3


def test_approaching_reads_shorter() -> None:
    """By speed x carrier x duration / bandwidth: 40 m/s shift by 0.308 m, two cells and a bit; receding, longer."""
    shift = 40_000 * float(QUIET.sensor.lead_us) / 1e6 / CELL
    assert shift == pytest.approx(2.055, abs=0.01)
    for speed, row in ((40_000.0, 498), (-40_000.0, 502), (0.0, 500)):
        assert (row, 8) == top(image(one(500), QUIET, rng(), speed_mm_s=speed))


def test_declared_errors_are_made() -> None:
    """A scale 1000 ppm off at 900 cells is 0.9 cells."""
    assert top(image(one(900), QUIET, rng(), bias=Bias(scale=1.0))) == (901, 8)
    assert top(image(one(900), QUIET, rng(), bias=Bias(scale=-1.0))) == (899, 8)


def test_rain_and_a_wet_cover_weaken() -> None:
    """50 mm/h: 19 dB/km one way, so 3 dB at 75 m and back; a film by as much as it is said to."""
    dry, wet, film = (
        image(one(500), QUIET, rng(), weather=weather).max()
        for weather in (Weather(), Weather(rain_mm_h=50), Weather(film_cdb=1_000))
    )
    assert rain_cdb_per_km(50) == pytest.approx(1_913, abs=2)
    assert 10 * np.log10(dry / wet) == pytest.approx(2 * 19.13 * 500 * CELL / 1e6, abs=0.1)
    assert 10 * np.log10(dry / film) == pytest.approx(10.0, abs=0.3)


def test_the_ground_moves_the_echo() -> None:
    """With a part reflected, power and place vary from frame to frame; without, they do not."""
    bumpy = RadarConfig(sensor=Sensor(ground_reflection_percent=30))
    same, different = (
        [image(one(100, on_ground=True), config, np.random.default_rng(seed)).max() for seed in range(6)]
        for config in (QUIET, bumpy)
    )
    assert max(same) / min(same) < 1.05
    assert max(different) / min(different) > 1.5


def test_a_strange_chirp_is_heard_everywhere() -> None:
    """Its power spreads over all ranges, most of it in its direction."""
    power = image(one(500), QUIET, rng(), interference=Interference(sine=0.25))
    columns = np.median(power, axis=0)
    assert np.argmax(columns) == QUIET.sensor.side_cells + 4
    assert columns.max() > 1e3
    assert np.median(power[:100]) == pytest.approx(np.median(power[-100:]), rel=0.5)


def test_beyond_the_converter_an_echo_is_cut_off() -> None:
    """It is no stronger than the converter's end, and its harmonics stand where nothing does."""
    power = image(one(30, section_m2=1e7), QUIET, rng())
    end = 10 ** (QUIET.sensor.full_scale_cdb / 1_000)
    assert end / 2 < power.max() < 2 * end
    harmonic = QUIET.sensor.samples - 3 * 30
    assert power[harmonic, 8] > 1e4


def test_only_what_is_ahead_and_in_reach_is_seen() -> None:
    """Behind (NaN), on the antenna, or beyond the last cell: nothing."""
    lost = points(np.array([np.nan, 100.0, 2e6]), np.zeros(3), 1e6)
    assert image(lost, QUIET, rng()).max() < 30
