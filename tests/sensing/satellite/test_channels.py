"""Satellites on channels: they keep them, windows follow them, and what is told is never smaller than it is."""

from __future__ import annotations

import pytest

from safeloc.errors import InputError
from safeloc.runtime.border import Reason
from safeloc.sensing.satellite.channels import Channels, Received, identity, satellite_name
from safeloc.sensing.satellite.residuals import Residuals

NONE: frozenset[str] = frozenset()


def look(**codes: float) -> Residuals:
    """Residuals of pseudorange; rates a tenth of them."""
    return Residuals(codes, {name: value / 10 for name, value in codes.items()}, {}, NONE, NONE, 0.0)


def heard(channels: Channels, *looks: Residuals) -> Received:
    """All satellites of the looks visible and valid."""
    names = frozenset(name for one in looks for name in one.pseudorange_m)
    return channels.hear(names, names, looks)


def test_a_satellite_keeps_its_channel() -> None:
    """One sets and another rises: the second stays where it is, and the new one takes the free channel."""
    channels = Channels(3, 2)
    heard(channels, look(G05=1.0, G11=1.0))
    assert {"G02": 1, "G11": 2} == heard(channels, look(G11=1.0, G02=1.0)).channels


def test_differences_are_told_away_from_zero() -> None:
    """Whole mm, never nearer to the prediction than they are."""
    inputs = heard(Channels(2, 2), look(G01=1.0001, G02=-1.0001)).inputs
    assert (1_001, -1_001) == (inputs["channel_1_range_off_mm"], inputs["channel_2_range_off_mm"])
    assert (101, -101) == (inputs["channel_1_speed_off_mm_s"], inputs["channel_2_speed_off_mm_s"])


def test_covariance_needs_a_window() -> None:
    """None in the first epoch of two; a satellite that was away starts anew."""
    channels = Channels(1, 2)
    key = "channel_1_range_covariance_mm2"
    found = [heard(channels, look(G01=value)).inputs.get(key) for value in (1.0, 3.0)]
    channels.hear(NONE, NONE, [])
    assert [None, 2_000_000, None] == [*found, heard(channels, look(G01=5.0)).inputs.get(key)]


def test_of_two_portions_the_worse_counts() -> None:
    """A satellite is told with the greater difference; one that is missing on a portion has none."""
    inputs = heard(Channels(2, 2), look(G01=2.0, G02=1.0), look(G01=-7.0)).inputs
    assert -7_000 == inputs["channel_1_range_off_mm"]
    assert "channel_2_range_off_mm" not in inputs


def test_what_cannot_be_told_is_a_fault() -> None:
    """Not finite, farther than a million metres, no free channel, no valid ephemeris: each with its reason."""
    found = Channels(2, 2).hear(
        frozenset({"G01", "G02", "G03"}), frozenset({"G01", "G02"}), [look(G01=float("nan"), G02=2e6)]
    )
    told = {fault.channel: fault.reason for fault in found.faults}
    assert {"G01": Reason.NOT_FINITE, "G02": Reason.OUT_OF_RANGE, "G03": Reason.STALE} == told
    assert Reason.SURPLUS in {fault.reason for fault in found.faults}
    assert "channel_1_range_off_mm" not in found.inputs and found.inputs["channel_1_satellite"] == 1


def test_identities_are_distinct() -> None:
    """Every constellation has its hundred; what is no satellite's name is refused."""
    assert [5, 105, 205, 305, 405, 505, 605] == [identity(f"{system}05") for system in "GRECJIS"]
    for wrong in ("X05", "G", "G00", "G1x", ""):
        with pytest.raises(InputError, match="is no satellite"):
            identity(wrong)
    assert [f"{system}05" for system in "GRECJIS"] == [satellite_name(number) for number in range(5, 700, 100)]
    for none in (0, -95, 100, 705):
        with pytest.raises(InputError, match="no identity"):
            satellite_name(none)
    with pytest.raises(InputError, match="0 channels receive nothing"):
        Channels(0, 2)
