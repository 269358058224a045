"""The front end from image to echoes: what is there is found within its bounds; what is not is not invented."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from pydantic import ValidationError

from safeloc.runtime.border import Reason
from safeloc.sensing.echoes import Echo
from safeloc.sensing.figures import Detection, RadarConfig, Reflectors, Sensor
from safeloc.sensing.images import NoFrame, RadarImage, Refusal
from safeloc.sensing.radar import Frame, FrontEnd, read
from safeloc.sensing.signature import MARKS, Doubt, Model
from safeloc.simulation.radar import Bias, image, points
from safeloc.simulation.radar_scene import World, seen, slant_mm, world
from safeloc.simulation.radar_track import Arc, Reflector
from tests.sensing.scenes import CONFIG, bare, frame, frame_at, models

PLACE_MM = 200_000


def of(found: Frame, model: Model) -> Echo:
    """The one echo of a model."""
    (echo,) = [echo for echo in found.echoes if echo.model is model]
    return echo


def lead_mm(speed_mm_s: float) -> float:
    """How far the vehicle runs until ranges hold."""
    return speed_mm_s * float(CONFIG.sensor.lead_us) / 1e6


@settings(max_examples=25, deadline=None)
@given(
    st.sampled_from(list(MARKS)),
    st.floats(10_000, 130_000),
    st.floats(-40_000, 40_000),
    st.tuples(*[st.sampled_from([-1.0, 1.0])] * 3),
    st.integers(0, 10**6),
)
def test_the_truth_lies_within_the_bounds(
    model: Model, ahead_mm: float, speed: float, bias: tuple[float, float, float], seed: int
) -> None:
    """Any model, range, speed and noise, with the sensor at the ends of its declared errors: model, range and sine."""
    reflector = Reflector(model, PLACE_MM)
    scene = bare([reflector])
    along = PLACE_MM - ahead_mm
    echo = of(frame_at(scene, along, seed, speed_mm_s=speed, bias=Bias(*bias)), model)
    assert abs(echo.range_mm - slant_mm(scene, reflector, along + lead_mm(speed))) <= echo.range_error_mm
    sine = reflector.left_mm / slant_mm(scene, reflector, along)
    assert abs(echo.sine_ppm - 1e6 * sine) <= echo.sine_error_ppm
    assert echo.doubt is None


def test_bounds_are_of_use() -> None:
    """25 mm at 50 m, 40 mm at 100 m, and the whole figure is not spent on rounding."""
    scene = bare([Reflector(Model.B, PLACE_MM)])
    near, far = (of(frame_at(scene, PLACE_MM - ahead), Model.B) for ahead in (50_000, 100_000))
    assert 10 < near.range_error_mm <= 25
    assert near.range_error_mm < far.range_error_mm <= 40


@pytest.fixture(scope="module")
def cluttered() -> World:
    """Two reflectors among masts and ballast."""
    reflectors = [Reflector(Model.A, PLACE_MM), Reflector(Model.D, PLACE_MM + 40_000)]
    return world(CONFIG, reflectors, np.random.default_rng(7), length_mm=300_000)


@pytest.mark.parametrize("ahead_mm", [15_000, 40_000, 70_000, 100_000])
def test_clutter_is_no_reflector(cluttered: World, ahead_mm: float) -> None:
    """Both reflectors are found within bounds, and no other echo has a model."""
    along = PLACE_MM - ahead_mm
    found = frame_at(cluttered, along, 3)
    assert [Model.A, Model.D] == models(found)
    for reflector in cluttered.reflectors:
        echo = of(found, reflector.model)
        assert abs(echo.range_mm - slant_mm(cluttered, reflector, along)) <= echo.range_error_mm
    assert len(found.echoes) > 2


def test_power_falls_by_the_range_law() -> None:
    """12 dB a doubling of range, where the ground reflects nothing; the section stays.

    The weakest corner is the last one, 5.4 m behind the first: 10.9 dB between 35.4 and 65.4 m.
    """
    dry = CONFIG.model_copy(update={"sensor": Sensor(ground_reflection_percent=0)})
    scene = bare([Reflector(Model.C, PLACE_MM)])
    near, far = (of(frame(seen(scene, PLACE_MM - ahead), config=dry), Model.C) for ahead in (30_000, 60_000))
    assert near.intensity_cdb - far.intensity_cdb == pytest.approx(4_000 * math.log10(65.4 / 35.4), abs=30)
    assert near.section_cdbsm == pytest.approx(far.section_cdbsm, abs=30)


def test_the_minimum_intensity_is_a_condition_on_range() -> None:
    """With 30 dB asked for instead of 20 dB a reflector is known later: RFL-1."""
    scene = bare([Reflector(Model.C, PLACE_MM)])
    asked = CONFIG.model_copy(update={"reflectors": Reflectors(minimum_cdb=4_000)})
    far, near = (seen(scene, PLACE_MM - ahead) for ahead in (120_000, 60_000))
    assert [Model.C] == models(frame(far))
    found = frame(far, config=asked)
    assert [] == models(found)
    assert Doubt.WEAK in {echo.doubt for echo in found.echoes}
    assert [Model.C] == models(frame(near, config=asked))


@pytest.mark.parametrize("bent", range(3))
def test_a_bent_corner_adds_error(bent: int) -> None:
    """One corner 60 mm too far: the bound grows by about as much, and holds what the two others say."""
    reflector = Reflector(Model.B, PLACE_MM)
    sound = seen(bare([reflector]), PLACE_MM - 50_000)
    off = sound.range_mm.copy()
    off[bent] += 60.0
    right, wrong = of(frame(sound), Model.B), of(frame(replace(sound, range_mm=off)), Model.B)
    assert abs(wrong.range_mm - sound.range_mm[0]) <= wrong.range_error_mm
    assert wrong.range_error_mm - right.range_error_mm == pytest.approx(30, abs=5)


@pytest.mark.parametrize("lost", range(3))
def test_a_lost_corner_leaves_no_model(lost: int) -> None:
    """Bent away, sawn off or covered: the rest is echoes of no model."""
    found = frame_at(bare([Reflector(Model.A, PLACE_MM, lost=(lost,))]), PLACE_MM - 50_000)
    assert [] == models(found)
    assert {Doubt.SHAPE} == {echo.doubt for echo in found.echoes}


@pytest.mark.parametrize("ahead_mm", [7_000, 10_000, 15_000, 25_000])
def test_the_echo_of_an_echo_is_no_reflector(ahead_mm: float) -> None:
    """Between reflector and vehicle front and back: at twice the range stands nothing with a model."""
    scene = bare([Reflector(Model.B, PLACE_MM)], double_bounce=True)
    found = frame_at(scene, PLACE_MM - ahead_mm)
    assert all(echo.range_mm < 1.5 * ahead_mm for echo in found.echoes if echo.model is not Model.UNKNOWN)
    assert len(found.echoes) > 1


@pytest.mark.parametrize("ahead_mm", [40_000, 60_000])
def test_a_wall_mirrors_no_reflector(ahead_mm: float) -> None:
    """The mirror image is farther, weaker, of the same model: a ghost; the reflector itself stands."""
    reflector = Reflector(Model.B, PLACE_MM)
    scene = bare([reflector], wall_mm=8_000)
    found = frame_at(scene, PLACE_MM - ahead_mm)
    direct = of(found, Model.B)
    assert abs(direct.range_mm - slant_mm(scene, reflector, PLACE_MM - ahead_mm)) <= direct.range_error_mm
    assert Doubt.GHOST in {echo.doubt for echo in found.echoes}


def test_turning_off_shows_in_the_sine() -> None:
    """On a turnout of 300 m to the left, the reflector of the straight moves to the right in the image (RFL-12)."""
    straight = Reflector(Model.A, 150_000)
    turnout = [Arc(60_000), Arc(100_000, 300_000)]
    rng = np.random.default_rng(0)
    turning, going = (world(CONFIG, [straight], rng, track=track, length_mm=1.0) for track in (turnout, []))
    before = [of(frame_at(scene, 60_000), Model.A).sine_ppm for scene in (turning, going)]
    after = [of(frame_at(scene, 90_000), Model.A).sine_ppm for scene in (turning, going)]
    assert before[0] == pytest.approx(before[1], abs=2_000)
    assert after[0] - after[1] < -90_000


@pytest.mark.parametrize("model", MARKS)
def test_a_reflector_is_known_while_the_vehicle_turns_off(model: Model) -> None:
    """Through the first 20 m of a turnout of 190 m, and within the bounds: long enough to see where it goes."""
    reflector = Reflector(model, 130_000)
    turnout = [Arc(60_000), Arc(21_000, 190_000)]
    scene = world(CONFIG, [reflector], np.random.default_rng(0), track=turnout, length_mm=1.0)
    for along in (50_000, 65_000, 72_000, 80_000):
        echo = of(frame_at(scene, along), model)
        assert abs(echo.range_mm - slant_mm(scene, reflector, along)) <= echo.range_error_mm


# ------------------------------------------------------------------ frames, and none


def test_too_many_peaks_are_no_picture() -> None:
    """Refused as a whole: what does not fit is not left out in silence."""
    few = CONFIG.model_copy(update={"detection": Detection(most_peaks=10)})
    rng = np.random.default_rng(0)
    many = points(np.linspace(10_000, 100_000, 30), np.zeros(30), 100.0)
    outcome = read(RadarImage(image(many, few, rng), 0, 0), few)
    assert isinstance(outcome, NoFrame)
    assert outcome.reason is Refusal.CROWDED


def test_an_empty_line_is_a_frame_without_echoes() -> None:
    """Nothing seen is not nothing measured."""
    found = frame_at(bare([]), 0.0)
    assert found.echoes == ()
    assert found.floor_cdb == pytest.approx(0, abs=30)


def test_the_stream_is_judged_before_the_picture() -> None:
    """Missing, then sound, then delivered again."""
    front = FrontEnd(CONFIG, max_age_ms=100)
    power = image(seen(bare([Reflector(Model.A, PLACE_MM)]), 150_000), CONFIG, np.random.default_rng(0))
    sound = RadarImage(power, 50, 1)
    outcomes = [front.receive(one, 60) for one in (None, sound, sound)]
    assert outcomes[0] == NoFrame(Reason.MISSING)
    assert isinstance(outcomes[1], Frame)
    assert [Model.A] == models(outcomes[1])
    assert isinstance(outcomes[2], NoFrame)
    assert outcomes[2].reason is Reason.DUPLICATE


@pytest.mark.parametrize(
    ("message", "wrong"),
    [
        ("corners 600 mm apart cannot be resolved with cells of 599 mm", {"sensor": Sensor(bandwidth_mhz=250)}),
        ("makes models overlap", {"reflectors": Reflectors(mark_tolerance_mm=201)}),
    ],
    ids=["too coarse", "too tolerant"],
)
def test_figures_that_cannot_work_are_refused(message: str, wrong: dict[str, object]) -> None:
    """When the configuration is made, with what to do."""
    with pytest.raises(ValidationError, match=message):
        RadarConfig(**wrong)  # type: ignore[arg-type]
    with pytest.raises(ValidationError, match="overload_cdb has to be at least 1000 below"):
        Sensor(overload_cdb=10_000)
    with pytest.raises(ValidationError, match="so that it has a middle"):
        Detection(window_cells=34)


def test_a_radar_of_24_ghz_reads_reflectors_made_for_it() -> None:
    """250 MHz and marks of 2.4 m: the same shapes, four times as long."""
    config = RadarConfig(
        sensor=Sensor(carrier_mhz=24_000, bandwidth_mhz=250, samples=256),
        reflectors=Reflectors(unit_mm=2_400, mark_tolerance_mm=600, edge_mm=300),
    )
    reflector = Reflector(Model.D, PLACE_MM)
    scene = world(config, [reflector], np.random.default_rng(0), length_mm=1.0)
    echo = of(frame(seen(scene, PLACE_MM - 60_000), config=config), Model.D)
    assert abs(echo.range_mm - slant_mm(scene, reflector, PLACE_MM - 60_000)) <= echo.range_error_mm < 100
