"""Outputs that are absent in some states: a stand-in number, which no present output can have, represents the absence.

C, FMI and arrays need a number in every field. The stand-ins are harmless to a reader who forgets to check for absence:
as a place the number lies off every line, as a bound it exceeds every limit, and both together give an interval that
contains everything. Reports, lines and pages written in Python show the value as absent (`without_absent`).
"""

from __future__ import annotations

import weakref
from collections.abc import Mapping
from typing import Final

from safeloc.errors import ModelError, declared_at
from safeloc.language.expr import Bool, Expr, Lit, Num, as_num, ite
from safeloc.language.nodes import Choose, Value
from safeloc.language.ranges import bounds
from safeloc.language.system import TransitionSystem

NO_PLACE: Final = -2_000_000_000_000
"""Stand-in for a place: two million kilometres away in mm, and in nm still within 64 bits."""
NO_BOUND: Final = 4_000_000_000_000
"""Stand-in for a bound: greater than every tolerable one, and twice the magnitude of `NO_PLACE`."""
_STAND_INS = (NO_PLACE, NO_BOUND)


def shown_if(present: Bool, term: Num, stand_in: int) -> Num:
    """Return an output that has the value of `term` while `present`, and is absent otherwise.

    Raises ModelError if `stand_in` is no known stand-in, or if the term could have this value itself.
    """
    if stand_in not in _STAND_INS:
        raise ModelError(f"{declared_at()}: {stand_in} is no stand-in number; use one of {list(_STAND_INS)}.")
    low, high = bounds([term])[term]
    if low <= stand_in <= high:
        raise ModelError(
            f"{declared_at()}: {stand_in} stands in for an absent output, but this output may have that value itself "
            f"({low}..{high}); narrow the ranges of the variables it reads."
        )
    return ite(present, term, stand_in)


def zero_while_absent(output: Num) -> Num:
    """Return the term that a wire carries for an output: 0 while it is absent, since no input's range includes a stand-in."""
    if stand_in_of(output) is None:
        return output
    return ite(output.condition, output.then, 0) if isinstance(output, Choose) else as_num(0, output.unit)


def value_while_present(output: Num) -> Num:
    """Return the term that gives the output its value while it is present."""
    return output.then if isinstance(output, Choose) and stand_in_of(output) is not None else output


def stand_in_of(output: Expr) -> int | None:
    """Return the number that stands in for this output while it is absent; None for an output that is always present."""
    other = output.other if isinstance(output, Choose) else output
    return other.value if isinstance(other, Lit) and other.value in _STAND_INS else None


_FOUND: weakref.WeakKeyDictionary[TransitionSystem, Mapping[str, int]] = weakref.WeakKeyDictionary()


def stand_ins(system: TransitionSystem) -> Mapping[str, int]:
    """Return the stand-in number of each output that may be absent, by the output's name."""
    if system not in _FOUND:
        _FOUND[system] = _stand_ins(system)
    return _FOUND[system]


def _stand_ins(system: TransitionSystem) -> dict[str, int]:
    found = {name: stand_in_of(term) for name, term in system.outputs.items()}
    return {name: number for name, number in found.items() if number is not None}


def without_absent(outputs: Mapping[str, Value], numbers: Mapping[str, int]) -> dict[str, Value | None]:
    """Return the outputs, with None for each absent one; `numbers` is the result of `stand_ins`."""
    values: dict[str, Value | None] = dict(outputs)
    for name, number in numbers.items():
        if values[name] == number:
            values[name] = None
    return values
