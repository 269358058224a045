"""Places between cells: exact without noise, and never outside the bounds while the noise keeps to its own."""

from __future__ import annotations

import numpy as np
import pytest
import z3
from hypothesis import given
from hypothesis import strategies as st

from safeloc.sensing.detection import Peaks
from safeloc.sensing.interpolation import hann, leakage, points, side_lobes
from tests.sensing.scenes import CONFIG

SAMPLES, ANTENNAS = CONFIG.sensor.samples, CONFIG.sensor.antennas


def spectrum(place: float, samples: int) -> np.ndarray:
    """Amplitudes of a tone at this place, in cells, through a Hann window; 1 at its top."""
    turn = np.arange(samples) / samples
    window = 0.5 - 0.5 * np.cos(2 * np.pi * turn)
    return np.asarray(np.abs(np.fft.fft(window * np.exp(2j * np.pi * place * turn))) / window.sum())


def picture(row: float, column: float, amplitude: float = 1_000.0) -> np.ndarray:
    """The image of one point without noise, over a floor of next to nothing."""
    side = CONFIG.sensor.side_cells
    across = np.roll(spectrum(column - side, ANTENNAS), side)[: 2 * side + 1]
    return np.asarray((amplitude * spectrum(row, SAMPLES)[:, None] * across[None, :]) ** 2)


def peak(power: np.ndarray, background: float = 1e-12) -> Peaks:
    """The highest cell."""
    row, column = np.unravel_index(int(np.argmax(power)), power.shape)
    return Peaks(np.array([row]), np.array([column]), np.array([background]))


@given(st.floats(30.0, 900.0), st.floats(3.0, 13.0))
def test_without_noise_the_place_is_found(row: float, column: float) -> None:
    """In range to a millionth of a cell; in angle to what the short window allows, and within the bounds."""
    power = picture(row, column)
    found = points(power, peak(power), CONFIG)
    range_low, range_high = (found.peaks.row + part for part in (found.range.low, found.range.high))
    angle_low, angle_high = (found.peaks.column + part for part in (found.angle.low, found.angle.high))
    assert range_low[0] <= row <= range_high[0]
    assert angle_low[0] <= column <= angle_high[0]
    assert range_high[0] - range_low[0] < 1e-4
    assert angle_high[0] - angle_low[0] < 0.02
    assert found.power[0] == pytest.approx(1e6, rel=0.01)


@given(st.floats(100.0, 101.0), st.floats(0.0, 0.45), st.floats(-1.0, 1.0), st.floats(-1.0, 1.0))
def test_noise_within_its_bound_keeps_the_place_within_its_bounds(row: float, share: float, a: float, b: float) -> None:
    """Whatever each cell's amplitude is off by, up to the bound."""
    side = CONFIG.sensor.side_cells
    power = picture(row, side)
    amplitude = np.sqrt(power)
    found = peak(power)
    top, noise = int(found.row[0]), share * amplitude.max()
    amplitude[top, side] += a * noise
    amplitude[[top - 1, top + 1], side] += b * noise
    background = noise**2 / 10 ** (CONFIG.detection.noise_bound_cdb / 1_000)
    result = points(np.maximum(amplitude, 0.0) ** 2, peak(power, background), CONFIG)
    if len(result.power):
        assert result.range.low[0] - 1e-6 <= row - top <= result.range.high[0] + 1e-6


def answer(*claims: z3.BoolRef) -> z3.CheckSatResult:
    """Whether real numbers fulfil all."""
    solver = z3.Tactic("qfnra-nlsat").solver()
    solver.add(*claims)
    return solver.check()


def test_the_bound_follows_from_the_amplitudes() -> None:
    """For all reals: amplitudes off by at most n give a place between those of (a1 - n) / (a0 + n) and (a1 + n) / (a0 - n)."""
    a1, a0, t1, t0, n = z3.Reals("a1 a0 t1 t0 n")
    lawful = z3.And(n >= 0, a0 > n, a1 >= n, t1 >= a1 - n, t1 <= a1 + n, t0 >= a0 - n, t0 <= a0 + n)
    true, sum_of_true = 2 * t1 - t0, t1 + t0  # places as fractions, with positive denominators
    high, low, sum_of_read = 2 * (a1 + n) - (a0 - n), 2 * (a1 - n) - (a0 + n), a1 + a0
    outside = z3.Or(true * sum_of_read > high * sum_of_true, true * sum_of_read < low * sum_of_true)
    tighter = true * sum_of_read > (high - n) * sum_of_true
    assert answer(lawful, outside) == z3.unsat
    assert answer(lawful, tighter) == z3.sat


@given(st.floats(1.5, 100.0))
def test_side_lobes_are_not_underrated(x: float) -> None:
    """The envelope is never below the window's own transform, and less than a millionth far away."""
    assert abs(float(hann(np.array([x]))[0])) <= float(side_lobes(np.array([x]))[0]) + 1e-12
    assert float(side_lobes(np.array([1.0]))[0]) == 1.0
    assert float(side_lobes(np.array([90.0]))[0]) < 1e-6


@given(st.floats(5.5, 11.5), st.floats(0.0, 3.0))
def test_side_lobes_across_are_not_underrated(column: float, away: float) -> None:
    """The short window's side lobes stay below twice the envelope."""
    side = CONFIG.sensor.side_cells
    across = np.roll(spectrum(column - side, ANTENNAS), side)[: 2 * side + 1]
    cells = np.arange(2 * side + 1)
    far = np.abs(cells - column) >= 1.5 + away
    assert (across[far] <= 2 * side_lobes(np.abs(cells - column))[far] + 1e-12).all()


def tone(place: float, samples: int) -> np.ndarray:
    """A tone's transform through a Hann window, with its phase; 1 at its top."""
    turn = np.arange(samples) / samples
    window = 0.5 - 0.5 * np.cos(2 * np.pi * turn)
    return np.asarray(np.fft.fft(window * np.exp(2j * np.pi * place * turn)) / window.sum())


@given(st.floats(200.0, 201.0), st.floats(4.0, 12.0), st.floats(0.0, 1.0), st.floats(0.3, 3.0))
def test_a_neighbour_keeps_the_place_within_its_bounds(row: float, away: float, phase: float, ratio: float) -> None:
    """Two echoes without noise, four cells apart or more, at any phase: both places are within their bounds."""
    side = CONFIG.sensor.side_cells
    across = np.roll(spectrum(0.0, ANTENNAS), side)[: 2 * side + 1]
    both = tone(row, SAMPLES) + ratio * np.exp(2j * np.pi * phase) * tone(row + away, SAMPLES)
    power = 1e6 * np.abs(both[:, None] * across[None, :]) ** 2
    strip = power[:, side]
    rows = [
        int(np.argmax(np.where(np.abs(np.arange(SAMPLES) - place) < 1.0, strip, 0.0))) for place in (row, row + away)
    ]
    found = points(power, Peaks(np.array(rows), np.array([side, side]), np.full(2, 1e-12)), CONFIG)
    assert len(found.power) == 2
    for index, place in enumerate((row, row + away)):
        low, high = found.range.low[index], found.range.high[index]
        assert found.peaks.row[index] + low <= place <= found.peaks.row[index] + high


def test_a_side_lobe_is_no_echo() -> None:
    """Next to a strong echo, what is weaker than its side lobes is left out, and the strong one stays."""
    found = Peaks(np.array([100, 103]), np.array([8, 8]), np.array([1.0, 1.0]))
    leaked = leakage(found, np.array([1e4, 10.0]))
    assert leaked[1] > 10.0
    assert leaked[0] < 10.0
