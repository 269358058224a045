"""The transition table of a machine: its modes, and the transitions between them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Final

from safeloc.errors import ModelError, declared_at, named_at
from safeloc.language.expr import TRUE, Bool, Expr, Lit, NumVar, Var, members
from safeloc.language.nodes import Value
from safeloc.language.renamed import check_keywords
from safeloc.language.units import Enumeration

STAY_NAME: Final = "(stay)"


@check_keywords(ModelError, {"trace": "requirements"})
@dataclass(frozen=True, eq=False)
class Transition:
    """One row of the transition table.

    Guards of transitions with the same source mode and `rank` must be disjoint (an obligation proves it); of different
    ranks the lower comes first. `requirements` holds the ids of the requirements that the transition implements.
    """

    name: str
    source: Lit | tuple[Lit, ...]
    target: Lit
    when: Bool = TRUE
    set: Mapping[Var, Expr | Value] = field(default_factory=dict)
    requirements: tuple[str, ...] = ()
    rank: int = 0
    src: str = field(default_factory=named_at)

    @property
    def sources(self) -> tuple[Lit, ...]:
        """The source modes, always as a tuple."""
        return (self.source,) if isinstance(self.source, Lit) else self.source


@dataclass(frozen=True, slots=True)
class Modes(Enumeration):
    """The modes of a machine, with the one variable that holds the current mode."""

    current: NumVar = field(init=False, repr=False, compare=False)

    def __post_init__(self) -> None:
        current = NumVar(self.name, self, 0, len(self.members) - 1, None, declared_at())
        object.__setattr__(self, "current", current)


def modes(*labels: str) -> tuple[Lit, ...]:
    """Create the modes of a machine, as constants for its transitions; the first one is the initial mode.

    They include the variable of the current mode, see `current_mode`. ModelError if two labels are equal.
    """
    constants, table = members("mode", *labels), Modes("mode", labels)
    return tuple(Lit(constant.value, table) for constant in constants)


def current_mode(modes_: Sequence[Lit]) -> NumVar:
    """Return the mode variable of the machine with these modes, also before it is built; ModelError for other constants."""
    table = modes_[0].unit
    if not isinstance(table, Modes):
        raise ModelError(f"{declared_at()}: {modes_[0].label} is no mode; make modes with modes(...).")
    return table.current
