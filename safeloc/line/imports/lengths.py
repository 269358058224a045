"""Lengths as files write them, into whole mm: exact decimal arithmetic, and a remark where something was lost."""

from __future__ import annotations

from decimal import ROUND_HALF_EVEN, Decimal, InvalidOperation

from safeloc.errors import InputError

MM_PER_M = 1000


def decimal(text: object, place: str) -> Decimal:
    """A number as it is written. InputError for what is no finite number; binary fractions are refused."""
    if isinstance(text, bool) or not isinstance(text, (str, int, Decimal)):
        raise InputError(f"{place}: expected a number, got {text!r}.")
    try:
        value = Decimal(text.strip() if isinstance(text, str) else text)
    except InvalidOperation as error:
        raise InputError(f"{place}: expected a number, got {text!r}.") from error
    if not value.is_finite():
        raise InputError(f"{place}: expected a finite number, got {text!r}.")
    return value


def millimetres(metres: Decimal) -> tuple[int, bool]:
    """Metres in whole mm, to the nearest (halves to the even one), and whether nothing was lost."""
    exact = metres * MM_PER_M
    whole = exact.to_integral_value(rounding=ROUND_HALF_EVEN)
    return int(whole), whole == exact
