"""The border: every measurement is admitted as it is or refused with a reason, and nothing in between."""

from __future__ import annotations

import math
from decimal import Decimal

import pytest
from hypothesis import given
from hypothesis import strategies as st

from safeloc.border import Admitted, Border, Channel, Fault, Raw, Reason, channels_of
from safeloc.errors import InputError
from safeloc.models import odometry

WHEEL = Channel("wheel_mm", "mm", -5_000, 5_000, 200)
ANYTHING = st.one_of(
    st.integers(), st.floats(), st.booleans(), st.text(), st.none(), st.decimals(), st.lists(st.integers()), st.binary()
)


def judged(value: object, *, time_ms: int = 1_000, now_ms: int = 1_000) -> Admitted | Fault:
    """One first measurement."""
    return Border([WHEEL]).judge("wheel_mm", Raw(value, time_ms, 1), now_ms)


@given(ANYTHING)
def test_anything_is_admitted_unchanged_or_refused(value: object) -> None:
    """Only whole numbers in range pass, and they pass as they are."""
    result = judged(value)
    good = isinstance(value, int) and not isinstance(value, bool) and -5_000 <= value <= 5_000
    assert isinstance(result, Admitted) == good
    if isinstance(result, Admitted):
        assert result.value is value


@pytest.mark.parametrize(
    ("value", "reason"),
    [
        (math.nan, Reason.NOT_FINITE),
        (-math.inf, Reason.NOT_FINITE),
        (3.0, Reason.WRONG_TYPE),
        (True, Reason.WRONG_TYPE),
        ("3", Reason.WRONG_TYPE),
        (Decimal(3), Reason.WRONG_TYPE),
        (5_001, Reason.OUT_OF_RANGE),
        (-5_001, Reason.OUT_OF_RANGE),
    ],
)
def test_reasons_for_values(value: object, reason: Reason) -> None:
    """Each kind of wrong value has its own reason."""
    result = judged(value)
    assert isinstance(result, Fault)
    assert result.reason is reason


@pytest.mark.parametrize(("age_ms", "reason"), [(200, None), (201, Reason.STALE), (-1, Reason.FUTURE)])
def test_age(age_ms: int, reason: Reason | None) -> None:
    """Up to the permitted age, and never from after now."""
    result = judged(7, time_ms=1_000 - age_ms)
    assert (result.reason if isinstance(result, Fault) else None) is reason


def test_order_of_delivery() -> None:
    """The same again is a duplicate; an older one is out of order, also after a fault."""
    border = Border([WHEEL])
    reasons = []
    for raw in (
        Raw(1, 900, 1),
        Raw(1, 900, 1),
        Raw(2, 800, 2),
        Raw(9_999, 950, 3),
        Raw(3, 940, 4),
        Raw(4, 990, 5),
        None,
    ):
        result = border.judge("wheel_mm", raw, 1_000)
        reasons.append(result.reason if isinstance(result, Fault) else None)
    assert reasons == [
        None, Reason.DUPLICATE, Reason.OUT_OF_ORDER, Reason.OUT_OF_RANGE, Reason.OUT_OF_ORDER, None, Reason.MISSING,
    ]  # fmt: skip


def test_a_step_of_the_odometry_machine() -> None:
    """Admitted values by name, faulty ones absent, every fault told."""
    border = Border(channels_of(odometry.machine(), 100))
    admitted, faults = border.inputs({"front_wheel_mm": Raw(120, 0, 1), "front_radar_mm": Raw(math.nan, 0, 1)}, 0)
    assert admitted == {"front_wheel_mm": 120}
    assert {fault.reason for fault in faults} == {Reason.NOT_FINITE, Reason.MISSING}
    assert len(admitted) + len(faults) == 12


def test_unknown_channels_are_refused() -> None:
    """A misspelt name is an error, not a missing measurement."""
    with pytest.raises(InputError, match="no channel 'whel_mm'; there are"):
        Border([WHEEL]).inputs({"whel_mm": Raw(1, 0, 1)}, 0)
    with pytest.raises(InputError, match="distinct names"):
        Border([WHEEL, WHEEL])
