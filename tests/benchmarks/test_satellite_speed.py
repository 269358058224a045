"""The speed benchmark of the satellite chain measures what it says."""

from __future__ import annotations

from benchmarks.satellite_speed import configured, driven, epochs, sky


def test_every_satellite_is_used() -> None:
    """As many as channels, in every epoch after the warm-up: what is timed is the whole work."""
    navigation = sky(12)
    found = driven(configured(12), navigation, epochs(12, navigation))
    assert {12} == {len(one.usable) for one in found[6:]}
    assert all(one.solution is not None and one.outputs["position.valid"] for one in found[6:])
