"""The cycle's length as a configuration says it."""

from __future__ import annotations

import pytest

from safeloc.config import Config
from safeloc.errors import InputError
from safeloc.models.localizer import LocalizerConfig
from safeloc.runtime.embedding.cycle_length import configured_period_ms, periods


class Part(Config):
    """A machine's own configuration."""

    period_ms: int = 100


class Whole(Config):
    """Of a composition: two machines, and a figure of its own."""

    left: Part = Part()
    right: Part = Part()
    tolerance_mm: int = 5


def test_a_composition_has_the_period_of_its_machines() -> None:
    """They agree: so the whole localizer has one, too."""
    assert configured_period_ms("pair", Whole()) == 100
    assert configured_period_ms("localizer", LocalizerConfig()) == 100


def test_periods_that_differ_are_refused() -> None:
    """One step is one cycle: of all machines at once."""
    config = Whole(right=Part(period_ms=200))
    assert periods(config) == [100, 200]
    with pytest.raises(
        InputError, match=r"^pair is configured for cycles of \[100, 200\] ms at once; make them one\.$"
    ):
        configured_period_ms("pair", config)


def test_a_configuration_may_say_nothing_of_it() -> None:
    """Then the host says it, or any step is a cycle."""
    assert configured_period_ms("none", None) is None
    assert configured_period_ms("part", Config()) is None
