"""Limits are checked when they are stated."""

import math

import pytest

from safeloc.errors import InputError
from safeloc.proof.provers.limits import Limits, deadline, milliseconds


@pytest.mark.parametrize("seconds", [0.0, -1.0, math.nan, math.inf])
def test_time_limits_are_positive_and_finite(seconds: float) -> None:
    """A time limit that is not positive and finite is refused."""
    with pytest.raises(InputError, match="it must be positive and finite"):
        Limits(seconds=seconds)


@pytest.mark.parametrize("wrong", [{"depth": -1}, {"induction": 0}])
def test_depths_are_sensible(wrong: dict[str, int]) -> None:
    """A negative depth and a k of 0 are refused."""
    with pytest.raises(InputError, match="depth must be 0 or more, induction 1 or more"):
        Limits(**wrong)


def test_no_time_is_never_unlimited_time() -> None:
    """The least limit for a solver is 1 ms, since 0 ms means `no limit`."""
    assert milliseconds(0.0) == 1
    assert milliseconds(0.0001) == 1


def test_a_deadline_passes() -> None:
    """No time is left after the deadline, and never a negative one."""
    assert deadline(0.0).passed
    assert deadline(-1.0).left == 0.0
    assert not deadline(60.0).passed
