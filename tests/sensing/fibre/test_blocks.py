"""Blocks at the border: what cannot be used is refused with its reason."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from safeloc.runtime.border import Reason
from safeloc.sensing.fibre.blocks import Content, FibreBlock, NoFibre, Order, Refusal, admitted, unusable
from safeloc.sensing.fibre.figures import FibreConfig, Interrogator

CONFIG = FibreConfig(interrogator=Interrogator(fibre_mm=500_000))
SHAPE = (CONFIG.band.block_frames, CONFIG.interrogator.channels)
LIGHT = CONFIG.interrogator.light_channels
GOOD = FibreBlock(np.zeros(SHAPE, np.float32), np.ones(LIGHT, np.float32), 500, 0)


def reason(outcome: object) -> object:
    """Why it is refused; None when it is not."""
    return outcome.reason if isinstance(outcome, NoFibre) else None


@pytest.mark.parametrize(
    ("change", "expected"),
    [
        ({"phase_rate": None}, Reason.WRONG_TYPE),
        ({"phase_rate": [[0.0]]}, Reason.WRONG_TYPE),
        ({"phase_rate": np.zeros(SHAPE, np.int16)}, Reason.WRONG_TYPE),
        ({"phase_rate": np.zeros(SHAPE, np.complex64)}, Reason.WRONG_TYPE),
        ({"phase_rate": np.zeros((SHAPE[0] - 1, SHAPE[1]), np.float32)}, Refusal.WRONG_SHAPE),
        ({"phase_rate": np.zeros((SHAPE[0], SHAPE[1] + 1), np.float32)}, Refusal.WRONG_SHAPE),
        ({"phase_rate": np.zeros(SHAPE[0], np.float32)}, Refusal.WRONG_SHAPE),
        ({"intensity": [1.0]}, Reason.WRONG_TYPE),
        ({"intensity": np.ones(3, np.float32)}, Refusal.WRONG_INTENSITY),
        ({"intensity": np.full(LIGHT, np.nan, np.float32)}, Refusal.WRONG_INTENSITY),
        ({"intensity": np.full(LIGHT, -1, np.float32)}, Refusal.WRONG_INTENSITY),
    ],
)
def test_what_is_no_block_is_refused(change: dict[str, Any], expected: object) -> None:
    """Nothing is cut, filled or converted from another kind."""
    assert expected is reason(admitted(CONFIG, replace(GOOD, **change)))


def test_a_block_is_taken_as_it_is() -> None:
    """64-bit floats too; intensity may be absent."""
    taken = admitted(CONFIG, replace(GOOD, phase_rate=np.ones(SHAPE), intensity=None))
    assert isinstance(taken, Content)
    assert (np.float32, SHAPE, None) == (taken.phase_rate.dtype, taken.phase_rate.shape, taken.intensity)


def test_energies_tell_of_strange_numbers_and_silence() -> None:
    """One channel that is not finite is enough; a fifth may be silent."""
    energy = np.ones((10, SHAPE[1]), np.float32)
    assert unusable(CONFIG, energy) is None
    energy[:, : SHAPE[1] // 10] = 0
    assert unusable(CONFIG, energy) is None
    energy[3, 5] = np.inf
    assert Reason.NOT_FINITE is reason(unusable(CONFIG, energy))
    energy[:] = 0
    assert Refusal.SILENT is reason(unusable(CONFIG, energy))


def later(number: int, *, ms: int = 0) -> FibreBlock:
    """The block of this number; `ms` off its time."""
    return replace(GOOD, time_ms=500 * (number + 1) + ms, sequence=number)


def test_blocks_come_in_time_and_order() -> None:
    """The border's own judgement."""
    order = Order(CONFIG, 1_000)
    assert order.judge(later(1), 1_000) is None
    assert Reason.DUPLICATE is reason(order.judge(later(1), 1_000))
    assert Reason.OUT_OF_ORDER is reason(order.judge(later(0), 1_000))
    assert Reason.FUTURE is reason(order.judge(later(5), 1_000))
    assert Reason.STALE is reason(order.judge(later(2), 9_000))


def test_blocks_join() -> None:
    """A missing number or a jump in time is a gap; after it all goes on."""
    order = Order(CONFIG, 1_000)
    assert order.joins(later(0)) is None
    assert order.joins(later(1, ms=2)) is None
    assert Refusal.GAP is reason(order.joins(later(3)))
    assert order.joins(later(4)) is None
    assert Refusal.GAP is reason(order.joins(later(5, ms=20)))
    order.broken()
    assert order.joins(later(9)) is None


def test_a_frozen_block_is_noticed() -> None:
    """The same energies twice."""
    order, energy = Order(CONFIG, 1_000), np.ones((10, 3), np.float32)
    assert order.changes(energy) is None
    assert Refusal.FROZEN is reason(order.changes(energy))
    assert order.changes(energy * 2) is None
