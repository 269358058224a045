"""Claims of a user's own about one journey, written as text."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass

from safeloc.language.absence import stand_in_of
from safeloc.language.expr import Bool, Expr, Num, all_of
from safeloc.language.expressions import condition
from safeloc.language.spec import Property, always
from safeloc.language.system import TransitionSystem
from safeloc.proof.around.deviations import inputs_of


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
    written = condition(text, signals(system))
    there = all_of(_there(system, written.names))
    prop = always(text.strip(), there.implies(written.term), statement=text.strip())
    return Asked(prop, first, last, own=True, reads=written.names, there=there)


def signals(system: TransitionSystem) -> dict[str, Expr]:
    """Return what a claim may name: inputs, ghosts, state, outputs; of two with one name the later in this list."""
    choices = {var.name: var for var in system.inputs if var in system.ghosts}
    return {**inputs_of(system), **choices, **{var.name: var for var in system.state}, **system.outputs}


def _there(system: TransitionSystem, names: tuple[str, ...]) -> Iterator[Bool]:
    """Yield the conditions under which inputs and outputs of these names are not absent."""
    known: Mapping[str, Expr] = signals(system)
    present = {one.value: one.present for one in system.optionals}
    for name in names:
        term = known[name]
        number = stand_in_of(term) if name in system.outputs else None
        if number is not None and isinstance(term, Num):
            yield term.ne(number)
        elif term in present:
            yield present[term]  # type: ignore[index] # a key of `present` is a variable
