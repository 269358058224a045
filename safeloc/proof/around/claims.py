"""Claims about one journey: declared properties, and claims of a user's own."""

from __future__ import annotations

from dataclasses import dataclass

from safeloc.language.expr import Bool
from safeloc.language.spec import Property
from safeloc.language.system import TransitionSystem
from safeloc.language.written_claims import read_claim


@dataclass(frozen=True, eq=False)
class Asked:
    """A property and the cycles in which it is judged; `last` None: up to the end.

    there  condition that all values are there which the claim reads: in a cycle without one of them it says nothing
    """

    prop: Property
    first: int = 0
    last: int | None = None
    own: bool = False
    reads: tuple[str, ...] = ()
    there: Bool | None = None


def written_claim(system: TransitionSystem, text: str, first: int, last: int | None) -> Asked:
    """Return a claim as a property of the machine. InputError for a text that is no condition over its variables."""
    read = read_claim(system, text)
    return Asked(read.prop, first, last, own=True, reads=read.reads, there=read.there)
