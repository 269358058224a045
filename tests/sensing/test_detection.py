"""Peaks: rare in noise, none lost to a neighbour, none on the rim."""

from __future__ import annotations

import math
import subprocess
import sys

import numpy as np

from safeloc.sensing.detection import background, peaks
from tests.sensing.scenes import CONFIG

SHAPE = CONFIG.sensor.shape


def noise(seed: int) -> np.ndarray:
    """An image of nothing."""
    return np.random.default_rng(seed).exponential(1.0, SHAPE)


def with_echoes(*cells: tuple[int, int], power: float = 1_000.0) -> np.ndarray:
    """Noise with these cells strong."""
    image = noise(0)
    for cell in cells:
        image[cell] = power
    return image


def test_noise_is_nearly_never_a_peak() -> None:
    """The threshold is for one false peak in 30,000 frames; 200 frames have none, and a threshold of 8 dB has many."""
    low = CONFIG.model_copy(update={"detection": CONFIG.detection.model_copy(update={"threshold_cdb": 800})})
    assert sum(len(peaks(noise(seed), CONFIG)) for seed in range(200)) == 0
    assert len(peaks(noise(0), low)) > 5


def test_an_echo_is_a_peak() -> None:
    """At its cell, over a background of mean noise."""
    found = peaks(with_echoes((300, 9)), CONFIG)
    assert [(300, 9)] == list(zip(found.row, found.column, strict=True))
    assert 0.5 < found.background[0] < 2.0


def test_neighbours_do_not_hide_each_other() -> None:
    """Ten echoes within the windows of one that is 40 dB weaker: all eleven are found."""
    cells = [(300 + 6 * index, 8) for index in range(-5, 6)]
    image = with_echoes(*cells, power=1e6)
    image[300, 8] = 100.0
    assert len(peaks(image, CONFIG)) == 11


def test_clutter_raises_the_background() -> None:
    """Over clutter 20 dB above noise, what would stand out of noise does not, not even where the clutter begins or ends."""
    image = noise(1)
    image[250:350] *= 100
    image[300, 8] = 500.0
    assert len(peaks(image, CONFIG)) == 0
    assert 50 < background(image, CONFIG.detection.window_cells)[300, 8] < 200


def test_nothing_on_the_rim_or_in_the_blind_range() -> None:
    """Cells without two neighbours cannot be read between; nearest cells hear the transmitter."""
    blind = math.ceil(CONFIG.sensor.blind_mm / CONFIG.sensor.cell_mm)
    image = with_echoes((300, 0), (300, SHAPE[1] - 1), (SHAPE[0] - 1, 8), (0, 8), (blind, 8))
    assert len(peaks(image, CONFIG)) == 0
    assert len(peaks(with_echoes((blind + 2, 8)), CONFIG)) == 1


def test_without_scipy_the_message_says_what_to_install() -> None:
    """The extra is named where the import fails."""
    code = "import sys; sys.modules['scipy'] = None; import safeloc.sensing.detection"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=False)
    assert done.returncode == 1
    assert "EngineError: radar images are read with scipy: pip install 'safeloc[signals]'." in done.stderr
