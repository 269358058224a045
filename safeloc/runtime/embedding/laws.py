"""The observable laws of a program's worlds, checked in each cycle by generated code (safeloc.language.observable).

In a cycle without a breach only one short condition is computed. If it fails, every law is checked by itself, with its
distance and values.

    laws = ObservableLaws(target)
    memory = laws.begin()
    breaches, memory = laws.judged(before, inputs, after, memory)

The memory holds what an observer derives from inputs, cycle by cycle, such as "a train is in the area". It is None after
missed cycles; laws that need it are then not checked.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence

from safeloc.codegen.compiled import Row, compile_rows
from safeloc.language.distance import distance
from safeloc.language.expr import Expr, NumVar, Var
from safeloc.language.nodes import Value
from safeloc.language.observable import Observable, Seen, Stated, seen
from safeloc.language.system import TransitionSystem
from safeloc.language.terms import variables
from safeloc.language.trace import shown
from safeloc.language.units import Enumeration
from safeloc.runtime.breaches import Breach, BrokenLaw, Shown

Memory = Row | None
_PRESENT = ".present"


class ObservableLaws:
    """The laws of a system that can be checked on board.

    with_ghosts  the system with its ghosts
    board   the same system without ghosts: rows are in the order of its state and inputs
    """

    def __init__(self, with_ghosts: TransitionSystem, board: TransitionSystem) -> None:
        self.seen: Seen = seen(with_ghosts)
        self._rows: Mapping[str, Sequence[Var]] = {
            "before": board.state,
            "inputs": board.inputs,
            "after": tuple(self.seen.after),
            "memory": tuple(self.seen.memory),
        }
        moves = list(self.seen.memory.values())
        self._at_once = compile_rows(self._rows, [self.seen.at_once, self.seen.recalled, *moves])
        self._judges = [
            _Judge(self.seen, one, self._rows) for one in self.seen.observables
        ]  # made now, so that no cycle has to wait for it
        self._first: Row = tuple(self.seen.first.values())

    @property
    def names(self) -> tuple[str, ...]:
        """The names of the remembered values, in the order of the memory."""
        return tuple(var.name for var in self.seen.memory)

    def begin(self) -> Memory:
        """Return the memory at the beginning of the world."""
        return self._first

    def judged(self, before: Row, inputs: Row, after: Row, memory: Memory) -> tuple[tuple[Breach, ...], Memory]:
        """Return all breaches of the cycle, and the memory after it."""
        holds, recalled, *moved = self._at_once(before, inputs, after, self._first if memory is None else memory)
        if holds and (recalled or memory is None):
            return (), memory if memory is None else tuple(moved)
        rows = {"before": before, "inputs": inputs, "after": after, "memory": memory or self._first}
        judges = [one for one in self._judges if memory is not None or not one.recalls]
        found = [breach for one in judges if (breach := one.breach(rows)) is not None]
        return tuple(found), None if memory is None else tuple(moved)


class _Judge:
    """A check of one observable condition: it finds a violation, its distance and the values that the condition read."""

    def __init__(self, around: Seen, one: Observable, rows: Mapping[str, Sequence[Var]]) -> None:
        self.recalls = around.recalls(one)
        self._laws = tuple(broken(clause) for clause in one.clauses)
        self._distance = distance(one.term)
        self._judge: Callable[..., Row] = compile_rows(rows, [one.term, self._distance.term])
        self._reads = _read_places(one.term, rows)

    def breach(self, rows: Mapping[str, Row]) -> Breach | None:
        """Return the breach in a cycle with these rows of values; None if the condition holds."""
        holds, by = self._judge(*rows.values())
        if holds:
            return None
        values = {var: rows[row][place] for var, (row, place) in self._reads.items()}
        return Breach(self._laws, self._distance.of_value(int(by)), self._distance.unit.name, read_values(values))


def broken(clause: Stated) -> BrokenLaw:
    """Return the law that a clause states, in the form that a breach uses."""
    return BrokenLaw(clause.machine.name, clause.name, clause.law.statement, clause.law.owner)


def _read_places(term: Expr, rows: Mapping[str, Sequence[Var]]) -> dict[Var, tuple[str, int]]:
    """Return, for each variable of a term, the name of its row and the place in that row."""
    read = set(variables([term]))
    return {var: (name, place) for name, row in rows.items() for place, var in enumerate(row) if var in read}


def read_values(values: Mapping[Var, Value]) -> dict[str, Shown]:
    """Return values by name, enumerations by label, None for absent inputs; presence flags are left out."""
    by_name = {var.name: _shown(var, value) for var, value in values.items()}
    absent = {name.removesuffix(_PRESENT) for name, value in by_name.items() if name.endswith(_PRESENT) and not value}
    return {name: None if name in absent else value for name, value in by_name.items() if not name.endswith(_PRESENT)}


def _shown(var: Var, value: Value) -> Shown:
    return shown(var, value) if isinstance(var, NumVar) and isinstance(var.unit, Enumeration) else value
