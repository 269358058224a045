"""Figures of a guard that are out of range are refused with the value that was given."""

from __future__ import annotations

import pytest

from safeloc.errors import InputError
from safeloc.railway.guard.figures import guard_config


def test_a_figure_out_of_range() -> None:
    """Its name and its value; where figures contradict each other, the sentence names both."""
    with pytest.raises(InputError, match=r"^guard, max_age_ms: Input should be less than .* 60000 \(got 60001\)\.$"):
        guard_config(None, {"max_age_ms": 60_001})
    with pytest.raises(InputError, match=r"^guard, figures: period_ms must be even, [^(]*nanometres\.$"):
        guard_config(None, {"period_ms": 99})
