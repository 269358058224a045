"""The transition table of a machine as text, for reports, pictures and notebooks."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from safeloc.language.expr import Bool, Num
from safeloc.language.render import infix
from safeloc.language.terms import Sharing

if TYPE_CHECKING:
    from safeloc.language.machine import Machine


@dataclass(frozen=True)
class Row:
    """One row of the transition table, as text."""

    name: str
    source: str
    target: str
    guard: str
    sets: tuple[str, ...]
    rank: int
    requirements: tuple[str, ...]
    declared: str


def transition_rows(machine: Machine) -> list[Row]:
    """Return the transition table in order of priority. Guards and updates are shortened, never left out."""
    rows, share = [], Sharing()
    names = {share(term): name for name, term in machine.definitions.items()}
    for t in machine.transitions:
        sets = tuple(
            f"{var.name} := {infix(share(value), 80, names) if isinstance(value, (Num, Bool)) else value}"
            for var, value in t.set.items()
        )
        sources = ", ".join(mode.label for mode in t.sources)
        file, _, line = t.src.rpartition(":")
        declared = f"{file.rpartition('/')[2]}:{line}"
        rows.append(
            Row(
                t.name,
                sources,
                t.target.label,
                infix(share(t.when), 160, names),
                sets,
                t.rank,
                t.requirements,
                declared,
            )
        )
    return rows
