"""The whole fibre front end over simulated backscatter, and over a recorded earthquake."""

from __future__ import annotations

from functools import cache
from itertools import pairwise

import numpy as np
import pytest

from safeloc.runtime.border import Reason
from safeloc.sensing.fibre.blocks import NoFibre, Refusal
from safeloc.sensing.fibre.features import FibreFrame, Trouble
from safeloc.sensing.fibre.figures import (
    Band,
    Detection,
    Emission,
    Emitter,
    FibreConfig,
    Interrogator,
    PointPlace,
    SectionPlace,
)
from safeloc.sensing.fibre.front_end import FrontEnd, Outcome, read_all
from safeloc.sensing.fibre.recordings import blocks, read_array
from safeloc.sensing.fibre.sections import Edge, Effect
from safeloc.simulation.faults import Fault
from safeloc.simulation.fibre.cable import Section
from safeloc.simulation.fibre.emitters import Sounding
from safeloc.simulation.fibre.ground import Car
from safeloc.simulation.fibre.optics import Drift
from safeloc.simulation.fibre.scene import Shot
from tests.data_sources import data_file
from tests.sensing.fibre.scenes import CONFIG, coaches, frames, seen, told, world

Outcomes = tuple[tuple[Shot, Outcome], ...]
WAVE = (SectionPlace(id="S1", from_mm=900_000, to_mm=960_000, effect="raises"),)


@cache
def plain_run(speed: float) -> Outcomes:
    """Five coaches along the fibre, 30 s."""
    return tuple(seen(world(coaches(5, 200 if speed > 0 else 1_800, speed)), 80))


@pytest.mark.thorough
@pytest.mark.parametrize("speed", [40.0, -40.0])
def test_a_train_is_told_within_its_bounds(speed: float) -> None:
    """Ends, length and speed, in both directions; one track all along."""
    found = told(plain_run(speed))
    assert len(found) > 20
    assert 1 == len({train.track for _, train in found})
    for shot, train in found:
        truth = shot.trains[0]
        assert train.low is None or train.low.path_mm.low <= truth.low_m * 1_000 <= train.low.path_mm.high
        assert train.high is None or train.high.path_mm.low <= truth.high_m * 1_000 <= train.high.path_mm.high
        assert train.speed_mm_s.low <= truth.speed_m_s * 1_000 <= train.speed_mm_s.high
        assert train.length_mm is None or train.length_mm.low <= 132_000 <= train.length_mm.high
        assert train.direction in (0, 1 if speed > 0 else -1)


def test_front_and_rear_follow_the_direction() -> None:
    """The front is ahead."""
    for speed in (40.0, -40.0):
        _, train = told(plain_run(speed))[10]
        assert train.front is not None
        assert train.rear is not None
        assert (train.front.path_mm.low > train.rear.path_mm.low) is (speed > 0)


@pytest.mark.thorough
def test_times_of_flight_grow_as_the_train_goes_away() -> None:
    """And lie within the fibre's two-way time: 9.79 ns a metre."""
    ends = [train.high for _, train in told(plain_run(40.0)) if train.high is not None]
    flights = [(end.time_of_flight_ps.low + end.time_of_flight_ps.high) / 2 for end in ends]
    assert all(later > before for before, later in pairwise(flights))
    for end in ends:
        assert end.time_of_flight_ps.low == pytest.approx(end.fibre_mm.low * 9.793, rel=0.03)


def test_clusters_of_axles_are_counted() -> None:
    """Five coaches: six clusters, and by then surely."""
    counts = [train.count for _, train in told(plain_run(40.0)) if train.count is not None]
    assert (6, True) == (counts[-1].clusters, counts[-1].confident)


def test_a_fibre_without_trains_tells_none() -> None:
    """Nor signals, nor troubles; so do cars on a road beside the line."""
    for cars in ((), (Car(300, 25.0), Car(1_500, -20.0))):
        found = frames(seen(world(cars=cars), 40))
        assert len(found) == 34
        assert all(frame.trains == () and frame.troubles == () and frame.heard == () for _, frame in found)


def test_a_standing_train_is_not_told_and_not_gone() -> None:
    """It is reported lost when it falls silent."""
    train = coaches(5, 200, 40.0)
    stopping = type(train)(
        train.vehicles, type(train.course)(200, ((3.5, 0.0), (4.0, 40.0), (14.0, 40.0), (24.0, 0.0))), True, 2.5
    )
    found = frames(seen(world(stopping), 70))
    lost = [(shot.second, frame.lost) for shot, frame in found if frame.lost]
    assert lost[-1][0] > 20
    assert found[-1][1].trains == ()


@pytest.mark.thorough
def test_two_trains_keep_their_order() -> None:
    """One behind the other: two tracks, nearest to the coupler first."""
    found = frames(seen(world(coaches(3, 300, 25.0), coaches(3, 900, 25.0)), 50))
    both = [frame.trains for _, frame in found if len(frame.trains) == 2]
    assert len(both) > 15
    assert 1 == len({tuple(train.track for train in trains) for trains in both})
    for low, high in both:
        assert low.high is not None
        assert high.low is not None
        assert low.high.path_mm.high < high.low.path_mm.low


@pytest.mark.thorough(ordinary=1)
@pytest.mark.parametrize(
    ("factor", "by", "effect", "edges"),
    [
        (4.0, "coupling", Effect.RAISES, [Edge.RISE, Edge.FALL]),
        (4.0, "material", Effect.RAISES, [Edge.RISE, Edge.FALL]),
        (0.25, "coupling", Effect.LOWERS, [Edge.FALL, Edge.RISE]),
        (0.25, "material", Effect.LOWERS, [Edge.FALL, Edge.RISE]),
    ],
)
def test_sections_give_position_signals(factor: float, by: str, effect: Effect, edges: list[Edge]) -> None:
    """One section, two edges at the front: entering and leaving (FWG-1 to FWG-3)."""
    config = CONFIG.model_copy(update={"section_places": (WAVE[0].model_copy(update={"effect": effect.value}),)})
    section = Section(900, 960, factor, by="material" if by == "material" else "coupling")
    found = told(seen(world(coaches(5, 300, 30.0), config=config, sections=(section,)), 60))
    signals = [signal for _, train in found for signal in train.signals if signal.leading]
    assert [(effect, edge) for edge in edges] == [(signal.effect, signal.edge) for signal in signals]
    assert [True, False] == [signal.entering for signal in signals]
    assert ["S1", "S1"] == [signal.section for signal in signals]
    assert 900_000 - 40_000 < signals[0].fibre_mm.high
    length = signals[1].length_mm
    assert length is not None
    assert length.low <= 60_000 <= length.high


@pytest.mark.thorough
def test_signals_come_whatever_the_time_of_flight_says() -> None:
    """A drift of 3 percent moves Se by 30 m and more, and no signal in time: the machine's comparison gives F."""
    config = CONFIG.model_copy(update={"section_places": WAVE})
    scene = {"config": config, "sections": (Section(900, 960, 4.0),)}
    times, places = [], []
    for ppm in (0.0, 50_000.0):
        drifting = world(coaches(5, 300, 30.0), **scene, drift=lambda _, ppm=ppm: Drift(index_ppm=ppm))  # type: ignore[arg-type]
        signals = [
            one for _, train in told(seen(drifting, 56)) for one in train.signals if one.leading and one.entering
        ]
        assert 1 == len(signals)
        times.append(signals[0].time_ms)
        places.append((signals[0].fibre_mm.low + signals[0].fibre_mm.high) / 2)
    assert abs(times[1] - times[0]) <= 700
    assert places[1] - places[0] > 25_000


@cache
def point_run(drift_ppm: float) -> Outcomes:
    """Past two reflecting points."""
    points = (PointPlace(id="P1", fibre_mm=800_000), PointPlace(id="P2", fibre_mm=1_200_000))
    inter = Interrogator(fibre_mm=2_000_000, pulse_ns=100)
    config = FibreConfig(interrogator=inter, detection=Detection(floor_s=3), point_places=points)
    scene = world(
        coaches(4, 300, 40.0), config=config, points_m=(800, 1_200), drift=lambda _: Drift(index_ppm=drift_ppm)
    )
    return tuple(seen(scene, 56))


@pytest.mark.thorough(ordinary=1)
@pytest.mark.parametrize("drift_ppm", [0.0, 30_000.0])
def test_coincidence_with_reflecting_points_needs_no_index(drift_ppm: float) -> None:
    """The front is at the point when it is told to be, drift or not (FWG-5)."""
    at = [
        (point, shot.trains[0].high_m)
        for shot, train in told(point_run(drift_ppm))
        if train.high is not None
        for point in train.high.points
    ]
    assert {"P1", "P2"} == {point for point, _ in at}
    for point, front_m in at:
        assert abs(front_m - {"P1": 800, "P2": 1_200}[point]) < 60


def test_a_point_that_is_missing_is_told() -> None:
    """The map has one, the light has none."""
    points = (PointPlace(id="P1", fibre_mm=800_000),)
    inter = Interrogator(fibre_mm=2_000_000, pulse_ns=100)
    config = FibreConfig(interrogator=inter, detection=Detection(floor_s=3), point_places=points)
    _, frame = frames(seen(world(config=config), 8))[-1]
    assert (Trouble.POINT_MISSING,) == frame.troubles
    assert ("P1",) == frame.missing_points


def test_an_end_without_absorber_is_told() -> None:
    """Its reflection stands out of the scatter."""
    inter = Interrogator(fibre_mm=2_000_000, pulse_ns=100)
    config = FibreConfig(interrogator=inter, detection=Detection(floor_s=3))
    troubles = {
        absorber: frames(seen(world(config=config, absorber=absorber), 8))[-1][1].troubles for absorber in (True, False)
    }
    assert {True: (), False: (Trouble.END_REFLECTS,)} == troubles


def test_emitters_are_heard() -> None:
    """Each with its own pattern at its place; the same pattern elsewhere is foreign (FVA-8)."""
    bits = "1100101011110001"
    emission = Emission(emitters=(Emitter(id="E1", fibre_mm=600_000, bits=bits),))
    config = CONFIG.model_copy(update={"emission": emission})
    soundings = (Sounding(bits, 600, 5.0), Sounding(bits, 1_400, 10.02))
    found = [one for _, frame in frames(seen(world(config=config, soundings=soundings), 32)) for one in frame.heard]
    assert [("E1", bits), (None, bits)] == [(one.emitter, one.bits) for one in found]


FAULTS: dict[str, object] = {
    "missing": Reason.MISSING,
    "duplicate": Reason.DUPLICATE,
    "late": Reason.STALE,
    "frozen": Refusal.FROZEN,
    "not finite": Reason.NOT_FINITE,
    "wrong shape": Refusal.WRONG_SHAPE,
    "wrong type": Reason.WRONG_TYPE,
    "short": Refusal.WRONG_SHAPE,
    "dark": Refusal.DARK,
    "silent": Refusal.SILENT,
    "shaken": Refusal.DISTURBED,
}


@pytest.mark.thorough(ordinary=1)
@pytest.mark.parametrize("kind", list(FAULTS))
def test_faults_are_refused_and_end_what_was_followed(kind: str) -> None:
    """With their reason; trains have to be confirmed anew, under new numbers."""
    outcomes = seen(world(coaches(5, 400, 40.0)), 28, faults=[Fault(kind, "", 22, 23)])
    before, during, after = outcomes[21][1], outcomes[22][1], outcomes[23][1]
    assert isinstance(before, FibreFrame)
    assert 1 == len(before.trains)
    assert isinstance(during, NoFibre)
    assert FAULTS[kind] is during.reason
    assert not isinstance(after, FibreFrame) or after.trains == ()


def test_missing_frames_between_blocks_are_noticed() -> None:
    """A number that is skipped without a word."""
    outcomes = seen(world(), 12)
    front = FrontEnd(CONFIG, 1_000)
    delivered = [shot.block for shot, _ in outcomes if shot.block is not None and shot.block.sequence != 9]
    made = read_all(delivered, front)
    assert isinstance(made[9], NoFibre)
    assert Refusal.GAP is made[9].reason
    assert isinstance(made[10], FibreFrame)


EARTHQUAKE = Interrogator(fibre_mm=500_511, pulse_hz=100, channel_mm=1_000, gauge_mm=1_000, pulse_ns=5)


@pytest.mark.parametrize(
    "detection",
    [Detection(), Detection(disturbed_percent=100), Detection(disturbed_percent=100, threshold_cdb=500, floor_s=5)],
    ids=["as it is", "without the rule for the whole fibre", "and twice as sensitive"],
)
@pytest.mark.parametrize("band", [(4, 40), (10, 45)], ids=["4 to 40 Hz", "10 to 45 Hz"])
def test_a_recorded_earthquake_is_no_train(detection: Detection, band: tuple[int, int]) -> None:
    """No train, no section, no axle: its waves cross the fibre at km/s, all at once."""
    recording = read_array(data_file("das_negative/daspy_example_int16.npz"), channels_first=True)
    low, high = band
    config = FibreConfig(
        interrogator=EARTHQUAKE,
        band=Band(window_frames=25, windows_per_block=2, low_hz=low, high_hz=high),
        detection=detection,
    )
    outcomes = read_all(list(blocks(recording, config)), FrontEnd(config, 1_000))
    assert 100 == len(outcomes)
    reasons = {outcome.reason for outcome in outcomes if isinstance(outcome, NoFibre)}
    assert reasons <= {Refusal.LEARNING, Refusal.DISTURBED}
    read = [outcome for outcome in outcomes if isinstance(outcome, FibreFrame)]
    assert len(read) > 50
    assert all(frame.trains == () and frame.heard == () for frame in read)


def test_the_same_recording_with_a_train_in_it_tells_the_train() -> None:
    """The rules that keep the earthquake out let a train in: one is added to the recorded noise."""
    recording = read_array(data_file("das_negative/daspy_example_int16.npz"), channels_first=True)
    config = FibreConfig(
        interrogator=EARTHQUAKE, band=Band(window_frames=25, windows_per_block=2, low_hz=4, high_hz=40)
    )
    quiet = recording.frames[:1_000].copy()
    frames_ = np.concatenate([quiet, quiet])
    noise = np.random.default_rng(0).standard_normal(frames_.shape).astype(np.float32)
    for number in range(1_000, len(frames_)):
        front = round(50 + 15 * (number - 1_000) / 100)
        frames_[number, max(front - 50, 0) : front] += 5 * quiet.std() * noise[number, max(front - 50, 0) : front]
    made = type(recording)(frames_, recording.frame_hz, recording.channel_mm)
    outcomes = read_all(list(blocks(made, config)), FrontEnd(config, 1_000))
    trains = [train for outcome in outcomes if isinstance(outcome, FibreFrame) for train in outcome.trains]
    assert len(trains) > 10
    assert all(train.speed_mm_s.low <= 15_000 <= train.speed_mm_s.high for train in trains)
