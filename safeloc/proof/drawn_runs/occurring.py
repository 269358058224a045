"""Count, at little cost, the cases of properties that occur in the steps of a driven run.

A case is evaluated from the values of one step: state before and after, inputs, transitions fired. Only cases that look
further back need variables of their own, which are updated with the system.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from itertools import compress

from safeloc.codegen.compiled import Row
from safeloc.language.antecedents import cases, of_states, seen
from safeloc.language.expr import Bool, Expr, Var
from safeloc.language.machine import Initial
from safeloc.language.nodes import Past, Value
from safeloc.language.spec import Property
from safeloc.language.system import TransitionSystem
from safeloc.language.terms import in_order, variables
from safeloc.proof.drawn_runs.allowed import compiled_terms

Key = tuple[int, int]
"""Number of the property, and of its case."""


class Occurring:
    """The cases of some properties; the system that runs has `moves` and `initial` as additional state, after `state`."""

    def __init__(self, system: TransitionSystem, state: Sequence[Var], properties: Sequence[Property]) -> None:
        self.moves: dict[Var, Expr] = {}
        self.initial: dict[Var, Initial] = {}
        terms: dict[Key, Bool] = {}
        first: dict[Key, Bool] = {}
        for number, prop in enumerate(properties):
            states = of_states(system, prop)
            for place, one in enumerate(cases(prop)):
                terms[number, place] = one.term
                if states:
                    first[number, place] = one.term
                elif any(isinstance(node, Past) for node in in_order([one.term])):
                    remembered = seen(system, one, f"case {len(terms)}")
                    self.moves |= remembered.moves
                    self.initial |= remembered.initial
                    terms[number, place] = remembered.term
        kept = (*state, *self.moves)
        self._first = _Judge(first, kept, (), ())
        self._later = _Judge(terms, kept, system.inputs, tuple(system.fired))

    def at_first(self, state: Row) -> Iterator[Key]:
        """Yield the cases that occur in the first state, for properties of states."""
        return self._first(state, state, (), ())

    def after(self, before: Row, inputs: Row, state: Row, fired: Row) -> Iterator[Key]:
        """Yield the cases that occur in a step."""
        return self._later(before, state, inputs, fired)


class _Judge:
    """Terms compiled over the rows of a step; `kept` names the first columns of its states."""

    def __init__(
        self, terms: Mapping[Key, Bool], kept: Sequence[Var], inputs: Sequence[Var], fired: Sequence[Var]
    ) -> None:
        self._keys = tuple(terms)
        read = variables(terms.values())
        now = {
            var: (row, column)
            for row, columns in enumerate((kept, inputs, fired), 1)
            for column, var in enumerate(columns)
        }
        self._from = [now[var] if var.before is None else (0, now[var.before][1]) for var in read]
        self._compute: Callable[[Sequence[Value]], Sequence[Value]] = compiled_terms(tuple(read), list(terms.values()))

    def __call__(self, *rows: Row) -> Iterator[Key]:
        """Yield the keys of the terms that hold; rows are state before, state after, inputs and transitions fired."""
        return compress(self._keys, self._compute([rows[row][column] for row, column in self._from]))
