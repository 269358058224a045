"""A run past reflectors: what is delivered frame by frame, with each fault, and what the front end makes of it."""

from __future__ import annotations

import numpy as np
import pytest

from safeloc.errors import InputError
from safeloc.runtime.border import Reason
from safeloc.sensing.figures import RadarConfig
from safeloc.sensing.images import NoFrame, Refusal
from safeloc.sensing.radar import Frame, FrontEnd, Outcome
from safeloc.sensing.signature import Model
from safeloc.simulation.faults import Fault
from safeloc.simulation.motion import Leg, Motion, VehicleConfig, move
from safeloc.simulation.radar import Weather, points
from safeloc.simulation.radar_scene import Clutter, World, rain, seen, shots, slant_mm, world
from safeloc.simulation.radar_track import Reflector, corners

CONFIG = RadarConfig()
PERIOD = CONFIG.sensor.frame_period_ms
BEGIN, END = 4, 7


def run(seconds: float = 0.6, start_mm: int = 150_000) -> Motion:
    """A vehicle at 15 m/s, from this place on."""
    motion = move(VehicleConfig(), [Leg(15_000, 30.0)], PERIOD)
    frames = round(seconds * 1_000 / PERIOD)
    fast = slice(len(motion.position_nm) - frames, None)
    moved = motion.position_nm[fast] - motion.position_nm[fast][0] + start_mm * 1_000_000
    return Motion(PERIOD, moved, motion.speed_mm_s[fast], int(moved[0]))


def scene(*, stones_per_m: int = 0) -> World:
    """A reflector 50 m ahead of the run."""
    clutter = Clutter(stones_per_m=stones_per_m)
    return world(CONFIG, [Reflector(Model.C, 200_000)], np.random.default_rng(1), length_mm=300_000, clutter=clutter)


def outcomes(*kinds: str, weather: Weather | None = None) -> list[Outcome]:
    """What the front end makes of each frame, with these faults from BEGIN to END; frames may be 100 ms old."""
    front = FrontEnd(CONFIG, max_age_ms=100)
    faults = [Fault(kind, "", BEGIN, END) for kind in kinds]
    taken = shots(run(), scene(), np.random.default_rng(2), faults=faults, weather=weather)
    return [front.receive(shot.image, shot.delivered_ms) for shot in taken]


def sees(outcome: Outcome) -> bool:
    """Whether the reflector is known."""
    return isinstance(outcome, Frame) and [Model.C] == [
        echo.model for echo in outcome.echoes if echo.model is not Model.UNKNOWN
    ]


def test_a_sound_run_sees_the_reflector_in_every_frame() -> None:
    """Twelve frames, also in heavy rain."""
    assert [True] * 12 == [sees(one) for one in outcomes()]
    assert [True] * 12 == [sees(one) for one in outcomes(weather=Weather(rain_mm_h=30))]


@pytest.mark.thorough(ordinary=2)
@pytest.mark.parametrize(
    ("kind", "reason"),
    [
        ("missing", Reason.MISSING),
        ("frozen", Refusal.FROZEN),
        ("duplicate", Reason.DUPLICATE),
        ("late", Reason.STALE),
        ("not finite", Reason.NOT_FINITE),
        ("wrong shape", Refusal.WRONG_SHAPE),
        ("negative", Refusal.NEGATIVE),
        ("jamming", Refusal.JAMMED),
        ("overload", Refusal.OVERLOADED),
    ],
)
def test_each_fault_has_its_reason_and_passes(kind: str, reason: Refusal) -> None:
    """No frame while it lasts, for that reason; the reflector before it, and after it."""
    found = outcomes(kind)
    assert [reason] * 3 == [one.reason for one in found[BEGIN:END] if isinstance(one, NoFrame)]
    assert all(sees(one) for one in found[:BEGIN])
    assert all(sees(one) for one in found[END:])


def test_a_dead_receiver_is_noticed_twice() -> None:
    """No noise; then, moreover, the same picture again."""
    found = [one.reason for one in outcomes("dead")[BEGIN:END] if isinstance(one, NoFrame)]
    assert [Refusal.DEAD, Refusal.FROZEN, Refusal.FROZEN] == found


@pytest.mark.parametrize("kind", ["cloudburst", "interference"])
def test_disturbed_air_makes_no_model(kind: str) -> None:
    """Drops and strange chirps are echoes of no model; the frames are frames."""
    for one in outcomes(kind)[BEGIN:END]:
        assert isinstance(one, Frame)
        assert {Model.UNKNOWN, Model.C} >= {echo.model for echo in one.echoes}


def test_a_wet_cover_blinds_in_silence() -> None:
    """40 dB less: frames like any other, without the reflector. Only a reference measurement tells this from an empty
    line (RFL-6)."""
    found = outcomes("film")
    assert all(isinstance(one, Frame) and not sees(one) for one in found[BEGIN:END])
    assert all(sees(one) for one in found[END:])


def test_truth_goes_with_every_frame() -> None:
    """Place and speed of the antenna at the frame's time; ranges fall by the distance run."""
    taken = list(shots(run(), scene(), np.random.default_rng(2)))
    assert [shot.delivered_ms for shot in taken] == [PERIOD * (number + 1) for number in range(12)]
    reflector = Reflector(Model.C, 200_000)
    slants = np.array([slant_mm(scene(), reflector, shot.along_mm) for shot in taken])
    assert slants[0] == pytest.approx(np.hypot(50_000, 3_000))
    assert np.diff(slants) == pytest.approx(-750, abs=5)


def test_a_seed_is_a_run() -> None:
    """The same seed gives the same images, another gives others."""
    one, same, other = (
        next(iter(shots(run(), scene(stones_per_m=2), np.random.default_rng(seed)))).image for seed in (3, 3, 4)
    )
    assert one is not None
    assert same is not None
    assert other is not None
    assert np.array_equal(np.asarray(one.power), np.asarray(same.power))
    assert not np.array_equal(np.asarray(one.power), np.asarray(other.power))


@pytest.mark.parametrize(
    "fault",
    [Fault("dead", "", 3, 3), Fault("dead", "", -1, 2), Fault("dead", "", 12, 13), Fault("dead", "rear", 3, 4)],
    ids=str,
)
def test_a_fault_outside_the_run_is_refused(fault: Fault) -> None:
    """It would test nothing."""
    with pytest.raises(
        InputError,
        match=r"needs 0 <= begin < end\.$|begins after the run, which is 12 long\.$|there is one only, which has no name\.$",
    ):
        list(shots(run(), scene(), np.random.default_rng(0), faults=[fault]))


def test_corners_stand_at_the_marks_of_their_model() -> None:
    """Along the track, staggered in height; lost ones are gone; no model, no reflector."""
    places = corners(Reflector(Model.B, 10_000), CONFIG.reflectors)
    assert places[:, 0] == pytest.approx([10_000, 11_800, 16_000])
    assert places[:, 1] == pytest.approx([-3_000] * 3)
    assert len(set(places[:, 2])) == 3
    assert len(corners(Reflector(Model.B, 10_000, lost=(0, 2)), CONFIG.reflectors)) == 1
    with pytest.raises(InputError, match=r"^a reflector needs a model; take A, B, C or D\.$"):
        corners(Reflector(Model.UNKNOWN, 10_000), CONFIG.reflectors)


def test_detours_are_longer() -> None:
    """By the vehicle's front at sums of two ranges, by a wall at the range of the mirror image."""
    reflector = Reflector(Model.A, 50_000)
    rng = np.random.default_rng(0)
    plain, bounced, walled = (
        seen(world(CONFIG, [reflector], rng, length_mm=1.0, wall_mm=wall, double_bounce=bounce), 0.0)
        for wall, bounce in ((None, False), (None, True), (8_000, False))
    )
    assert (3, 12, 6) == (len(plain.sine), len(bounced.sine), len(walled.sine))
    assert bounced.range_mm[3] == pytest.approx(2 * plain.range_mm[0])
    assert walled.range_mm[3] == pytest.approx(np.sqrt(50_000**2 + 19_000**2), rel=1e-4)
    assert walled.section_m2[3] < plain.section_m2[0]


def test_rain_grows_with_range_and_intensity() -> None:
    """Drops of a shell: as its volume, so with the square of range; twice the rain, twice the section."""
    drops, more = (rain(mm_h, np.random.default_rng(0), 150_000) for mm_h in (10, 20))
    assert more.section_m2 == pytest.approx(2 * drops.section_m2)
    far = drops.range_mm > 75_000
    assert drops.section_m2[far].mean() > 3 * drops.section_m2[~far].mean()
    assert points(np.ones(2), np.zeros(2), 3.0).section_m2 == pytest.approx([3.0, 3.0])
