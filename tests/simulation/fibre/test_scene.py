"""Runs: truth beside every block, seeds, faults."""

from __future__ import annotations

import numpy as np
import pytest

from safeloc.errors import InputError
from safeloc.sensing.fibre.blocks import FibreBlock
from safeloc.sensing.fibre.figures import FibreConfig, Interrogator
from safeloc.simulation.faults import Fault
from safeloc.simulation.fibre.cable import cable
from safeloc.simulation.fibre.emitters import Sounding
from safeloc.simulation.fibre.scene import Shot, World, shots
from safeloc.simulation.fibre.trains import COACH, steady

CONFIG = FibreConfig(interrogator=Interrogator(fibre_mm=600_000))


def run(seed: int = 0, faults: tuple[Fault, ...] = (), soundings: tuple[Sounding, ...] = ()) -> list[Shot]:
    """Four blocks, two coaches at 20 m/s."""
    laid = cable(CONFIG.interrogator, np.random.default_rng(seed))
    world = World(CONFIG, laid, (steady([COACH] * 2, 200.0, 20.0),), soundings=soundings)
    return list(shots(world, 4, np.random.default_rng(seed), faults=faults))


def rate(shot: Shot) -> np.ndarray[tuple[int, int], np.dtype[np.float32]]:
    """A delivered block's frames."""
    assert isinstance(shot.block, FibreBlock)
    assert isinstance(shot.block.phase_rate, np.ndarray)
    return shot.block.phase_rate


def test_truth_belongs_to_the_last_frame() -> None:
    """Half a second a block; 10 m each."""
    made = run()
    assert [500, 1_000, 1_500, 2_000] == [shot.delivered_ms for shot in made]
    assert [210, 220, 230, 240] == pytest.approx([shot.trains[0].high_m for shot in made])
    assert all(shot.trains[0].high_m - shot.trains[0].low_m == pytest.approx(52.8) for shot in made)
    assert [20.0] * 4 == [shot.trains[0].speed_m_s for shot in made]


def test_the_seed_makes_the_run() -> None:
    """The same twice, another else."""
    assert np.array_equal(rate(run()[2]), rate(run()[2]))
    assert not np.array_equal(rate(run()[2]), rate(run(1)[2]))


def test_the_train_is_where_the_fibre_is_shaken() -> None:
    """Frames by channels, loudest over the train."""
    made = rate(run()[1])
    assert (CONFIG.band.block_frames, CONFIG.interrogator.channels) == made.shape
    assert 14 <= int(np.argmax(np.diff(made, axis=0).std(axis=0))) <= 22


@pytest.mark.parametrize(
    "kind",
    ["missing", "late", "duplicate", "frozen", "not finite", "wrong shape", "short", "wrong type", "silent", "dark"],
)
def test_faults_happen_when_they_are_told_to(kind: str) -> None:
    """In the third block, and in no other."""
    plain, faulty = run(), run(faults=(Fault(kind, "", 2, 3),))
    for number in (0, 1, 3):
        assert np.array_equal(rate(plain[number]), rate(faulty[number]))
    same = (
        faulty[2].block is not None
        and faulty[2].block.sequence == 2
        and rate(faulty[2]).dtype == np.float32
        and np.array_equal(rate(faulty[2]), rate(plain[2]))
        and np.array_equal(np.asarray(faulty[2].block.intensity), np.asarray(plain[2].block.intensity))  # type: ignore[union-attr]
        and faulty[2].delivered_ms == plain[2].delivered_ms
    )
    assert not same


def test_an_emitter_sounds_bit_by_bit() -> None:
    """A tone of 240 Hz at its place, while a bit is 1."""
    made = np.concatenate([rate(shot) for shot in run(soundings=(Sounding("101", 500.0, 0.6),))])
    tone = np.exp(-2j * np.pi * 240 * np.arange(200) / 1_000)
    level = [abs(made[begin : begin + 200, 49] @ tone) for begin in (200, 600, 800, 1_000, 1_400)]
    assert [False, True, False, True, False] == [one > 5 for one in level]


def test_a_pattern_is_made_of_bits() -> None:
    """Or refused."""
    with pytest.raises(InputError, match="consists of 0 and 1"):
        Sounding("10x", 1.0, 0.0)
