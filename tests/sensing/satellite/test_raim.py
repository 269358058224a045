"""Side by side in one run: the map-bound selection, and residual-based exclusion as gnss_lib_py does it (extra `raim`).

Both see the same recorded GPS signals of a geodetic receiver, disturbed on purpose. The residual-based method knows no track
and no state before: it solves three dimensions and the clock from the satellites themselves, faulty ones included.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cache
from typing import Any

import pytest

from benchmarks.satellite_recorded import Recording, geodetic, told, truth
from safeloc.sensing.satellite.residuals import Residuals
from safeloc.simulation.faults import Fault
from safeloc.simulation.satellite.disturbing import disturb
from tests.data_sources import data_file
from tests.sensing.satellite.raim import excluded_by_raim, told_of_frame

FROM_S, TO_S, EPOCHS = 20, 50, 60
SQUARES_M2 = 5 * 11.0
"""Threshold for nine satellites, five degrees of freedom: chi-square 20.5 (1 in 1000) at 1.6 m is 53 m2."""


@dataclass(frozen=True)
class Rates:
    """Shares of the disturbed and of the healthy signals that were excluded."""

    disturbed: float
    healthy: float


@cache
def recording() -> Recording:
    """GPS alone, a minute."""
    whole = geodetic(data_file("gnss_septentrio/rover.obs").parents[1])
    epochs = [
        replace(epoch, satellites={name: one for name, one in epoch.satellites.items() if name.startswith("G")})
        for epoch in whole.epochs[:EPOCHS]
    ]
    return replace(whole, epochs=epochs)


@cache
def known() -> list[Residuals]:
    """What the signals are wrong by themselves."""
    return truth(recording())


def by_selection(disturbances: Sequence[Fault]) -> list[tuple[frozenset[str], frozenset[str]]]:
    """Judged and excluded satellites of every cycle."""
    cycles = told(recording(), known(), disturbances)
    return [(frozenset(one.error_m), frozenset(one.error_m) - one.usable) for one in cycles]


def by_raim(solve_fde: Any, disturbances: Sequence[Fault]) -> list[frozenset[str]]:
    """Excluded satellites of every cycle."""
    epochs = disturb(recording().epochs, disturbances).epochs
    return excluded_by_raim(solve_fde, epochs, recording().navigation, recording().point, SQUARES_M2)


def rates(judged: Sequence[frozenset[str]], excluded: Sequence[frozenset[str]], struck: frozenset[str]) -> Rates:
    """Over the epochs of the disturbance."""
    during = range(FROM_S, TO_S)
    bad = [name in excluded[n] for n in during for name in judged[n] & struck]
    good = [name in excluded[n] for n in during for name in judged[n] - struck]
    return Rates(sum(bad) / len(bad), sum(good) / len(good))


def side_by_side(solve_fde: Any, kind: str, size_m: float, *names: str) -> tuple[Rates, Rates]:
    """Selection and residual-based method on one disturbance, printed (seen with -s)."""
    struck = frozenset(names)
    disturbances = [
        Fault("ramp" if kind == "ramp" else "step", struck, FROM_S * 1_000, TO_S * 1_000, {"size_m": size_m})
    ]
    both = by_selection(disturbances)
    judged = [seen for seen, _ in both]
    ours = rates(judged, [gone for _, gone in both], struck)
    theirs = rates(judged, by_raim(solve_fde, disturbances), struck)
    print(
        f"{kind} of {size_m:g} m, {', '.join(names)}: disturbed excluded {ours.disturbed:.0%} | {theirs.disturbed:.0%}, "
        f"healthy excluded {ours.healthy:.1%} | {theirs.healthy:.1%} (map-bound | residuals)"
    )
    return ours, theirs


def test_one_fault_is_found_by_both(monkeypatch: pytest.MonkeyPatch) -> None:
    """A step of 30 m on one satellite: excluded by both in every epoch, and no healthy one with it."""
    solve_fde = told_of_frame(monkeypatch)
    for name in ("G13", "G20"):
        ours, theirs = side_by_side(solve_fde, "step", 30.0, name)
        assert Rates(1.0, 0.0) == ours == theirs


def test_two_faults_of_one_kind_are_told_apart_by_the_map(monkeypatch: pytest.MonkeyPatch) -> None:
    """Two satellites with the same step: residuals blame two healthy ones and keep the faulty; the prediction does not."""
    ours, theirs = side_by_side(told_of_frame(monkeypatch), "step", 30.0, "G13", "G15")
    assert Rates(1.0, 0.0) == ours
    assert 0.0 == theirs.disturbed
    assert theirs.healthy > 0.2


def test_four_of_nine_faulty(monkeypatch: pytest.MonkeyPatch) -> None:
    """Just below half, the breakdown of the median: the map-bound selection still excludes exactly these."""
    ours, theirs = side_by_side(told_of_frame(monkeypatch), "step", 60.0, "G13", "G15", "G20", "G05")
    assert ours.disturbed > 0.95 and ours.healthy < 0.1
    assert theirs.disturbed < ours.disturbed or theirs.healthy > ours.healthy


def test_a_slow_ramp_is_found_where_it_leaves_the_bound(monkeypatch: pytest.MonkeyPatch) -> None:
    """Up to 40 m in 30 s with its rate of 1.3 m/s: late by the threshold, by both; no healthy one is blamed by the map."""
    ours, theirs = side_by_side(told_of_frame(monkeypatch), "ramp", 40.0, "G13")
    assert ours.disturbed > 0.6 and theirs.disturbed > 0.6
    assert 0.0 == ours.healthy


def test_without_faults_neither_excludes(monkeypatch: pytest.MonkeyPatch) -> None:
    """The recording as it is."""
    solve_fde = told_of_frame(monkeypatch)
    assert not any(gone for _, gone in by_selection([]))
    assert not any(by_raim(solve_fde, []))
