"""Claims written as text: the names that a text may use, the condition that it states, and when it says nothing."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass

from safeloc.language.absence import stand_in_of
from safeloc.language.expr import Bool, Expr, Num, Var, all_of
from safeloc.language.expressions import condition
from safeloc.language.spec import Property, always
from safeloc.language.system import TransitionSystem


@dataclass(frozen=True, eq=False)
class WrittenClaim:
    """A claim that was read from text.

    reads  the names in it
    there  condition that all values are there which it reads: in a cycle without one of them it says nothing
    """

    prop: Property
    reads: tuple[str, ...]
    there: Bool


def read_claim(system: TransitionSystem, text: str) -> WrittenClaim:
    """Return a claim as a property of the system. InputError for a text that is no condition over its variables."""
    written = condition(text, signals(system))
    there = all_of(_there(system, written.names))
    prop = always(text.strip(), there.implies(written.term), statement=text.strip())
    return WrittenClaim(prop, written.names, there)


def inputs_of(system: TransitionSystem) -> dict[str, Var]:
    """Return the inputs on board by name, without presence flags."""
    flags = {option.present for option in system.optionals}
    return {var.name: var for var in system.inputs if var not in flags and var not in system.ghosts}


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
