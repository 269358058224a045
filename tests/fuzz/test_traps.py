"""Each trap by itself: within so many random cases the fuzzer falls into it, unless it is mended.

A trap is a way of declaring that once led to a wrong verdict (tests.fuzz.tally.TRAPS). A helper that reads inputs is
looked at in test_found.py only: random ones were not seen to prove anything wrong in sixty machines. The numbers are those with which
it was found before it was mended, so that a mended trap is looked at with cases that would have shown it.
"""

from __future__ import annotations

import pytest

from tests.fuzz.cases import KINDS, Plan
from tests.fuzz.expect import NOW, OPEN

SEED = 1
# trap -> the kind of case that shows it, and the numbers of those that are looked at
LOOKED_AT: dict[str, tuple[str, tuple[int, ...]]] = {
    "source named twice": ("machine", (21, 42)),
    "initially over ghosts": ("machine", (6, 16)),
    "optional shared": ("back ends", (2, 5)),
    "wire reads a ghost": ("back ends", (11, 17)),
    "ghost input shared with an input": ("back ends", (20, 32)),
    "ghost shared with an input": ("composition", (19, 37)),
    "inherited over a wire": ("composition", (3, 8)),
}


def plan(trap: str) -> Plan:
    """Only this trap, and what is needed to see it."""
    return Plan(frozenset({trap}), NOW, claims=2, engines=("k-induction", "Spacer"), rarely=(), every=10**6)


def _known(trap: str) -> list[pytest.MarkDecorator]:
    return [pytest.mark.xfail(reason="not mended", strict=True)] if trap in OPEN else []


@pytest.mark.parametrize("trap", [pytest.param(trap, marks=_known(trap)) for trap in LOOKED_AT])
def test_a_trap_is_refused_or_judged_rightly(trap: str) -> None:
    """No case with the trap set disagrees."""
    kind, numbers = LOOKED_AT[trap]
    assert [] == [one for number in numbers for one in KINDS[kind](SEED, number, plan(trap)).wrong]
