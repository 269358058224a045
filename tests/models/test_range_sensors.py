"""Ultrasound, light and laser in place of the radar: figures that physics bounds, and wrong ones that are refused."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from itertools import product
from math import sqrt

import pytest
from pydantic import ValidationError

from safeloc.assurance.law_figures import configured_figures
from safeloc.assurance.register import figures_to_confirm
from safeloc.cli.listing import list_
from safeloc.language.machine import Machine
from safeloc.language.spec import Property
from safeloc.models.reflector import build
from safeloc.models.reflector.configurations import CONFIGURATIONS
from safeloc.models.reflector.range_sensors import LaserConfig, LightConfig, UltrasoundConfig
from safeloc.models.reflector.target import ENTRIES
from safeloc.models.reflector.variables import ReflectorConfig, parts
from safeloc.properties.reflector import properties
from tests.models.edited_terms import edited, keeps

RADAR = ReflectorConfig()
OF_RADAR = RADAR.share_ppm(RADAR.frame_latency_ms)
KINDS = {"ultrasound": UltrasoundConfig, "light": LightConfig, "laser": LaserConfig}


# ------------------------------------------------------------------ what physics says of ultrasound


def sound_m_s(air_c: float) -> float:
    """The speed of sound in dry air."""
    return 331.3 * sqrt((273.15 + air_c) / 273.15)


def measured_m(range_m: float, air_c: float, told_c: float, wind_m_s: float, humidity: float, clock: float) -> float:
    """What a sensor measures that believes its thermometer: half of the way that sound goes in the time there and back."""
    sound = sound_m_s(air_c) * (1 + humidity)
    there_and_back = range_m / (sound + wind_m_s) + range_m / (sound - wind_m_s)
    return there_and_back * (1 + clock) * sound_m_s(told_c) / 2


def worst_ppm(config: UltrasoundConfig, air_c: float) -> float:
    """The greatest error in proportion to the measured range that air, thermometer, wind and clock make."""
    told = [air_c + sign * config.thermometer_error_k for sign in (-1, 0, 1)]
    wind, wet, off = config.wind_mm_s / 1e3, config.humidity_ppm / 1e6, config.clock_ppm / 1e6
    found = (measured_m(10, air_c, *one) for one in product(told, (0, wind), (0, -wet, wet), (-off, off)))
    return max(abs(one - 10) / one * 1e6 for one in found)


def test_air_errs_no_more_than_the_scale() -> None:
    """From the coldest air on, the formula holds what air does to a range, and is no wider than a tenth."""
    config = UltrasoundConfig()
    worst = [worst_ppm(config, air_c) for air_c in range(config.coldest_air_c, 41)]
    assert max(worst) <= config.air_ppm <= max(worst) * 1.1
    assert worst_ppm(config, config.coldest_air_c - 20) > config.air_ppm


def test_the_speed_of_sound_is_the_known_one() -> None:
    """343 m/s at 20 degrees C; never faster than in the coldest air, so that the time of flight is not too short."""
    assert UltrasoundConfig(coldest_air_c=20).slowest_sound_mm_s == pytest.approx(343_200, abs=200)
    config = UltrasoundConfig()
    assert config.slowest_sound_mm_s <= sound_m_s(config.coldest_air_c) * 1_000
    assert (
        config.time_of_flight_ms - 1
        < 2 * config.range_limit_mm / config.slowest_sound_mm_s * 1_000
        <= config.time_of_flight_ms
    )


def test_sound_measures_the_range_of_a_moment_on_its_way() -> None:
    """At 20 m/s towards the reflector the range lies between those at sending and at receiving, so the latency covers it."""
    away_m, speed, sound = 10.0, 20.0, sound_m_s(0)
    flight_s = 2 * away_m / (sound + speed)
    half = flight_s * sound / 2
    assert away_m - speed * flight_s < half < away_m
    assert flight_s * 1_000 < UltrasoundConfig().time_of_flight_ms


def test_light_is_unambiguous_up_to_half_a_wave() -> None:
    """2.5 MHz have a wave of 120 m."""
    assert 59_958 == LightConfig().unambiguous_mm
    assert 29_979 == LightConfig(modulation_khz=5_000, range_limit_mm=29_979, strong_range_mm=29_000).unambiguous_mm


@pytest.mark.parametrize(
    ("kind", "fields", "message"),
    [
        (UltrasoundConfig, {"radar_scale_ppm": 21_393}, r"radar_scale_ppm 21393 is below the 21394 ppm that air and clock make"),
        (UltrasoundConfig, {"coldest_air_c": -50}, "is below the .* ppm that air and clock make of a range; raise it, or measure"),
        (UltrasoundConfig, {"thermometer_error_k": 4}, "that air and clock make of a range"),
        (UltrasoundConfig, {"wind_mm_s": 32_000}, "that air and clock make of a range"),
        (UltrasoundConfig, {"frame_latency_ms": 96}, "frame_latency_ms 96 is below 97: so long does sound take to range_limit_mm 12000"),
        (UltrasoundConfig, {"range_limit_mm": 13_000}, "raise it, or lower range_limit_mm"),
        (LightConfig, {"range_limit_mm": 59_959}, r"range of 2500 kHz, 59958 mm: farther reflectors would seem near; lower them"),
        (LightConfig, {"strong_range_mm": 60_000}, "strong_range_mm 60000 must not exceed the unambiguous range"),
        (LightConfig, {"modulation_khz": 5_000}, "must not exceed the unambiguous range of 5000 kHz, 29979 mm"),
        (LaserConfig, {"range_limit_mm": 2_000}, "no echo can be used"),
    ],
)  # fmt: skip
def test_figures_that_physics_excludes_are_refused(
    kind: type[ReflectorConfig], fields: dict[str, int], message: str
) -> None:
    """The message says what the figure has to be, and what else could change."""
    with pytest.raises(ValidationError, match=message):
        kind(**fields)  # type: ignore[arg-type]


def test_figures_at_their_limits_are_taken() -> None:
    """And one unit beyond is not: the cases above."""
    UltrasoundConfig(radar_scale_ppm=21_394, frame_latency_ms=97)
    LightConfig(range_limit_mm=59_958, strong_range_mm=59_958)


# ------------------------------------------------------------------ sources


@pytest.mark.parametrize("kind", KINDS.values())
def test_each_kind_has_sources_of_its_own(kind: type[ReflectorConfig]) -> None:
    """Each figure has unit and source; what differs from the radar's says why, and so does each law on ranges."""
    radar, own = ({one.name: one for one in configured_figures(made())} for made in (ReflectorConfig, kind))
    assert all(one.unit and one.source for one in own.values() if not one.name.startswith(("odometer.", "checked_")))
    for name in (
        "range_limit_mm",
        "near_range_mm",
        "strong_range_mm",
        "frame_latency_ms",
        "radar_scale_ppm",
        "radar_drift_mm_s",
    ):
        assert own[name].source != radar[name].source, name
        assert own[name].source.startswith(("[M]", "[D]"))
    laws, of_radar = (build(parts(made())).machine.world.laws for made in (kind, ReflectorConfig))
    differ = {name for name, law in laws.items() if law.source != of_radar[name].source}
    assert differ == {
        "an echo of a reflector has its range", "the radar's systematic error drifts slowly",
        "the radar's scale is within its figure", "no strong echo comes from beyond the strong range",
    }  # fmt: skip
    assert {name: law.statement for name, law in laws.items()} == {
        name: law.statement for name, law in of_radar.items()
    }


def test_the_register_has_their_figures(capsys: pytest.CaptureFixture[str]) -> None:
    """Figures from memory of each kind have to be confirmed, and are listed with the configuration that has them."""
    [entry] = [one for one in ENTRIES if one.name == "reflector"]
    kinds = {f"reflector, {name}": config for name, config in entry.of_other_kinds.items()}
    assert 3 == len(kinds) == len([one for one in CONFIGURATIONS.named.values() if type(one) is not ReflectorConfig])
    listed = {(place, one.value) for one in figures_to_confirm([], kinds) for place in one.places}
    assert ("reflector, ultrasound in place of the radar: wind_mm_s", "30000") in listed
    assert ("reflector, light in place of the radar: radar_drift_mm_s", "5") in listed
    list_("config", machines=["reflector"])
    told = capsys.readouterr().out
    assert (
        "reflector, laser in place of the radar  frame_latency_ms = 40 ms  [M] one turn of the mirror at 25 Hz" in told
    )
    assert "reflector, ultrasound in place of the radar  slowest_sound_mm_s = 315775 mm/s" in told


# ------------------------------------------------------------------ the machine with another sensor's figures


def _made(kind: str) -> tuple[Machine, list[Property]]:
    model = build(parts(KINDS[kind](echo_slots=1)))
    return model.machine, properties(model)


Wrong = Callable[..., object]
WRONG: dict[tuple[str, str], tuple[str, Wrong]] = {
    ("ultrasound", "the radar's scale"): (
        "radar", lambda _, right: replace(right, scale_ppm=RADAR.radar_scale_ppm)),
    ("ultrasound", "a frame no older than the radar's"): (
        "share_ppm", lambda _, right, _latency: min(right, OF_RADAR)),
    ("light", "the radar's scale"): ("radar", lambda _, right: replace(right, scale_ppm=RADAR.radar_scale_ppm)),
    ("light", "the radar's drift"): ("drift_nm", lambda *_: RADAR.radar_drift_mm_s * RADAR.period_ms * 1_000),
    ("laser", "no scale"): ("radar", lambda _, right: replace(right, scale_ppm=0)),
    ("laser", "no latency"): ("share_ppm", lambda *_: 0),
}  # fmt: skip
"""Figures of the machine that are not those of its world: which, and what stands in their place."""


@pytest.mark.thorough(ordinary=1)
@pytest.mark.parametrize(("kind", "what"), WRONG)
def test_a_machine_with_other_figures_is_refused(monkeypatch: pytest.MonkeyPatch, kind: str, what: str) -> None:
    """Its own keep containment in each kind's world, and these do not."""
    name, wrong = WRONG[kind, what]
    assert keeps(_made(kind), "containment")
    edited(monkeypatch, ReflectorConfig, name, wrong)
    assert not keeps(_made(kind), "containment")
