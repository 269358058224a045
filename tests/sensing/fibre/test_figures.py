"""Figures that do not fit together are refused, with the figures that would."""

from __future__ import annotations

from typing import Any

import pytest

from safeloc.sensing.fibre.figures import (
    Band,
    Emission,
    Emitter,
    FibreConfig,
    Interrogator,
    PointPlace,
    SectionPlace,
    Sections,
    apart,
    tones_hz,
)


def test_two_pulses_in_the_fibre_are_refused_with_the_figures() -> None:
    """Above V/(2L); at it, not."""
    with pytest.raises(ValueError, match=r"2600 pulses .* 40000000 mm .* 204218296 m/s .* 391\.74 us .* 2552\.7 Hz"):
        Interrogator(pulse_hz=2_600)
    assert 2_552 == Interrogator(pulse_hz=2_552).pulse_hz


def test_frames_are_means_over_whole_pulses_and_gauges_of_whole_channels() -> None:
    """2000 pulses a second, two to a frame."""
    assert 1_000 == Interrogator(pulse_hz=2_000, pulses_per_frame=2).frame_hz
    with pytest.raises(ValueError, match="multiple of pulses_per_frame"):
        Interrogator(pulse_hz=2_000, pulses_per_frame=3)
    with pytest.raises(ValueError, match="multiple of channel_mm"):
        Interrogator(gauge_mm=15_000)


def test_a_channel_feels_gauge_and_pulse() -> None:
    """50 ns light 5.11 m; the last channel's whole span lies in the fibre."""
    inter = Interrogator()
    assert (5_106, 15_106) == (inter.pulse_mm, inter.span_mm)
    assert (inter.channels - 1) * inter.channel_mm + inter.span_mm <= inter.fibre_mm
    assert inter.channels * inter.channel_mm + inter.span_mm > inter.fibre_mm


def test_tones_lie_in_the_band_with_their_main_lobes() -> None:
    """Windows of 50 ms resolve 20 Hz."""
    assert [60, 80, 100, 120, 140, 160, 180] == tones_hz(FibreConfig())


LONG = Interrogator(pulse_ns=100)


def emitters(*bits: str) -> tuple[Emitter, ...]:
    """Emitters E0, E1 ... with these patterns."""
    return tuple(Emitter(id=f"E{number}", fibre_mm=1_000, bits=one) for number, one in enumerate(bits))


@pytest.mark.parametrize(
    ("wrong", "message"),
    [
        ({"band": Band(low_hz=40, high_hz=500)}, "does not lie below half the frame rate of 1000 Hz"),
        ({"band": Band(window_frames=16, low_hz=40, high_hz=100)}, "resolve no tone"),
        (
            {"emission": Emission(emitters=emitters("10110100"), tone_hz=100)},
            "between the band and half the frame rate",
        ),
        ({"section_places": (SectionPlace(id="S", from_mm=9, to_mm=9, effect="raises"),)}, "from_mm < to_mm"),
        (
            {"section_places": (SectionPlace(id="S", from_mm=9, to_mm=50_000_000, effect="raises"),)},
            "has to lie on the fibre",
        ),
        ({"point_places": (PointPlace(id="P", fibre_mm=5),)}, "may lie in between"),
        ({"point_places": (PointPlace(id="P", fibre_mm=50_000_000),)}, "P lies beyond the fibre's end"),
        (
            {"point_places": (PointPlace(id="P", fibre_mm=5), PointPlace(id="P", fibre_mm=7)), "interrogator": LONG},
            "twice: P",
        ),
    ],
)
def test_figures_fit_together(wrong: dict[str, Any], message: str) -> None:
    """Each of these does not."""
    with pytest.raises(ValueError, match=message):
        FibreConfig(**wrong)


@pytest.mark.parametrize(
    ("bits", "message"),
    [
        (("11101000", "11101001"), "differ in fewer than 4 bits"),
        (("11101000", "111010001"), "same number of bits"),
        (("01110100",), "has to begin with 1"),
        (("11110000",), "4 zeros in a row"),
    ],
)
def test_patterns_are_told_apart(bits: tuple[str, ...], message: str) -> None:
    """Emitters whose patterns could be confused are refused."""
    with pytest.raises(ValueError, match=message):
        Emission(emitters=emitters(*bits))


def test_emitters_have_names_of_their_own() -> None:
    """Two of one name are refused."""
    one = Emitter(id="E", fibre_mm=1, bits="11101000")
    with pytest.raises(ValueError, match="two emitters are named E"):
        Emission(emitters=(one, one.model_copy(update={"bits": "10001111"})))


def test_hysteresis_is_one() -> None:
    """The way back lies below the way in."""
    with pytest.raises(ValueError, match="has to lie below change_cdb"):
        Sections(change_cdb=500, return_cdb=500)


def test_distance_between_patterns() -> None:
    """Counted bit by bit."""
    assert 2 == apart("1100", "1010")
