"""A report is read whole, or refused: nothing in it is guessed."""

from __future__ import annotations

import json
from typing import Any

import pytest

from safeloc.errors import InputError
from safeloc.railway.trackside.seen import Seen, read_report
from safeloc.railway.trackside.wiring import VehicleWiring

WIRING = VehicleWiring(length_mm=100_000, faces_upwards=True, whole="ends.valid")
GOOD: dict[str, Any] = {"vehicle": "12", "time_ms": 100, "interval_mm": [1, 2], "outputs": {"ends.valid": True}}


def read(changes: dict[str, Any], wiring: VehicleWiring = WIRING) -> Seen:
    """The good report with changes; None leaves a field out."""
    fields = {name: value for name, value in {**GOOD, **changes}.items() if value != "left out"}
    return read_report("12", json.dumps(fields).encode(), wiring)


def test_reports() -> None:
    """A place, confirmed as whole or not; no place; and no integrity where no output tells it."""
    assert read({}) == Seen(100, 1, 2, True)
    assert read({"outputs": {"ends.valid": False}}) == Seen(100, 1, 2, False)
    assert read({"interval_mm": None}) == Seen(100, None, None, False)
    assert read({}, VehicleWiring(length_mm=100_000, faces_upwards=True)) == Seen(100, 1, 2, False)


@pytest.mark.parametrize(
    ("changes", "why"),
    [
        ({"vehicle": "13"}, "a report of vehicle '13' under the topic of 12"),
        ({"vehicle": "left out"}, "under the topic of 12"),
        ({"time_ms": 1.5}, "time_ms is 1.5"),
        ({"time_ms": -1}, "time_ms is -1"),
        ({"time_ms": True}, "time_ms is True"),
        ({"time_ms": 2**60}, "time_ms is"),
        ({"interval_mm": "left out"}, "reports no place"),
        ({"interval_mm": [2, 1]}, "two places in order"),
        ({"interval_mm": [1]}, "two places in order"),
        ({"interval_mm": [1, 2.5]}, "two places in order"),
        ({"interval_mm": [False, True]}, "two places in order"),
        ({"interval_mm": {"0": 1, "1": 2}}, "two places in order"),
        ({"track": {"edge": None, "possible": []}}, "along an edge of the map"),
        ({"outputs": {}}, "no output ends.valid"),
        ({"outputs": [1]}, "no output ends.valid"),
        ({"outputs": {"ends.valid": 1}}, "no output ends.valid"),
    ],
)
def test_what_is_no_report(changes: dict[str, Any], why: str) -> None:
    """Each flaw has its reason."""
    with pytest.raises(InputError, match=why):
        read(changes)


@pytest.mark.parametrize("text", [b"", b"\xff", b"[]", b'{"vehicle": "12", "vehicle": "12"}', b"{" * 5_000])
def test_what_is_no_object(text: bytes) -> None:
    """No bytes are read as something else."""
    with pytest.raises(InputError):
        read_report("12", text, WIRING)
