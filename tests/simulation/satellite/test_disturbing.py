"""Disturbances of recordings: what is added, to whom, when, and what is left alone."""

from __future__ import annotations

import pytest

from safeloc.errors import InputError
from safeloc.sensing.satellite.epochs import Epoch, Measured
from safeloc.simulation.satellite.disturbing import Disturbance, Disturbed, disturb

EPOCHS = [Epoch(1_000.0 + n, {"G01": Measured(2e7, 100.0), "G02": Measured(2.2e7, None)}) for n in range(20)]
ONE = frozenset({"G01"})


def _added(found: Disturbed, number: int) -> tuple[float, float]:
    measured = found.epochs[number].satellites["G01"]
    return measured.code() - 2e7, measured.rate() - 100.0


def test_a_step_strikes_whom_it_names_while_it_lasts() -> None:
    """30 m from the fifth to the tenth second on G01 alone; the truth says so."""
    found = disturb(EPOCHS, [Disturbance("step", 5, 10, 30.0, ONE)])
    assert [30.0 if 5 <= n < 10 else 0.0 for n in range(20)] == [_added(found, n)[0] for n in range(20)]
    assert [{"G01": 30.0} if 5 <= n < 10 else {} for n in range(20)] == [dict(one) for one in found.error_m]
    assert all(a.satellites["G02"] == b.satellites["G02"] for a, b in zip(EPOCHS, found.epochs, strict=True))


def test_a_ramp_has_the_rate_of_its_slope() -> None:
    """20 m in ten seconds: 2 m/s, unless only the code is bent."""
    found = disturb(EPOCHS, [Disturbance("ramp", 0, 10, 20.0, ONE)])
    assert (10.0, 2.0) == pytest.approx(_added(found, 5))
    assert (10.0, 0.0) == pytest.approx(
        _added(disturb(EPOCHS, [Disturbance("ramp", 0, 10, 20.0, ONE, code_only=True)]), 5)
    )


def test_a_wave_comes_back() -> None:
    """A quarter of its period on: full height and no rate."""
    found = disturb(EPOCHS, [Disturbance("wave", 0, 20, 8.0, ONE, period_s=12.0)])
    assert (8.0, 0.0) == pytest.approx(_added(found, 3))


def test_a_false_place_follows_the_slopes() -> None:
    """Each satellite is dragged by its own slope; without slopes there is no track to lie about."""
    lie = Disturbance("false place", 0, 10, 50.0)
    found = disturb(EPOCHS, [lie], lambda _: {"G01": 0.5, "G02": -0.25})
    assert (12.5, 2.5) == pytest.approx(_added(found, 5))
    assert -6.25 == pytest.approx(found.epochs[5].satellites["G02"].code() - 2.2e7)
    assert found.epochs[5].satellites["G02"].rate_m_per_s is None
    with pytest.raises(InputError, match="give the slopes"):
        disturb(EPOCHS, [lie])


def test_silence_takes_the_measurement() -> None:
    """Silent for the last 2 s of every 5; nothing is added, and what is gone is no disturbed signal."""
    found = disturb(EPOCHS, [Disturbance("silence", 0, 20, 0.0, ONE, period_s=5.0, silent_s=2.0)])
    assert [n % 5 < 3 for n in range(20)] == ["G01" in epoch.satellites for epoch in found.epochs]
    assert not any(found.error_m)


def test_disturbances_add_up() -> None:
    """Two on one satellite are one sum."""
    found = disturb(EPOCHS, [Disturbance("step", 0, 10, 5.0, ONE), Disturbance("step", 0, 10, 7.0)])
    assert 12.0 == _added(found, 1)[0] == found.error_m[1]["G01"]


def test_what_is_no_disturbance_is_refused() -> None:
    """No time, no finite size, no cycle."""
    for wrong in ({"to_s": 0.0}, {"size_m": float("nan")}, {"silent_s": 10.0}):
        with pytest.raises(InputError):
            Disturbance(**({"kind": "step", "from_s": 0.0, "to_s": 1.0} | wrong))  # type: ignore[arg-type]
