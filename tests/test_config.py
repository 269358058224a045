"""Configurations: figures that follow from others."""

from __future__ import annotations

import pytest
from pydantic import ValidationError

from safeloc.config import Config, derived, derived_figures, quantity


class Trip(Config):
    """A way and a speed."""

    way_mm: int = quantity(3_000, "mm", 0, 10_000, "[D] tried")
    speed_mm_s: int = quantity(1_000, "mm/s", 1, 5_000, "[D] tried")

    @derived("ms", "[D] how long it takes")
    def time_ms(self) -> int:
        """Time of the way."""
        return -(-self.way_mm * 1_000 // self.speed_mm_s)


class LongTrip(Trip):
    """With a figure of its own."""

    @derived("mm", "[D] there and back")
    def both_mm(self) -> int:
        """Twice the way."""
        return 2 * self.way_mm


def test_a_derived_figure_follows_from_the_fields() -> None:
    """It is computed, no field, and cannot be set."""
    assert 3_000 == Trip().time_ms
    assert 1_500 == Trip(speed_mm_s=2_000).time_ms
    assert {"way_mm", "speed_mm_s"} == set(Trip().model_dump())
    with pytest.raises(ValidationError, match="time_ms"):
        Trip(time_ms=1)  # type: ignore[call-arg]


def test_derived_figures_carry_unit_and_source() -> None:
    """Those of a class and of what it extends."""
    assert [("time_ms", "ms", "[D] how long it takes"), ("both_mm", "mm", "[D] there and back")] == [
        (name, figure.unit, figure.source) for name, figure in derived_figures(LongTrip())
    ]
