"""Coupling along a fibre: which axles are received, and where the train then seems to begin and end."""

from __future__ import annotations

import numpy as np
import pytest

from safeloc.simulation.physics.fibre_coupling import (
    COUPLING,
    FADING,
    FIGURES,
    LEVEL,
    LOOSE,
    LOOSE_SHARE,
    LOSS,
    Coupled,
    coupled,
)
from safeloc.simulation.vehicle_seed import VehicleSeed

FRONT = np.array([100_000, 60_000])
RNG = np.random.default_rng(3)


def fibres(vehicles: int, length_mm: int, **changed: float) -> list[Coupled]:
    """Fibres of vehicles from place 0 on."""
    figures = {name: np.full(vehicles, changed.get(name, one.default)) for name, one in FIGURES.items()}
    found = coupled(figures, [VehicleSeed(2, (number,)) for number in range(vehicles)], 0, length_mm)
    return [found[number] for number in sorted(found)]


def test_without_a_level_nothing_is_drawn() -> None:
    """By default the fibre finds every axle."""
    assert [] == fibres(3, 100_000)


def test_weak_axles_are_missed_and_move_the_front() -> None:
    """Of 5 axles at 10 m intervals the first two and the last one stand where the fibre receives nothing."""
    levels = np.array([9.0] * 6 + [-9, 9, 9, -9, -9])
    found = Coupled(levels, 0, 0).received(FRONT, 40_000, 5, RNG)
    assert [2, 4] == found.axles.tolist()
    assert [20_000, 10_000] == found.first_mm.tolist()
    assert [30_000, 40_000] == found.last_mm.tolist()
    nothing = Coupled(np.array([-1.0]), 0, 0).received(FRONT, 40_000, 5, RNG)
    assert [0, 0] == nothing.axles.tolist() == nothing.first_mm.tolist() == nothing.last_mm.tolist()


def test_light_is_lost_along_the_stretch() -> None:
    """3 dB/km there and back: half a piece from the beginning first, and 10 m each."""
    (one,) = fibres(1, 2_000_000, **{LEVEL: 9, LOSS: 3, COUPLING: 0})
    assert [9 - 3 * 0.005, 9 - 3 * 0.015] == pytest.approx(one.levels_db[:2].tolist())
    assert 9 - 3 * 1.995 == pytest.approx(float(one.levels_db[-1]))


def test_coupling_and_loose_cable_are_as_declared() -> None:
    """Deviation and correlation of the level along the fibre, and the share that lies loose, in a stretch of 100 km."""
    (even,) = fibres(1, 100_000_000, **{LEVEL: 50, LOSS: 0})
    off = even.levels_db - 50
    assert 2 == pytest.approx(float(off.std()), rel=0.1)
    assert np.exp(-0.1) == pytest.approx(float(np.mean(off[1:] * off[:-1])) / 4, abs=0.15)
    (loose,) = fibres(1, 100_000_000, **{LEVEL: 50, LOSS: 0, COUPLING: 0, LOOSE: 20, LOOSE_SHARE: 0.3})
    assert {30, 50} == set(loose.levels_db.tolist())
    assert 0.3 == pytest.approx(float((loose.levels_db == 30).mean()), abs=0.06)
    assert {50} == set(fibres(1, 1_000_000, **{LEVEL: 50, LOSS: 0, COUPLING: 0, LOOSE: 20})[0].levels_db.tolist())


def test_fading_misses_axles_as_often_as_declared() -> None:
    """A level of one deviation of the fading is undercut once in 6.3 times."""
    found = Coupled(np.array([2.0]), 0, 2.0).received(np.zeros(2_000, dtype=np.int64), 40_000, 20, RNG)
    assert 0.8413 == pytest.approx(float(found.axles.mean()) / 20, abs=0.01)


def test_a_vehicle_has_a_fibre_of_its_own() -> None:
    """The same alone and among others."""
    three, one = fibres(3, 500_000, **{LEVEL: 9, FADING: 1}), fibres(1, 500_000, **{LEVEL: 9, FADING: 1})
    assert np.array_equal(three[0].levels_db, one[0].levels_db)
    assert not np.array_equal(three[0].levels_db, three[1].levels_db)
