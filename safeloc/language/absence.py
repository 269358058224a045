"""Outputs that are absent in some states: a number that no variable holds stands in for them.

In C, in FMI and in arrays some number has to be there. It is one that does no harm to a reader who forgets to ask whether
there is a value: as a place it is none, as a bound it is beyond every limit, and both together are an interval that
holds everything. Python reports, lines and pages say that the value is absent (`without_absent`).
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
"""Stands in for a place: in mm two million kilometres off, and still within 64 bits in nm."""
NO_BOUND: Final = 4_000_000_000_000
"""Stands in for a bound: greater than any that is tolerable, and twice as great as `NO_PLACE` is far off."""
STAND_INS = (NO_PLACE, NO_BOUND)


def shown_if(present: Bool, term: Num, stand_in: int) -> Num:
    """Return an output that has the value of `term` while `present`, and is absent otherwise.

    ModelError where the stand-in is none, or where the term could have its value.
    """
    if stand_in not in STAND_INS:
        raise ModelError(f"{declared_at()}: {stand_in} stands in for nothing; take one of {list(STAND_INS)}.")
    low, high = bounds([term])[term]
    if low <= stand_in <= high:
        raise ModelError(
            f"{declared_at()}: {stand_in} stands in for an absent output, and this one may have that value "
            f"({low}..{high}); narrow the ranges of what it is made of."
        )
    return ite(present, term, stand_in)


def heard(output: Num) -> Num:
    """Return an output for a wire: 0 while it is absent, since no input has a range that reaches to a stand-in."""
    if stand_in_of(output) is None:
        return output
    return ite(output.condition, output.then, 0) if isinstance(output, Choose) else as_num(0, output.unit)


def while_there(output: Num) -> Num:
    """Return the term whose value the output has while it is there."""
    return output.then if isinstance(output, Choose) and stand_in_of(output) is not None else output


def stand_in_of(output: Expr) -> int | None:
    """Return the number that stands in for this output while it is absent; None for one that is always there."""
    other = output.other if isinstance(output, Choose) else output
    return other.value if isinstance(other, Lit) and other.value in STAND_INS else None


_FOUND: weakref.WeakKeyDictionary[TransitionSystem, Mapping[str, int]] = weakref.WeakKeyDictionary()


def stand_ins(system: TransitionSystem) -> Mapping[str, int]:
    """Return the outputs that may be absent, each with the number that stands in for it."""
    if system not in _FOUND:
        _FOUND[system] = _stand_ins(system)
    return _FOUND[system]


def _stand_ins(system: TransitionSystem) -> dict[str, int]:
    found = {name: stand_in_of(term) for name, term in system.outputs.items()}
    return {name: number for name, number in found.items() if number is not None}


def without_absent(outputs: Mapping[str, Value], numbers: Mapping[str, int]) -> dict[str, Value | None]:
    """Return outputs with None for those that are absent; `numbers` as `stand_ins` finds them."""
    told: dict[str, Value | None] = dict(outputs)
    for name, number in numbers.items():
        if told[name] == number:
            told[name] = None
    return told
