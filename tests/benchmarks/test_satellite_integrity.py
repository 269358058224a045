"""Levels before and after: what each adds, and what becomes of it on recorded signals."""

from __future__ import annotations

from dataclasses import replace

import pytest

from benchmarks.satellite_integrity import HEADS, ThresholdAlone, Trial, cells
from benchmarks.satellite_recorded import geodetic, truth
from safeloc.models.satellite.chain import EpochChain
from tests.data_sources import data_file

pytest.importorskip("pyproj")


def test_levels_are_wider_by_the_added_error() -> None:
    """The first half minute: 11.2 m of each signal before, 16.2 m after, and levels by as much; nothing is missed either way."""
    whole = geodetic(data_file("gnss_septentrio/rover.obs").parents[1])
    recording = replace(whole, epochs=whole.epochs[:30])
    known = truth(recording)
    before, after = (Trial(recording, known, "as recorded", (), kind) for kind in (ThresholdAlone, EpochChain))
    narrow, wide = before.run(), after.run()
    assert (11_200, 16_200) == (before.added_mm, after.added_mm)
    ratios = [b / a for a, b in zip(narrow.levels_mm, wide.levels_mm, strict=True)]
    assert 1.42 < min(ratios) <= max(ratios) < 16.2 / 11.2 + 0.01
    assert 0 == narrow.longest_unseen == wide.longest_unseen
    assert len(HEADS) == len(cells(after, wide))
