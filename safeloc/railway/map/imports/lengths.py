"""Converts lengths in files to whole mm, by exact decimal arithmetic that reports rounding."""

from __future__ import annotations

from decimal import ROUND_HALF_EVEN, Decimal, InvalidOperation

from safeloc.errors import InputError
from safeloc.language.units import MM_PER_M
from safeloc.runtime.outside import MOST_DIGITS, quoted

_BEYOND_ALL = Decimal(10) ** 15
"""No length, place, speed or identity of a map is so large; 1e999999999 would be a number of a billion digits."""


def decimal(text: object, place: str) -> Decimal:
    """Return a number in ASCII digits exactly. InputError for anything but a finite number below 10^15; floats are refused."""
    if isinstance(text, bool) or not isinstance(text, (str, int, Decimal)):
        raise InputError(f"{place}: expected a number, got {quoted(text)}.")
    try:
        value = Decimal(_ascii(text.strip()) if isinstance(text, str) else text)
    except InvalidOperation as error:
        raise InputError(f"{place}: expected a number, got {quoted(text)}.") from error
    if not value.is_finite():
        raise InputError(f"{place}: expected a finite number, got {quoted(text)}.")
    if not -_BEYOND_ALL < value < _BEYOND_ALL:
        raise InputError(f"{place}: expected a number below 10^15, got {quoted(text)}.")
    return value


def _ascii(text: str) -> str:
    """Return the text, or "" if it has characters outside ASCII, `_` (`Decimal` accepts both) or too many digits."""
    return text if text.isascii() and "_" not in text and len(text) <= MOST_DIGITS else ""


def millimetres(metres: Decimal) -> tuple[int, bool]:
    """Return metres in whole mm, to the nearest (halves to the even one), and whether this is exact."""
    exact = metres * MM_PER_M
    rounded = exact.to_integral_value(rounding=ROUND_HALF_EVEN)
    return int(rounded), rounded == exact
