"""Configurations: figures that follow from others."""

from __future__ import annotations

from pathlib import Path

import pytest
from pydantic import ValidationError

from safeloc.catalogue import read_config
from safeloc.config import CompositionConfig, Config, derived, derived_figures, quantity
from safeloc.errors import InputError
from safeloc.models.localizer import LocalizerConfig


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


class Journey(CompositionConfig):
    """Two trips, of which one is not the usual one."""

    there: Trip = Trip(way_mm=7_000, speed_mm_s=2_000)
    back: Trip = Trip()
    stops: tuple[int, ...] = ()


def test_a_part_given_in_part_keeps_the_figures_of_the_composition() -> None:
    """Not those of the machine's class: a table that changes one figure changes no other."""
    assert Trip(way_mm=7_000, speed_mm_s=3_000) == Journey.model_validate({"there": {"speed_mm_s": 3_000}}).there
    assert Trip(speed_mm_s=3_000) == Journey.model_validate({"back": {"speed_mm_s": 3_000}}).back
    assert Journey(there=Trip()).there == Trip()
    told = Journey(there=Trip(), stops=(1, 2))
    assert told == Journey.model_validate_json(told.model_dump_json()) == Journey.model_validate(told.model_dump())
    assert Trip(way_mm=7_000, speed_mm_s=3_000) == Journey.model_validate_json('{"there": {"speed_mm_s": 3000}}').there
    with pytest.raises(ValidationError, match=r"there\.speed\n"):
        Journey.model_validate({"there": {"speed": 3_000}})
    with pytest.raises(ValidationError, match=r"there\n.*valid dictionary"):
        Journey.model_validate({"there": 3_000})
    with pytest.raises(ValidationError, match="valid dictionary"):
        Journey.model_validate(3)


def test_a_localizers_part_keeps_the_localizers_figures(tmp_path: Path) -> None:
    """Its wider tolerances, and the law of the checked odometer, also where a table of the odometer gives one figure of it."""
    file = tmp_path / "vehicle.toml"
    file.write_text(
        'sources = ["balise", "reflector"]\n[reflector]\nposition_limit_mm = 1_000_000_000\n[balise]\nreversal_mm = 1_500\n'
        "[balise.odometer]\nrate_ppm = 1\n",
        encoding="utf-8",
    )
    with pytest.raises(InputError, match=r"balise\.odometer is .*, but the vehicle's is"):
        read_config(LocalizerConfig, file)
    file.write_text(file.read_text(encoding="utf-8").replace("rate_ppm = 1", ""), encoding="utf-8")
    made, usual = read_config(LocalizerConfig, file), LocalizerConfig()
    assert made == usual.model_copy(
        update={"sources": ("balise", "reflector"), "balise": usual.balise.model_copy(update={"reversal_mm": 1_500})}
    )
