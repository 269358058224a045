"""Disturbances of recordings: what is added, to whom, when, and what is left alone."""

from __future__ import annotations

import pytest

from safeloc.errors import InputError
from safeloc.sensing.satellite.epochs import Epoch, Measured
from safeloc.simulation.faults import Fault
from safeloc.simulation.satellite.disturbing import Disturbed, disturb

EPOCHS = [Epoch(1_000.0 + n, {"G01": Measured(2e7, 100.0), "G02": Measured(2.2e7, None)}) for n in range(20)]
ONE = frozenset({"G01"})


def _added(found: Disturbed, number: int) -> tuple[float, float]:
    measured = found.epochs[number].satellites["G01"]
    return measured.code() - 2e7, measured.rate() - 100.0


def test_a_step_strikes_whom_it_names_while_it_lasts() -> None:
    """30 m from the fifth to the tenth second on G01 alone; the truth says so."""
    found = disturb(EPOCHS, [Fault("step", ONE, 5_000, 10_000, {"size_m": 30.0})])
    assert [30.0 if 5 <= n < 10 else 0.0 for n in range(20)] == [_added(found, n)[0] for n in range(20)]
    assert [{"G01": 30.0} if 5 <= n < 10 else {} for n in range(20)] == [dict(one) for one in found.error_m]
    assert all(a.satellites["G02"] == b.satellites["G02"] for a, b in zip(EPOCHS, found.epochs, strict=True))


def test_a_ramp_has_the_rate_of_its_slope() -> None:
    """20 m in ten seconds: 2 m/s, unless only the code is bent."""
    found = disturb(EPOCHS, [Fault("ramp", ONE, 0, 10_000, {"size_m": 20.0})])
    assert (10.0, 2.0) == pytest.approx(_added(found, 5))
    assert (10.0, 0.0) == pytest.approx(
        _added(disturb(EPOCHS, [Fault("ramp", ONE, 0, 10_000, {"size_m": 20.0, "code_only": True})]), 5)
    )


def test_a_wave_comes_back() -> None:
    """A quarter of its period on: full height and no rate."""
    found = disturb(EPOCHS, [Fault("wave", ONE, 0, 20_000, {"size_m": 8.0, "period_s": 12.0})])
    assert (8.0, 0.0) == pytest.approx(_added(found, 3))


def test_a_false_place_follows_the_slopes() -> None:
    """Each satellite is dragged by its own slope; without slopes there is no track to lie about."""
    lie = Fault("false place", end=10_000, figures={"size_m": 50.0})
    found = disturb(EPOCHS, [lie], lambda _: {"G01": 0.5, "G02": -0.25})
    assert (12.5, 2.5) == pytest.approx(_added(found, 5))
    assert -6.25 == pytest.approx(found.epochs[5].satellites["G02"].code() - 2.2e7)
    assert found.epochs[5].satellites["G02"].rate_m_per_s is None
    with pytest.raises(InputError, match="give the slopes"):
        disturb(EPOCHS, [lie])


def test_silence_takes_the_measurement() -> None:
    """Silent for the last 2 s of every 5; nothing is added, and what is gone is no disturbed signal."""
    found = disturb(EPOCHS, [Fault("silence", ONE, 0, 20_000, {"period_s": 5.0, "silent_s": 2.0})])
    assert [n % 5 < 3 for n in range(20)] == ["G01" in epoch.satellites for epoch in found.epochs]
    assert not any(found.error_m)


def test_disturbances_add_up() -> None:
    """Two on one satellite are one sum."""
    found = disturb(
        EPOCHS, [Fault("step", ONE, 0, 10_000, {"size_m": 5.0}), Fault("step", "G01", 0, 10_000, {"size_m": 7.0})]
    )
    assert 12.0 == _added(found, 1)[0] == found.error_m[1]["G01"]


@pytest.mark.parametrize(
    ("fault", "message"),
    [
        (Fault("step", end=0), r"needs 0 <= begin < end\.$"),
        (Fault("step"), r"give its end, and figures that are numbers\.$"),
        (Fault("step", end=1, figures={"size_m": float("nan")}), r"give its end, and figures that are numbers\.$"),
        (Fault("step", end=1, figures={"size_m": "far"}), r"give its end, and figures that are numbers\.$"),
        (Fault("silence", end=1, figures={"silent_s": 10.0}), r"silent_s has to be a part of period_s\.$"),
    ],
    ids=str,
)
def test_what_no_recording_can_have_is_refused(fault: Fault, message: str) -> None:
    """No time, no finite size, no cycle."""
    with pytest.raises(InputError, match=message):
        disturb(EPOCHS, [fault])
