"""Position signals: the amplitude rises or falls against what it was, and a return to normal is no second section."""

from __future__ import annotations

import numpy as np
import pytest

from safeloc.sensing.fibre.figures import FibreConfig, Interrogator, Sections
from safeloc.sensing.fibre.sections import Change, Edge, Effect, Watcher, amplitude

CONFIG = FibreConfig(interrogator=Interrogator(fibre_mm=3_000_000))


def watched(levels: list[tuple[float, float]], watcher: Watcher | None = None) -> list[tuple[float, Change]]:
    """Changes seen over (place in m, level in cdB)."""
    watcher = watcher or Watcher(CONFIG)
    seen = [(place, watcher.follow(place * 1_000, level)) for place, level in levels]
    return [(place, change) for place, change in seen if change is not None]


def course(sections: list[tuple[int, int, float]], low: int = 0, high: int = 1_500) -> list[tuple[float, float]]:
    """Levels every 2 m: 2000 cdB, changed by so much in each section (from, to, change)."""
    places = range(low, high, 2) if low < high else range(low, high, -2)
    return [(place, 2_000 + sum(change for a, b, change in sections if a <= place < b)) for place in places]


@pytest.mark.parametrize(
    ("change", "effect", "edges"),
    [(1_200, Effect.RAISES, (Edge.RISE, Edge.FALL)), (-1_200, Effect.LOWERS, (Edge.FALL, Edge.RISE))],
)
def test_a_section_gives_two_edges(change: float, effect: Effect, edges: tuple[Edge, Edge]) -> None:
    """Entering and leaving, with the length it was run through (Figs. 2 to 4 and 7 to 9)."""
    (_, enter), (_, leave) = watched(course([(600, 660, change)]))
    assert (effect, edges[0], True, None) == (enter.effect, enter.edge, enter.entering, enter.length_mm)
    assert (effect, edges[1], False) == (leave.effect, leave.edge, leave.entering)
    assert 60_000 == leave.length_mm


def test_sections_raise_and_lower_in_turn() -> None:
    """Both kinds on one fibre; six edges for three sections."""
    changes = watched(course([(400, 460, 1_200), (800, 860, -1_200), (1_200, 1_300, 1_200)]))
    assert [Effect.RAISES, Effect.RAISES, Effect.LOWERS, Effect.LOWERS, Effect.RAISES, Effect.RAISES] == [
        change.effect for _, change in changes
    ]


def test_a_return_to_normal_is_no_section_even_when_it_overshoots_a_little() -> None:
    """Leaving a raising section to below normal, within the hysteresis."""
    changes = watched(course([(600, 660, 1_200), (660, 700, -600)]))
    assert [True, False] == [change.entering for _, change in changes]


def test_a_short_change_is_no_section() -> None:
    """20 m of better coupling."""
    assert [] == watched(course([(600, 620, 1_200)]))


def test_wavering_about_the_threshold_is_one_section() -> None:
    """Between return and change nothing happens."""
    wavering = [(place, level + (250 if place % 8 < 4 else 0)) for place, level in course([(600, 700, 800)])]
    assert [True, False] == [change.entering for _, change in watched(wavering)]


def test_uneven_coupling_is_no_section() -> None:
    """Below the threshold, however long."""
    rng = np.random.default_rng(0)
    assert [] == watched([(place, level + rng.normal(0, 120)) for place, level in course([])])


def test_nothing_is_told_before_normal_is_known() -> None:
    """A train that appears in a section: what is normal takes 100 m."""
    assert [] == watched(course([(0, 60, 1_200)], high=90))


def test_a_train_that_turns_back_inside_has_run_through_no_length() -> None:
    """It leaves the way it came."""
    there, back = course([(600, 700, 1_200)], high=650), course([(600, 700, 1_200)], low=650, high=300)
    (_, enter), (_, leave) = watched(there + back)
    assert (True, False) == (enter.entering, leave.entering)
    assert leave.length_mm is None


def test_an_amplitude_that_stays_is_the_new_normal() -> None:
    """The next section is told against it."""
    changes = watched(course([(400, 3_000, 1_200), (1_600, 1_660, 1_200)], high=2_000))
    assert [True, False, True, False] == [change.entering for _, change in changes]
    assert changes[1][1].length_mm is None
    assert 60_000 == changes[3][1].length_mm


def test_normal_follows_slow_changes() -> None:
    """A train that gets faster gets louder."""
    assert [] == watched([(place, level + place) for place, level in course([])])


def test_a_train_that_stands_teaches_nothing() -> None:
    """However long: memory does not grow."""
    watcher = Watcher(CONFIG)
    assert [] == watched([(100.0, 2_000.0)] * 10_000, watcher)
    assert len(watcher._normal) == 1


def test_amplitude_is_taken_inside_the_train() -> None:
    """From 10 to 50 m behind its end; louder channels before and behind do not matter."""
    energy = np.ones(CONFIG.interrogator.channels, dtype=np.float32)
    energy[96:100] = 100
    assert 2_000 == pytest.approx(amplitude(energy, 800_000, 1_008_000, 1, CONFIG, None))
    assert 0 == pytest.approx(amplitude(energy, 800_000, 2_000_000, 1, CONFIG, None))


def test_dark_channels_have_no_amplitude() -> None:
    """They are left out; with none left there is none."""
    energy = np.ones(CONFIG.interrogator.channels, dtype=np.float32)
    energy[97] = 1e9
    faded = np.zeros(len(energy), dtype=np.bool_)
    faded[97] = True
    assert 0 == pytest.approx(amplitude(energy, 800_000, 1_008_000, 1, CONFIG, faded))
    assert amplitude(energy, 800_000, 1_008_000, 1, CONFIG, ~np.zeros_like(faded)) is None


def test_a_steeper_threshold_sees_less() -> None:
    """The rule is a figure."""
    strict = Watcher(CONFIG.model_copy(update={"sections": Sections(change_cdb=1_500)}))
    assert [] == watched(course([(600, 660, 1_200)]), strict)


def test_normal_is_known_behind_a_long_section() -> None:
    """300 m of section, over which 250 m of normal are learnt: the amplitude behind it is told over what was before."""
    watcher, told = Watcher(CONFIG), list[float | None]()
    for place, level in course([(600, 900, 1_200)]):
        watcher.follow(place * 1_000, level)
        told.append(watcher.change_cdb)
    assert None not in told[100:]
    assert 0 == told[960 // 2]
