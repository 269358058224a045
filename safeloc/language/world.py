"""The environment of a machine: ghosts such as the true position, and the laws that sensors and neighbours obey.

A world may read the inputs of its machine and the configuration, but nothing that the machine computes: a law that reads
the machine's state would change along with a wrong edit of the machine, and the proof could still succeed. State that no
transition sets is configuration: a figure of the site, which the proof leaves open.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Literal

from safeloc.errors import declared_at
from safeloc.language.expr import Bool, Expr, Var, all_of
from safeloc.language.first_values import Initial

Owner = Literal["", "supplier", "infrastructure", "operator", "nobody"]


@dataclass(frozen=True, eq=False)
class Law:
    """A clause with the data that an assessor needs: a safety-related application condition.

    term       the condition in each step
    statement  the law in one sentence
    figures    names of the configured figures in it, such as "marker_accuracy_mm"; the configuration has value, unit, source
    source     the origin of the law: "[S] ..." read, "[D] ..." derived, "[M] ..." from memory
    owner      the party that ensures the law: the supplier of the device, the infrastructure manager, or the operator;
               nobody if it excludes nothing: a definition, or arithmetic that solvers find slowly by themselves
    check      a way to check the law in operation: a monitor, maintenance, a type test
    shares     the reason why the term has a part in common with a term of the machine: an error in that part changes both.
               `safeloc list shared` shows each common part with this reason, or that there is none
    src        file and line of the declaration; nothing for a bare term
    """

    term: Bool
    statement: str = ""
    figures: tuple[str, ...] = ()
    source: str = ""
    owner: Owner = ""
    check: str = ""
    shares: str = ""
    src: str = field(default_factory=declared_at)


@dataclass(frozen=True, eq=False)
class World:
    """The environment of a machine: ghost variables, their moves, and the laws that sensors and neighbours obey.

    ghosts   ghost variable -> initial value
    choices  variables that the world chooses freely in each step, within their ranges; only moves and clauses read them
    moves    ghost variable -> its next value
    clauses  name -> condition in each step, over inputs, and ghosts and choices before the step. All of them together
             are the assumption of every proof. In a composition, earlier machines can guarantee a clause by its name
    reads_machine  the reason why a clause or a move reads state that the machine computes; without it this is refused
    """

    ghosts: Mapping[Var, Initial] = field(default_factory=dict)
    choices: Sequence[Var] = ()
    moves: Mapping[Var, Expr] = field(default_factory=dict)
    clauses: Mapping[str, Bool | Law] = field(default_factory=dict)
    reads_machine: str = ""

    @property
    def laws(self) -> dict[str, Law]:
        """Every clause by name, as a Law; a clause declared as a bare term has empty fields."""
        return {name: one if isinstance(one, Law) else Law(one, src="") for name, one in self.clauses.items()}

    @property
    def terms(self) -> dict[str, Bool]:
        """The term of every clause by name."""
        return {name: one.term if isinstance(one, Law) else one for name, one in self.clauses.items()}

    @property
    def assumption(self) -> Bool:
        """The conjunction of all clauses."""
        return all_of(self.terms.values())

    @property
    def variables(self) -> tuple[Var, ...]:
        """Ghosts, then choices."""
        return (*self.ghosts, *self.choices)
