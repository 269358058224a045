"""What inputs mean comes from the records that set them, also in compositions and under other names."""

from __future__ import annotations

import pytest

from safeloc.catalogue import load_target
from safeloc.runtime.streams.meanings import meanings_of_inputs
from safeloc.runtime.streams.records import DistanceRecord, MarkerRecord


@pytest.mark.parametrize(
    ("machine", "distance", "marker"),
    [
        ("odometry", "front_wheel_mm", "rear_marker_since_mm"),
        ("supervised_odometry", "odometry.front_radar_mm", "odometry.rear_marker_since_mm"),
        ("balise", "odometer_mm", ""),
    ],
)
def test_each_input_of_a_record_has_the_words_of_its_field(machine: str, distance: str, marker: str) -> None:
    """A distance is not taken for a part of a marker's reading, and what no record of a kind sets has no words."""
    found = meanings_of_inputs(load_target(machine))
    assert found[distance] == DistanceRecord.model_fields["distance_mm"].description
    if marker:
        assert found[marker] == MarkerRecord.model_fields["since_mm"].description
    assert all(found.values())
    assert not any(name.endswith(".present") for name in found)
