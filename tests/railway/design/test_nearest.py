"""The search for the nearest tolerance asks cheap questions first, tells them, and ends in time."""

from __future__ import annotations

import pytest

from safeloc.errors import InputError
from safeloc.models.layout_rules import LayoutConfig
from safeloc.models.layout_rules.marker_readers import MarkerReaders
from safeloc.railway.design import nearest
from safeloc.railway.design.designing import Task
from safeloc.railway.design.figures import Added
from safeloc.railway.design.nearest import Nearest, nearest_kept, with_tolerance
from safeloc.railway.map.toml_files import find_line
from tests.railway.map.made import straight

TASK = Task(straight(300_000), LayoutConfig())


def asked_of(monkeypatch: pytest.MonkeyPatch, low_mm: int, high_mm: int, wanted_mm: int) -> tuple[Nearest, list[int]]:
    """What is found where these tolerances alone are kept, and what was asked."""
    monkeypatch.setattr(nearest, "can_be_kept", lambda task, _: low_mm <= task.layout.tolerance_mm <= high_mm)
    asked: list[int] = []
    return nearest_kept(TASK, wanted_mm, 60, lambda one, _: asked.append(one)), asked


def test_the_greatest_is_asked_first(monkeypatch: pytest.MonkeyPatch) -> None:
    """Small tolerances, whose questions take long, are asked near the answer only."""
    found, asked = asked_of(monkeypatch, 77_206, 400_000, 6_000)
    assert (Nearest(77_206, searched=True), 500_000) == (found, asked[0])
    assert 77_206 / 2 < min(asked)


def test_none_greater_is_kept(monkeypatch: pytest.MonkeyPatch) -> None:
    """Then the next smaller one is told, and none where none is kept."""
    assert Nearest(20_000, searched=True) == asked_of(monkeypatch, 1, 20_000, 30_000)[0]
    assert Nearest(31_000, searched=True) == asked_of(monkeypatch, 31_000, 31_000, 30_000)[0]
    assert Nearest(None, searched=True) == asked_of(monkeypatch, 0, 0, 30_000)[0]


def test_it_ends_in_time(monkeypatch: pytest.MonkeyPatch) -> None:
    """With what was found until then; the answer says that the search did not come to its end."""
    clock = iter(range(100))
    monkeypatch.setattr(nearest, "can_be_kept", lambda task, _: task.layout.tolerance_mm >= 90_000)
    monkeypatch.setattr(nearest, "process_time", lambda: next(clock))
    found = nearest_kept(TASK, 6_000, 2)
    assert Nearest(262_000, searched=False) == found
    assert Nearest(None, searched=False) == nearest_kept(TASK, 6_000, -1)


def test_figures_that_do_not_go_together() -> None:
    """The error says why no tolerance of that size is asked about."""
    with pytest.raises(InputError, match="do not go with it: tolerance_mm 1000 is not above odometry_constant_mm 5000"):
        with_tolerance(LayoutConfig(), 1_000)


def test_markers_of_a_long_line() -> None:
    """Three markers on `valley`: 77.206 m is kept, and 77.205 m is not."""
    layout = LayoutConfig(markers=MarkerReaders(groups_are_markers=False))
    task = Task(find_line("valley"), layout, added=Added(markers=3))
    asked: dict[int, bool] = {}
    found = nearest_kept(task, 1_000, 60, asked.__setitem__)
    assert (77_206, True, False) == (found.kept_mm, asked[77_206], asked[77_205])
