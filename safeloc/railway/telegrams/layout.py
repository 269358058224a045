"""Layouts of packets, as the tables of SUBSET-026 7.4 give them, and the change from bits to values and back.

A layout is a sequence of variables, of parts that are there only for some values of an earlier variable, and of lists, whose
number of members N_ITER gives. In JSON a list stands under a name of its own, such as `D_LINK(k)`; N_ITER is its length.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence, Set
from dataclasses import dataclass
from types import MappingProxyType
from typing import Any, TypeAlias

from safeloc.errors import InputError
from safeloc.railway.telegrams.variables import VARIABLES, require, variable_of

Values: TypeAlias = dict[str, Any]
"""Values by name; lists of such values by the names of lists."""


@dataclass(frozen=True)
class Given:
    """Parts that are there where a variable before them has one of these values."""

    name: str
    values: Set[int]
    parts: Sequence[Part]


@dataclass(frozen=True)
class Listed:
    """N_ITER, and so many times the parts."""

    name: str
    parts: Sequence[Part]


Part: TypeAlias = "str | Given | Listed"


class BitReader:
    """Reads variables from a bit string, from the first bit on."""

    def __init__(self, bits: str) -> None:
        """InputError where the text has other characters than 0 and 1."""
        wrong = next((index for index, bit in enumerate(bits) if bit not in "01"), None)
        if wrong is not None:
            raise InputError(f"bit {wrong} is {bits[wrong]!r}; a bit string has only 0 and 1.")
        self._bits, self.at = bits, 0

    @property
    def left(self) -> int:
        """The number of bits that are not read yet."""
        return len(self._bits) - self.at

    def peek(self, name: str, ahead: int = 0) -> int:
        """Return the variable that begins `ahead` bits from here, without reading it. InputError where the bits end before."""
        size, begin = variable_of(name).bits, self.at + ahead
        if begin + size > len(self._bits):
            raise InputError(f"bit {begin}: {name} needs {size} bits, {max(0, len(self._bits) - begin)} are left.")
        return int(self._bits[begin : begin + size], 2)

    def read(self, name: str) -> int:
        """Return the next variable. InputError with the bit where it is cut off or spare."""
        value, begin = self.peek(name), self.at
        self.at += variable_of(name).bits
        try:
            return require(name, value)
        except InputError as error:
            raise InputError(f"bit {begin}: {error}") from error

    def take(self, size: int) -> str:
        """Return the next bits as they are. InputError where they end before."""
        if size > self.left:
            raise InputError(f"bit {self.at}: {size} bits are announced, {self.left} are left.")
        self.at += size
        return self._bits[self.at - size : self.at]


def decoded(parts: Sequence[Part], bits: BitReader, outer: Mapping[str, Any] = MappingProxyType({})) -> Values:
    """Return the values of a layout, read from here on. outer: values of the layout around it."""
    values: Values = {}
    for part in parts:
        match part:
            case Given(name, accepted, inner):
                known = {**outer, **values}
                values |= decoded(inner, bits, known) if known[name] in accepted else {}
            case Listed(name, inner):
                known = {**outer, **values}
                values[name] = [decoded(inner, bits, known) for _ in range(bits.read("N_ITER"))]
            case str():
                values[part] = bits.read(part)
    return values


def encoded(
    parts: Sequence[Part], values: Mapping[str, Any], where: str = "", outer: Mapping[str, Any] = MappingProxyType({})
) -> str:
    """Return the bits of a layout. InputError for values that are missing, out of range, or have no place in it."""
    left = dict(values)
    bits = _taken(parts, left, where, outer)
    if left:
        raise InputError(f"{where}{', '.join(left)}: no place for this here.")
    return bits


def _taken(parts: Sequence[Part], left: dict[str, Any], where: str, outer: Mapping[str, Any]) -> str:
    """Return the bits of the layout, and take its values out of those that are left."""
    known = {**outer, **left}
    bits = ""
    for part in parts:
        match part:
            case Given(name, accepted, inner):
                bits += _taken(inner, left, where, known) if known[name] in accepted else ""
            case Listed(name, inner):
                bits += _list(name, left.pop(name, []), inner, where, known)
            case str():
                if part not in left:
                    raise InputError(f"{where}{part} is missing.")
                bits += _bits(part, left.pop(part), where)
    return bits


def _list(name: str, members: object, inner: Sequence[Part], where: str, known: Mapping[str, Any]) -> str:
    most = 2 ** VARIABLES["N_ITER"].bits - 1
    if not isinstance(members, Sequence) or not all(isinstance(one, Mapping) for one in members) or len(members) > most:
        raise InputError(f"{where}{name}: give a list of at most {most} members, each with its values by name.")
    each = (encoded(inner, member, f"{where}{name} {number}: ", known) for number, member in enumerate(members, 1))
    return _bits("N_ITER", len(members), where) + "".join(each)


def _bits(name: str, value: object, where: str) -> str:
    try:
        return f"{require(name, value):0{variable_of(name).bits}b}"
    except InputError as error:
        raise InputError(f"{where}{error}") from error
