"""Runs of shaken fibre and their ends."""

from __future__ import annotations

import numpy as np

from safeloc.sensing.fibre.figures import FibreConfig, Interrogator
from safeloc.sensing.fibre.shaken_stretches import Stretch, stretches

CONFIG = FibreConfig(interrogator=Interrogator(fibre_mm=3_000_000))
CHANNELS = CONFIG.interrogator.channels


def found(*spans: tuple[int, int], level: float = 300.0) -> list[Stretch]:
    """Runs where channels of these spans, both ends included, are shaken."""
    ratio = np.ones(CHANNELS, dtype=np.float32)
    for first, last in spans:
        ratio[first : last + 1] = level
    return stretches(ratio, ratio > 8, CONFIG)


def test_a_still_fibre_has_no_runs() -> None:
    """Nor has one with single shaken channels, or two that share a dark place."""
    assert [] == found()
    assert [] == found((20, 20), (40, 41), (90, 90))


def test_gaps_shorter_than_the_rule_are_bridged() -> None:
    """80 m: eight still channels belong to the train, more part it."""
    assert [(10, 39)] == [(stretch.first, stretch.last) for stretch in found((10, 20), (29, 39))]
    assert [(10, 20), (31, 39)] == [(stretch.first, stretch.last) for stretch in found((10, 20), (31, 39))]


def test_ends_lie_within_the_outermost_channels_reach() -> None:
    """The louder the train, the farther inside its last axle stands."""
    faint, loud = found((100, 120), level=10)[0], found((100, 120), level=10_000)[0]
    assert 1_000_000 < faint.low_mm < loud.low_mm < 1_040_000
    assert 1_170_000 < loud.high_mm < faint.high_mm < 1_215_106


def test_a_run_at_the_fibres_end_is_cut() -> None:
    """Its train may go on beyond."""
    low, high = found((0, 10), (CHANNELS - 5, CHANNELS - 1))
    assert (True, False) == (low.cut_low, low.cut_high)
    assert (False, True) == (high.cut_low, high.cut_high)
