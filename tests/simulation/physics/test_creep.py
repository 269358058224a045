"""The creep of a wheel: worked figures of the curve, and slides."""

from __future__ import annotations

import math

import numpy as np
import pytest

from safeloc.simulation.physics.creep import creep_of


def settled(wanted: float, adhesion: float, *, sliding: float = 0.2) -> float:
    """The creep after ten seconds of one force."""
    force, rail = np.full((100, 1), wanted), np.full((100, 1), adhesion)
    return float(creep_of(force, rail, np.array([0.01]), np.array([sliding]), 100)[-1, 0])


@pytest.mark.parametrize(
    ("wanted", "creep"),
    [(0.0, 0.0), (0.165, 0.01 * (1 - 0.5 ** (1 / 3))), (0.33, 0.01), (-0.165, -0.01 * (1 - 0.5 ** (1 / 3)))],
)
def test_a_wheel_that_holds_creeps_by_the_force(wanted: float, creep: float) -> None:
    """Johnson and Vermeulen: half of the adhesion costs a fifth of the creep at the limit."""
    assert creep == pytest.approx(settled(wanted, 0.33), abs=1e-9)


def test_a_small_force_costs_the_same_creep_on_any_rail() -> None:
    """The curve begins alike: it is stiffness, not adhesion, that counts there."""
    assert settled(0.001, 0.33) == pytest.approx(settled(0.001, 0.1), rel=0.02)


@pytest.mark.parametrize("sliding", [0.05, 0.2, 1.0])
def test_a_wheel_that_is_to_transmit_more_slips_or_slides(sliding: float) -> None:
    """To what its protection permits; a wheel that locks stands still."""
    assert -sliding == pytest.approx(settled(-0.1, 0.05, sliding=sliding))
    assert sliding == pytest.approx(settled(0.1, 0.05, sliding=sliding))


def test_a_slide_begins_and_ends_within_a_second() -> None:
    """A third of a second is its time constant, either way."""
    rail = np.array([[0.3]] * 10 + [[0.05]] * 30 + [[0.3]] * 30)
    found = -creep_of(np.full((70, 1), -0.1), rail, np.array([0.01]), np.array([0.2]), 100)[:, 0]
    assert found[9] < 0.002
    assert 0.2 * (1 - math.exp(-1)) == pytest.approx(found[12], abs=2e-3)
    assert found[39] > 0.199
    assert found[69] < 0.002
