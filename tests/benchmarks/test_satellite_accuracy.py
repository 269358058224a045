"""The tally of satellite trials counts what it says, and trials keep what is claimed of them."""

from __future__ import annotations

from collections.abc import Mapping
from functools import cache

import pytest

from benchmarks.satellite_accuracy import CONDITIONS, DISTURBED, HEADS, Row, recorded, simulated
from benchmarks.satellite_recorded import Recording, geodetic, phone
from benchmarks.satellite_tally import Cycle, Tally, quantiles
from tests.data_sources import data_file

pytest.importorskip("pyproj")


def cycle(
    errors: Mapping[str, float],
    added: Mapping[str, float],
    usable: str = "",
    *,
    truth_mm: int = 0,
    accepted: bool = True,
) -> Cycle:
    """A report of 0 +- 5 m, from a solution of all usable satellites; names are single letters."""
    kept = frozenset(usable)
    hidden = dict.fromkeys(kept, 5.0)
    return Cycle(
        truth_mm, (-5_000, 0, 5_000), 8_000, (0, 4_000), accepted, "ACCEPTED", kept, kept, errors, added, hidden
    )


def test_signals_are_sorted_by_their_error() -> None:
    """Healthy; added but harmless; beyond the bound; beyond twice of it."""
    tally = Tally("x", healthy_m=4.0, bound_m=10.0)
    errors = {"a": 3.0, "b": 9.0, "c": -15.0, "d": 40.0, "e": 5.0}
    tally.add([cycle(errors, {"b": 8.0, "c": -15.0, "d": 40.0}, "abc")])
    assert {"healthy": 1, "within": 2, "beyond": 1, "far beyond": 1} == dict(tally.signals)
    assert [0.0, 0.5, 0.0, 1.0] == [tally.excluded(kind) for kind in ("healthy", "within", "beyond", "far beyond")]
    assert tally.excluded("unheard of") is None


def test_a_miss_counts_by_what_was_assumed() -> None:
    """An interval that misses the truth while all bounds held is one thing, after a used signal broke its bound another."""
    tally = Tally("x", 4.0, 10.0)
    tally.add([cycle({"a": 1.0}, {}, "a", truth_mm=6_000), cycle({"a": 12.0}, {"a": 12.0}, "a", truth_mm=6_000)])
    assert (1, 1) == (tally.wrong["kept"], tally.wrong["broken"])
    assert (1, 1) == (tally.beyond_level["kept"], tally.beyond_level["broken"])
    tally.add([cycle({"a": 12.0}, {"a": 12.0}, "a", accepted=False), cycle({"a": 1.0}, {}, "a", truth_mm=6_000)])
    assert (2, 1) == (tally.wrong["kept"], tally.wrong["broken"])
    assert 0 == tally.drifted_beyond
    tally.add([cycle({}, {}, truth_mm=-8_000), cycle({}, {}, truth_mm=-8_001)])
    assert 1 == tally.drifted_beyond


def test_misses_in_a_row_and_broken_figures_are_counted() -> None:
    """The longest row of misses, which a new run begins anew; cycles whose prediction or clock is beyond its figure."""
    tally, missed = Tally("x", 4.0, 10.0, hidden_m=4.9), cycle({"a": 1.0}, {}, "a", truth_mm=6_000)
    tally.add([missed, missed, cycle({"a": 1.0}, {}, "a"), missed])
    tally.add([missed, missed])
    assert (2, 6) == (tally.longest_unseen, tally.uncompared)
    loose = Tally("y", 4.0, 10.0, hidden_m=5.0)
    loose.add([missed])
    assert 0 == loose.uncompared


def test_errors_are_those_of_solutions_that_were_taken() -> None:
    """Median, 95 % and worst in metres; none for none."""
    assert (2.0, pytest.approx(3.8), 4.0) == quantiles([0, 1_000, 2_000, 3_000, 4_000])
    assert quantiles([]) is None
    tally = Tally("x", 4.0, 10.0)
    tally.add([cycle({}, {}, truth_mm=3_000), cycle({}, {}, truth_mm=9_000, accepted=False)])
    assert [3_000] == tally.errors_mm
    assert len(HEADS) == len(Row(tally).cells())


@pytest.mark.thorough
@pytest.mark.parametrize(("name", "most"), [("street", 0.15), ("tunnel", 0.02)])
def test_no_interval_misses_while_bounds_hold(name: str, most: float) -> None:
    """One journey: nothing missed; far errors excluded; healthy signals kept, fewer where many are disturbed."""
    tally = simulated(name, CONDITIONS[name], 1)
    assert 0 == tally.wrong["kept"] == tally.beyond_level["kept"] == tally.drifted_beyond
    assert (tally.excluded("healthy") or 0) < most
    assert (tally.excluded("far beyond") or 1) > 0.9


@cache
def still() -> Recording:
    """The geodetic receiver."""
    return geodetic(data_file("gnss_septentrio/rover.obs").parents[1])


@pytest.mark.thorough
@pytest.mark.parametrize("name", ["as recorded", "steps of 60 m, five"])
def test_recorded_signals(name: str) -> None:
    """Every far error is excluded, healthy signals stay, the known point is always inside, and errors stay below 2 m."""
    tally = recorded(still(), name, DISTURBED[name])
    assert 301 == tally.cycles
    assert 0 == tally.wrong["kept"] + tally.wrong["broken"]
    assert (tally.excluded("healthy") or 0) < 0.02
    assert tally.excluded("far beyond") in (None, 1.0)
    assert max(tally.errors_mm) < 2_000


@pytest.mark.slow
@pytest.mark.parametrize("name", DISTURBED)
def test_every_disturbance_of_the_recording(name: str) -> None:
    """No interval misses the known point; only what drags all signals together breaks what is assumed of the prediction."""
    tally = recorded(still(), name, DISTURBED[name])
    assert 0 == tally.wrong["kept"] == tally.beyond_level["kept"] == tally.wrong["broken"]
    assert (tally.uncompared > 0) == name.startswith("all dragged")


@pytest.mark.slow
def test_the_phone() -> None:
    """A noisy receiver with bounds to match: the known point is inside in every cycle."""
    data_file("gnss_android/hour1820.16n")
    tally = recorded(phone(data_file("gnss_septentrio/rover.obs").parents[1]), "as recorded", ())
    assert 0 == tally.wrong["kept"] + tally.wrong["broken"]
    assert tally.reported > 200


@pytest.mark.slow
@pytest.mark.parametrize("name", CONDITIONS)
def test_every_condition(name: str) -> None:
    """Three journeys: nothing missed while every used signal kept its bound, and the bound on a drift whatever they do."""
    tally = simulated(name, CONDITIONS[name], 3)
    assert 0 == tally.wrong["kept"] == tally.beyond_level["kept"] == tally.drifted_beyond
