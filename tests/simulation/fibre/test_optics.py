"""Light: phase follows strain, fades, drifts, and is folded by an open end."""

from __future__ import annotations

import numpy as np
import pytest

from safeloc.sensing.fibre.figures import Interrogator
from safeloc.simulation.fibre.cable import CableFigures, cable
from safeloc.simulation.fibre.optics import Backscatter, Drift, OpticsFigures, Receiver

INTER = Interrogator(fibre_mm=2_000_000)
SILENT = OpticsFigures(
    snr_cdb=10_000, laser_mrad=0, laser_drift_mrad_s=0, thermal_mrad_s=0, ambient_mrad=0, loss_cdb_km=0
)
FRAMES = 200


def received(
    strain: np.ndarray[tuple[int, int], np.dtype[np.float64]] | None = None,
    *,
    inter: Interrogator = INTER,
    figures: OpticsFigures = SILENT,
    drift: Drift | None = None,
    points_m: tuple[float, ...] = (),
    absorber: bool = True,
) -> Backscatter:
    """One block; without strain nothing moves."""
    laid = cable(
        inter, np.random.default_rng(0), figures=CableFigures(coupling_cdb=0), points_m=points_m, absorber=absorber
    )
    strain = np.zeros((FRAMES, len(laid.track_m))) if strain is None else strain
    return Receiver(inter, laid, np.random.default_rng(1), figures).receive(strain, drift)


def shaken(
    low_m: float, high_m: float, amplitude: float = 3.0, hz: float = 20
) -> np.ndarray[tuple[int, int], np.dtype[np.float64]]:
    """Strain between two places of the fibre, in 1e-9."""
    places = (np.arange(800) + 0.5) * 2.5
    wave = amplitude * np.sin(2 * np.pi * hz * np.arange(FRAMES) / 1_000)
    return wave[:, None] * ((places >= low_m) & (places < high_m))[None, :]


def test_still_fibre_is_still() -> None:
    """But for numbers' rounding and the least noise."""
    assert np.abs(received().phase_rate).max() < 0.01
    assert ((FRAMES, INTER.channels), (INTER.light_channels,)) == (
        received().phase_rate.shape,
        received().intensity.shape,
    )


def test_only_the_channels_over_the_strain_feel_it() -> None:
    """A channel's gauge and pulse; what lies beyond only moves as a whole."""
    rms = received(shaken(1_000, 1_050)).phase_rate.std(axis=0)
    felt = np.flatnonzero(rms > 0.02)
    assert 98 <= felt.min()
    assert felt.max() <= 105
    assert {100, 101, 102, 103} <= set(felt.tolist())


def test_phase_is_twice_the_way_times_strain() -> None:
    """4 pi n 0.78 / wave length, over the gauge: 0.093 rad for 1e-9 over 10 m."""
    rate = received(shaken(900, 1_200, amplitude=3.0, hz=20)).phase_rate[:, 100:110]
    expected = 0.0928 * 3.0 * 2 * np.pi * 20 / 1_000 / np.sqrt(2)
    assert expected == pytest.approx(np.median(rate.std(axis=0)), rel=0.1)


def test_scatter_fades() -> None:
    """Intensity is spread like an exponential: a tenth of the places has less than a tenth of the mean."""
    intensity = received().intensity
    assert 0.05 < (intensity < 0.1 * intensity.mean()).mean() < 0.2


def test_noise_grows_where_little_light_comes_back() -> None:
    """Faded channels are the noisy ones; and far ones, with loss."""
    noisy = received(figures=SILENT.model_copy(update={"snr_cdb": 3_000}))
    faint = noisy.intensity[: INTER.channels] < np.median(noisy.intensity) / 10
    noise = noisy.phase_rate.std(axis=0)
    assert noise[faint].mean() > 2 * np.median(noise)
    lossy = received(figures=SILENT.model_copy(update={"loss_cdb_km": 500}))
    assert lossy.intensity[150:].mean() < lossy.intensity[:50].mean() / 5


def test_frames_over_several_pulses_have_less_noise() -> None:
    """Four pulses: half the noise."""
    noisy = SILENT.model_copy(update={"snr_cdb": 4_000})
    one = received(figures=noisy).phase_rate.std()
    four = received(figures=noisy, inter=INTER.model_copy(update={"pulses_per_frame": 4})).phase_rate.std()
    assert 2 == pytest.approx(np.median(one) / np.median(four), rel=0.4)


def test_the_laser_shakes_all_channels_alike() -> None:
    """Common to them."""
    rate = received(figures=SILENT.model_copy(update={"laser_mrad": 100})).phase_rate
    assert np.corrcoef(rate[:, 20], rate[:, 150])[0, 1] > 0.9


def test_fading_wanders() -> None:
    """With temperature; without it, not."""
    laid = cable(INTER, np.random.default_rng(0))
    still = np.zeros((FRAMES, len(laid.track_m)))
    for thermal, alike in ((0, True), (2_000, False)):
        receiver = Receiver(
            INTER, laid, np.random.default_rng(1), SILENT.model_copy(update={"thermal_mrad_s": thermal})
        )
        first = receiver.receive(still).intensity
        for _ in range(10):
            last = receiver.receive(still).intensity
        assert alike is bool(np.corrcoef(first, last)[0, 1] > 0.99)


def test_points_stand_out_and_move_with_drift() -> None:
    """At 1 km; 1 % of index moves them by one channel, 100 ns of trigger too."""
    inter = INTER.model_copy(update={"pulse_ns": 100})
    places = [
        int(np.argmax(received(inter=inter, points_m=(1_000.0,), drift=drift).intensity))
        for drift in (Drift(), Drift(index_ppm=10_500), Drift(trigger_ps=105_000))
    ]
    assert [100, 101, 101] == places


def test_an_open_end_shows_and_folds_mirrored_trains() -> None:
    """Its reflection is bright; at a high pulse rate, what shakes at z is felt at 2L - z less a pulse's way too."""
    fibre = INTER.model_copy(update={"pulse_hz": 50_000, "pulses_per_frame": 50, "pulse_ns": 100})
    period_m = 204_218_296 / 2 / 50_000
    mirrored = int((2 * 2_000 - period_m - 1_500) // 10)
    waves = shaken(1_450, 1_500, amplitude=5.0)
    rms = {
        absorber: received(waves, inter=fibre, absorber=absorber).phase_rate.std(axis=0)[mirrored - 2 : mirrored + 8]
        for absorber in (True, False)
    }
    assert rms[True].max() < 0.01
    assert rms[False].max() > 0.02
    assert received(inter=fibre, absorber=False).intensity[-1] > 1_000


def test_blocks_join_without_a_seam() -> None:
    """Two halves are the whole."""
    laid = cable(INTER, np.random.default_rng(0))
    waves = shaken(500, 600)
    whole = Receiver(INTER, laid, np.random.default_rng(1), SILENT).receive(waves).phase_rate
    parts = Receiver(INTER, laid, np.random.default_rng(1), SILENT)
    halves = np.concatenate([parts.receive(waves[:100]).phase_rate, parts.receive(waves[100:]).phase_rate])
    assert np.allclose(whole[:, 45:65], halves[:, 45:65], atol=0.02)
