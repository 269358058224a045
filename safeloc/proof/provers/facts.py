"""What is proved of a system before any property is asked, and how each piece of it is called.

Pieces are told apart by kind and by the object that they are about, never by what they are called: a lemma that somebody
names "range of x" is a lemma all the same.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

from safeloc.language.composition import contract_text
from safeloc.language.expr import NumVar
from safeloc.language.system import Part, TransitionSystem


@dataclass(frozen=True, order=True)
class Fact:
    """One piece; `of` is the variable, the lemma or the machine that it is about, each unique in its system.

    range  a state variable stays in its declared range
    lemma  a declared lemma
    heard  what a machine of a composition hears is in range
    owed   what a machine of a composition assumes of those before it
    """

    kind: Literal["range", "lemma", "heard", "owed"]
    of: str

    def __str__(self) -> str:
        match self.kind:
            case "range":
                return f"range of {self.of}"
            case "lemma":
                return self.of
            case "heard":
                return f"what {self.of} hears is in range"
            case "owed":
                return contract_text(self.of)


def range_of(var: NumVar) -> Fact:
    """That a state variable stays in its range."""
    return Fact("range", var.name)


def heard_by(part: Part) -> Fact:
    """That a machine of a composition hears no more than it may hear."""
    return Fact("heard", part.name)


def owed_to(part: Part) -> Fact:
    """That the machines before it keep what a machine of a composition assumes of them."""
    return Fact("owed", part.name)


def about(system: TransitionSystem, rule: str, **more: object) -> dict[str, str]:
    """The head of a certificate: the system it speaks of, the rule that it is a part of, and what that rule needs."""
    where = {"system": system.whole or system.name}
    if system.whole:
        where["part"] = system.machines[0].name
    return {**where, "rule": rule, **{key: str(value) for key, value in more.items()}}
