"""Trains followed by overlap: order is kept, joining and parting are told, what is no train is not one."""

from __future__ import annotations

import pytest

from safeloc.sensing.fibre.figures import FibreConfig, Interrogator
from safeloc.sensing.fibre.shaken_stretches import Stretch
from safeloc.sensing.fibre.tracks import Follower, Track

CONFIG = FibreConfig(interrogator=Interrogator(fibre_mm=10_000_000))
WINDOW_MS = 50.0


def run(low_m: float, high_m: float, *, cut_low: bool = False) -> Stretch:
    """Shaken fibre between two places."""
    return Stretch(int(low_m // 10), int(high_m // 10), low_m * 1_000, high_m * 1_000, cut_low, False)


def followed(follower: Follower, places: list[list[tuple[float, float]]], first: int = 0) -> list[Track]:
    """Windows of runs, one list each; judged after every window. Tracks that ended."""
    ended: list[Track] = []
    for number, runs in enumerate(places):
        ended += follower.follow((first + number) * WINDOW_MS, [run(*one) for one in runs])
        for track in follower.tracks:
            fit = track.fit()
            if fit is not None:
                track.judge(fit, CONFIG)
    return ended


def moving(start_m: float, speed_m_s: float, windows: int = 120, length_m: float = 200) -> list[tuple[float, float]]:
    """A train's places, window by window."""
    ends = [start_m + speed_m_s * number * WINDOW_MS / 1_000 for number in range(windows)]
    return [(end - length_m, end) for end in ends]


@pytest.mark.parametrize("speed", [-90, -30, 12, 30, 90])
def test_a_train_keeps_its_track(speed: float) -> None:
    """One track, confirmed, with speed and place."""
    follower = Follower(CONFIG)
    assert [] == followed(follower, [[one] for one in moving(5_000, speed)])
    (track,) = follower.tracks
    fit = track.fit()
    assert fit is not None
    assert track.confirmed
    assert speed * 1_000 == pytest.approx(fit.speed_mm_s)
    assert 5_000_000 + speed * 1_000 * 119 * 0.05 == pytest.approx(fit.high_mm)


def test_trains_that_pass_in_order_stay_apart() -> None:
    """One behind the other, both ways at once."""
    follower = Follower(CONFIG)
    followed(follower, [list(pair) for pair in zip(moving(2_000, 30), moving(6_000, -30), strict=True)])
    assert [1, 2] == [track.number for track in follower.tracks]


def test_trains_that_join_become_a_new_track_that_names_both() -> None:
    """Which is which is not guessed when they part again."""
    follower = Follower(CONFIG)
    apart = [list(pair) for pair in zip(moving(2_000, 30), moving(2_400, 30), strict=True)]
    followed(follower, apart)
    low, high = apart[-1]
    joined = (low[0], high[1])
    ended = followed(follower, [[joined]], 120)
    assert {1, 2} == {track.number for track in ended}
    assert [(1, 2)] == [track.origin for track in follower.tracks]
    (new,) = follower.tracks
    assert not new.confirmed


def test_a_train_that_parts_becomes_two_new_tracks() -> None:
    """Both name where they come from."""
    follower = Follower(CONFIG)
    whole = moving(2_000, 30, length_m=600)
    followed(follower, [[one] for one in whole])
    low, high = whole[-1]
    followed(follower, [[(low, low + 200), (high - 200, high)]], 120)
    assert [(1,), (1,)] == [track.origin for track in follower.tracks]
    assert not any(track.confirmed for track in follower.tracks)


def test_noise_that_touches_a_train_does_not_end_it() -> None:
    """What is no train yet is taken in."""
    follower = Follower(CONFIG)
    places = moving(2_000, 30)
    followed(follower, [[one] for one in places[:100]])
    followed(follower, [[one, (3_000, 3_040)] for one in places[100:110]], 100)
    low, _ = places[110]
    followed(follower, [[(low, 3_040)]], 110)
    assert [1] == [track.number for track in follower.tracks]


def test_what_stands_still_is_no_train() -> None:
    """A machine beside the track hums."""
    follower = Follower(CONFIG)
    followed(follower, [[one] for one in moving(2_000, 0, windows=400)])
    assert [False] == [track.confirmed for track in follower.tracks]


def test_waves_are_no_trains() -> None:
    """Faster than trains: overlapping as it is, it is never confirmed."""
    follower = Follower(CONFIG)
    followed(follower, [[one] for one in moving(2_000, 150, windows=100, length_m=400)])
    assert [False] == [track.confirmed for track in follower.tracks]


def test_ends_that_go_their_own_ways_are_no_train() -> None:
    """Shaken ground that widens."""
    follower = Follower(CONFIG)
    widening = [(5_000 - number, 5_200 + 2 * number) for number in range(100)]
    followed(follower, [[one] for one in widening])
    assert [False] == [track.confirmed for track in follower.tracks]


def test_a_train_as_long_as_no_train_is_none_any_more() -> None:
    """It loses its confirmation."""
    follower = Follower(CONFIG)
    places = moving(2_000, 30)
    followed(follower, [[one] for one in places])
    assert follower.tracks[0].confirmed
    followed(follower, [[(low, low + 1_700)] for low, _ in places[-100:]], 120)
    assert [False] == [track.confirmed for track in follower.tracks]


def test_an_end_beyond_the_fibre_says_nothing_of_speed() -> None:
    """A train that enters: only its front moves."""
    follower = Follower(CONFIG)
    for number in range(100):
        follower.follow(number * WINDOW_MS, [run(0, 100 + 1.5 * number, cut_low=True)])
    fit = follower.tracks[0].fit()
    assert fit is not None
    assert 30_000 == pytest.approx(fit.speed_mm_s)


def test_single_windows_far_off_do_not_turn_the_course() -> None:
    """Their distance is told."""
    follower = Follower(CONFIG)
    places = moving(2_000, 30)
    places[-3] = (places[-3][0], places[-3][1] + 60)
    followed(follower, [[one] for one in places])
    fit = follower.tracks[0].fit()
    assert fit is not None
    assert 30_000 == pytest.approx(fit.speed_mm_s)
    assert 60_000 == pytest.approx(fit.off_high_mm)


def test_dropped_tracks_are_returned() -> None:
    """And none is left."""
    follower = Follower(CONFIG)
    followed(follower, [[one] for one in moving(2_000, 30)])
    assert [1] == [track.number for track in follower.drop()]
    assert [] == follower.tracks
