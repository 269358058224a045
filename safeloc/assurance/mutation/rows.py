"""Wrong rows: an update skipped, another target, another order; and guards, updates and outputs that are a single operand."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise

from safeloc.assurance.mutation.declared import remade
from safeloc.assurance.mutation.kinds import CONDITION, SIGN, Change, Others, of_operand
from safeloc.assurance.source_places import shown
from safeloc.language.expr import FALSE, TRUE, Expr, Var, as_bool, as_num
from safeloc.language.machine import Machine, Transition
from safeloc.language.nodes import BoolVar, NumVar, Value
from safeloc.language.render import infix
from safeloc.language.terms import children

_SKIPPED = "update skipped"
_TARGET = "target changed"
_ORDER = "order of rows changed"


@dataclass(frozen=True, eq=False)
class RowEdit:
    """One wrong row or output: its description, its place, and a function that makes the machine with it."""

    kind: str
    words: str
    place: str
    term: str
    becomes: str
    where: tuple[str, ...]
    requirements: tuple[str, ...]
    make: Callable[[], Machine]


def row_edits(machine: Machine, others: Others) -> Iterator[RowEdit]:
    """Return all edits: row by row, then exchanges of rows, then outputs."""
    for number, row in enumerate(machine.transitions):
        for kind, words, was, now, changed in _changed(machine, row, others):
            make = _replacing(machine, number, changed)
            yield RowEdit(kind, words, shown(row.src), was, now, (f"row {row.name!r}",), row.requirements, make)
    yield from _exchanged(machine)
    yield from _of_outputs(machine, others)


_Edited = tuple[str, str, str, str, Transition]
"""Kind, description, original and replacement as text, and the changed row."""


def _replacing(machine: Machine, number: int, row: Transition) -> Callable[[], Machine]:
    rows = [*machine.transitions[:number], row, *machine.transitions[number + 1 :]]
    return lambda: remade(machine, transitions=rows)


def _changed(machine: Machine, row: Transition, others: Others) -> Iterator[_Edited]:
    yield from _guarded(row, others)
    yield from _updated(row, others)
    yield from _aimed(machine, row)


def _guarded(row: Transition, others: Others) -> Iterator[_Edited]:
    original = infix(row.when)
    if row.when is not TRUE:
        yield CONDITION, "always enabled", original, "true", replace(row, when=TRUE)
    yield CONDITION, "never enabled", original, "false", replace(row, when=FALSE)
    if not children(row.when):
        for change in of_operand(row.when, others):
            now = as_bool(change.make((row.when,)))  # type: ignore[arg-type] # a flag becomes a truth value
            yield change.kind, change.words, original, infix(now), replace(row, when=now)


def _updated(row: Transition, others: Others) -> Iterator[_Edited]:
    for var, value in row.set.items():
        original = f"{var.name} := {_text(var, value)}"
        yield _SKIPPED, f"{var.name} keeps its value", original, "", replace(row, set=_but(row.set, var))
        for change, now in _other_values(var, value, others):
            words = f"{var.name} := {_text(var, now)}"
            yield change.kind, change.words, original, words, replace(row, set={**row.set, var: now})


def _but(updates: Mapping[Var, Expr | Value], left_out: Var) -> dict[Var, Expr | Value]:
    return {var: value for var, value in updates.items() if var is not left_out}


def _other_values(var: Var, value: Expr | Value, others: Others) -> Iterator[tuple[Change, Expr]]:
    """Return other values of an update with a constant or a variable; terms with parts are changed elsewhere."""
    term = _term(var, value)
    if not children(term):
        if isinstance(var, BoolVar):
            yield Change(SIGN, "turned", lambda parts: parts[0]), ~as_bool(term)  # type: ignore[arg-type] # of a flag
        for change in of_operand(term, others):
            yield change, change.make((term,))


def _term(var: Var, value: Expr | Value) -> Expr:
    if isinstance(value, Expr):
        return value
    return as_num(value, var.unit) if isinstance(var, NumVar) else as_bool(bool(value))


def _text(var: Var, value: Expr | Value) -> str:
    return infix(_term(var, value))


def _aimed(machine: Machine, row: Transition) -> Iterator[_Edited]:
    """Return the row with the next declared mode as its target, and, if it leaves one mode only, with that mode."""
    following = machine.modes[(row.target.value + 1) % len(machine.modes)]
    for target in dict.fromkeys([following, *(row.sources if len(row.sources) == 1 else ())]):
        if target is not row.target:
            original, now = row.target.label, target.label
            yield _TARGET, f"to {now} instead of {original}", original, now, replace(row, target=target)


def _exchanged(machine: Machine) -> Iterator[RowEdit]:
    """Return exchanges of neighbouring rows with a common source mode; those of equal rank have no order to exchange."""
    for number, (first, second) in enumerate(pairwise(machine.transitions)):
        if first.rank != second.rank and set(first.sources) & set(second.sources):
            ranks = replace(second, rank=first.rank), replace(first, rank=second.rank)
            rows = [*machine.transitions[:number], *ranks, *machine.transitions[number + 2 :]]
            words = f"{second.name!r} before {first.name!r}"
            where = (f"row {first.name!r}", f"row {second.name!r}")
            asked = tuple(dict.fromkeys((*first.requirements, *second.requirements)))
            yield RowEdit(
                _ORDER,
                words,
                shown(first.src),
                f"{first.name!r} before {second.name!r}",
                words,
                where,
                asked,
                _with(machine, rows),
            )


def _with(machine: Machine, rows: Sequence[Transition]) -> Callable[[], Machine]:
    return lambda: remade(machine, transitions=rows)


def _of_outputs(machine: Machine, others: Others) -> Iterator[RowEdit]:
    """Return the changes of outputs that are a single variable or constant."""
    for name, term in machine.outputs.items():
        if not children(term):
            for change in of_operand(term, others):
                now = change.make((term,))
                make = _with_output(machine, name, now)
                yield RowEdit(
                    change.kind,
                    change.words,
                    shown(machine.src),
                    infix(term),
                    infix(now),
                    (f"output {name}",),
                    (),
                    make,
                )


def _with_output(machine: Machine, name: str, now: Expr) -> Callable[[], Machine]:
    return lambda: remade(machine, outputs={**machine.outputs, name: now})
