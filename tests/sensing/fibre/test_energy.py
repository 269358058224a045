"""Energy in the band, and quiet."""

from __future__ import annotations

import numpy as np
import pytest

from safeloc.sensing.fibre.energy import Analyser, Quiet, Smoother
from safeloc.sensing.fibre.figures import Detection, Emission, Emitter, FibreConfig, Interrogator

CONFIG = FibreConfig(interrogator=Interrogator(fibre_mm=1_000_000))
FRAMES, CHANNELS = CONFIG.band.block_frames, CONFIG.interrogator.channels
TIME = np.arange(FRAMES) / CONFIG.interrogator.frame_hz


def tone(hz: float) -> np.ndarray[tuple[int, int], np.dtype[np.float32]]:
    """A tone of unit rms in all channels."""
    return np.repeat((np.sqrt(2) * np.sin(2 * np.pi * hz * TIME))[:, None], CHANNELS, axis=1).astype(np.float32)


def test_white_noise_has_energy_one() -> None:
    """On average, whatever the window and the tones."""
    noise = np.random.default_rng(0).standard_normal((FRAMES, CHANNELS)).astype(np.float32)
    assert 1.0 == pytest.approx(float(Analyser(CONFIG).energies(noise).band.mean()), abs=0.05)


@pytest.mark.parametrize("hz", [60, 75, 100, 180])
def test_tones_in_the_band_count(hz: float) -> None:
    """At least what white noise of the same power has."""
    assert Analyser(CONFIG).energies(tone(hz)).band.min() > 1


@pytest.mark.parametrize("hz", [0.5, 3, 10, 300, 450])
def test_tones_outside_the_band_do_not(hz: float) -> None:
    """Axle weight and road traffic are slower, optical noise is faster: 30 dB less."""
    assert Analyser(CONFIG).energies(tone(hz)).band.max() < 1 / 1_000 * Analyser(CONFIG).energies(tone(100)).band.min()


@pytest.mark.parametrize("strange", [np.nan, np.inf, -np.inf])
def test_what_is_not_finite_shows_wherever_it_is(strange: float) -> None:
    """Every frame has a weight in every energy of its window."""
    analyser = Analyser(CONFIG)
    for frame in range(0, FRAMES, 7):
        rate = np.ones((FRAMES, CHANNELS), dtype=np.float32)
        rate[frame, 5] = strange
        energy = analyser.energies(rate).band
        assert not np.isfinite(energy[frame // CONFIG.band.window_frames, 5])
        assert 1 == (~np.isfinite(energy)).sum()


def test_the_emitters_tone_is_taken_only_with_emitters() -> None:
    """And is not in the band."""
    assert Analyser(CONFIG).energies(tone(240)).tone is None
    listening = CONFIG.model_copy(
        update={"emission": Emission(emitters=(Emitter(id="E", fibre_mm=5_000, bits="10110100"),))}
    )
    energies = Analyser(listening).energies(tone(240))
    assert energies.tone is not None
    assert energies.tone.min() > 10_000 * energies.band.max()


def test_smoothing_goes_over_the_seams_of_blocks() -> None:
    """In parts or at once: the same means."""
    energy = np.random.default_rng(0).random((20, 4)).astype(np.float32)
    whole = Smoother(3).smooth(energy)
    parts = Smoother(3)
    assert np.allclose(whole, np.concatenate([parts.smooth(energy[:10]), parts.smooth(energy[10:])]))
    assert np.allclose(energy[5:8].mean(axis=0), whole[7])
    assert np.array_equal(energy, Smoother(1).smooth(energy))


def learnt(energy: np.ndarray[tuple[int, int], np.dtype[np.float32]]) -> Quiet:
    """Quiet after learning from these windows."""
    quiet = Quiet(CONFIG.model_copy(update={"detection": Detection(floor_s=1)}))
    quiet.learn(energy)
    return quiet


def test_quiet_is_the_quietest_part() -> None:
    """A train in part of the first seconds is not taken for quiet."""
    energy = np.ones((20, CHANNELS), dtype=np.float32)
    energy[:12, 10:20] = 1_000
    level = learnt(energy).level
    assert level is not None
    assert np.allclose(1, level)


def test_quiet_is_not_known_at_once() -> None:
    """It takes its time."""
    assert learnt(np.ones((19, CHANNELS), dtype=np.float32)).level is None


def test_quiet_follows_where_nothing_shakes() -> None:
    """Slowly; a shaken channel keeps its level."""
    quiet = learnt(np.ones((20, CHANNELS), dtype=np.float32))
    shaken = np.zeros((10, CHANNELS), dtype=np.bool_)
    shaken[:, 3] = True
    for _ in range(20):
        quiet.follow(np.full((10, CHANNELS), 2, dtype=np.float32), shaken)
    assert quiet.level is not None
    assert 2 == pytest.approx(float(quiet.level[5]), abs=0.01)
    assert 1 == quiet.level[3]
