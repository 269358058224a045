"""The border: every measurement is admitted as it is or refused with a reason, and nothing in between."""

from __future__ import annotations

import math
from dataclasses import FrozenInstanceError
from decimal import Decimal
from enum import IntEnum
from fractions import Fraction
from unittest.mock import Mock

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from safeloc.errors import InputError
from safeloc.models import odometry
from safeloc.runtime.border import Admitted, Border, Channel, Fault, Raw, Reason, channels_of

WHEEL = Channel("wheel_mm", "mm", -5_000, 5_000, 200)
LARGE = 10**5_000
ANYTHING = st.one_of(
    st.integers(),
    st.integers(-6_000, 6_000),
    st.integers(-6_000, 6_000).map(float),
    st.floats(),
    st.booleans(),
    st.text(),
    st.none(),
    st.decimals(),
    st.fractions(),
    st.complex_numbers(),
    st.lists(st.integers()),
    st.binary(),
    st.sampled_from((LARGE, -LARGE, object(), int, Mock(spec=int), Mock(spec=float), np.float64(7), np.int64(7))),
)


class Stubborn(int):
    """A number that claims to be in every range."""

    def __lt__(self, other: object) -> bool:
        return False

    def __gt__(self, other: object) -> bool:
        return False

    __le__ = __ge__ = __eq__ = lambda self, other: True  # type: ignore[assignment]
    __hash__ = int.__hash__


class Label(IntEnum):
    """A named number."""

    SEVEN = 7


def is_whole(value: object) -> bool:
    """Whether this is a whole number, bool being none."""
    if type(value) is bool or not issubclass(type(value), (int, float)):
        return False
    assert isinstance(value, (int, float))
    return math.isfinite(value) and value == int(value) if isinstance(value, float) else True


def judged(value: object, *, time_ms: int = 1_000, now_ms: int = 1_000) -> Admitted | Fault:
    """One first measurement."""
    return Border([WHEEL]).judge("wheel_mm", Raw(value, time_ms, 1), now_ms)


@given(ANYTHING)
def test_anything_is_admitted_unchanged_or_refused(value: object) -> None:
    """Only whole numbers in range pass, and they pass as they are; all else gets a reason."""
    result = judged(value)
    good = is_whole(value) and -5_000 <= value <= 5_000  # type: ignore[operator]
    assert type(result) is (Admitted if good else Fault)
    if isinstance(result, Admitted):
        assert type(result.value) is int
        assert result.value == value


@given(
    value=ANYTHING,
    age_ms=st.integers(-300, 600),
    sequence=st.integers(-2, 2),
    before=st.none() | st.tuples(st.integers(400, 1_000), st.integers(-2, 2)),
)
def test_one_outcome(value: object, age_ms: int, sequence: int, before: tuple[int, int] | None) -> None:
    """Of admitted and the reasons exactly one is given, and it is the one that its words say."""
    border = Border([WHEEL])
    time_ms, now_ms = 1_000 - age_ms, 1_000
    if before is not None:
        border.judge("wheel_mm", Raw(0, *before), now_ms)
    result = border.judge("wheel_mm", Raw(value, time_ms, sequence), now_ms)
    newer = before is None or (time_ms > before[0] and sequence > before[1])
    if age_ms < 0:
        expected = {Reason.FUTURE}
    elif not newer:
        expected = {Reason.DUPLICATE if (time_ms, sequence) == before else Reason.OUT_OF_ORDER}
    elif age_ms > WHEEL.max_age_ms:
        expected = {Reason.STALE}
    else:
        expected = {Reason.WRONG_TYPE, Reason.NOT_FINITE, Reason.OUT_OF_RANGE}
        fresh = judged(value)
        assert result == fresh
    assert isinstance(result, Admitted) or result.reason in expected
    assert isinstance(result, Fault) or age_ms in range(201)
    assert border.deliveries.last.get("wheel_mm") == ((time_ms, sequence) if newer and age_ms >= 0 else before)


@pytest.mark.parametrize(
    ("value", "reason"),
    [
        (math.nan, Reason.NOT_FINITE),
        (-math.inf, Reason.NOT_FINITE),
        (3.5, Reason.WRONG_TYPE),
        (Fraction(3), Reason.WRONG_TYPE),
        (True, Reason.WRONG_TYPE),
        ("3", Reason.WRONG_TYPE),
        (Decimal(3), Reason.WRONG_TYPE),
        (5_001, Reason.OUT_OF_RANGE),
        (-5_001, Reason.OUT_OF_RANGE),
        (1e300, Reason.OUT_OF_RANGE),
        pytest.param(LARGE, Reason.OUT_OF_RANGE, id="too many digits to print"),
        (Stubborn(9_999), Reason.OUT_OF_RANGE),
        (Mock(spec=int), Reason.WRONG_TYPE),
        (np.int64(7), Reason.WRONG_TYPE),
        (np.float64(math.nan), Reason.NOT_FINITE),
    ],
    ids=lambda item: item.name if isinstance(item, Reason) else type(item).__name__,
)
def test_reasons_for_values(value: object, reason: Reason) -> None:
    """Each kind of wrong value has its own reason."""
    result = judged(value)
    assert isinstance(result, Fault)
    assert result.reason is reason


@pytest.mark.parametrize("value", [7, 7.0, np.float64(7), Label.SEVEN, Stubborn(7)])
def test_whole_numbers_become_plain_ones(value: object) -> None:
    """A whole number in range passes, whatever its type, as a plain int."""
    result = judged(value)
    assert isinstance(result, Admitted)
    assert (type(result.value), result.value) == (int, 7)


@pytest.mark.parametrize(("time_ms", "sequence"), [(math.nan, 1), (1_000, math.nan), (True, 1), (1_000, "1")])
def test_time_and_sequence_are_whole_numbers(time_ms: object, sequence: object) -> None:
    """A measurement without a proper time or number is refused and not remembered."""
    border = Border([WHEEL])
    result = border.judge("wheel_mm", Raw(7, time_ms, sequence), 1_000)  # type: ignore[arg-type]
    assert isinstance(result, Fault)
    assert result.reason is Reason.WRONG_TYPE
    assert border.deliveries.last == {}


def test_a_wrong_clock_does_not_silence_the_channel() -> None:
    """After one measurement from the future, the next ordinary one is admitted."""
    border = Border([WHEEL])
    assert isinstance(border.judge("wheel_mm", Raw(1, 10**9, 1), 1_000), Fault)
    assert border.judge("wheel_mm", Raw(2, 1_000, 2), 1_000) == Admitted(2)


def test_a_channel_cannot_be_changed() -> None:
    """What a channel allows stays as it was declared."""
    with pytest.raises(FrozenInstanceError):
        WHEEL.high = 10**6  # type: ignore[misc]


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
    with pytest.raises(InputError, match="no channel 'whel_mm'; there are"):
        Border([WHEEL]).judge("whel_mm", None, 0)
    with pytest.raises(InputError, match="distinct names"):
        Border([WHEEL, WHEEL])


def test_a_sender_that_does_not_number_its_measurements() -> None:
    """The time alone tells old from new."""
    border, reasons = Border([WHEEL]), []
    for raw in (Raw(1, 900), Raw(2, 900), Raw(3, 899), Raw(4, 901), Raw(5, 902, 1), Raw(6, 902)):
        result = border.judge("wheel_mm", raw, 1_000)
        reasons.append(result.reason if isinstance(result, Fault) else None)
    assert reasons == [None, Reason.DUPLICATE, Reason.OUT_OF_ORDER, None, None, Reason.OUT_OF_ORDER]
