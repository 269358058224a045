"""The facts that are proved of a system before any property, and their keys.

A fact is identified by its kind and its object, never by a name: a lemma with the name "range of x" is still a lemma.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

from safeloc.language.composed_names import contract_text, inputs_text
from safeloc.language.expr import NumVar
from safeloc.language.system import Part, TransitionSystem


@dataclass(frozen=True, order=True)
class Fact:
    """One fact; `of` names the variable, lemma or machine that it is about, each unique in its system.

    range     a state variable stays in its declared range
    lemma     a declared lemma
    wires     the wired inputs of a machine of a composition are in range
    contract  the contract of a machine of a composition: its discharged assumption holds
    """

    kind: Literal["range", "lemma", "wires", "contract"]
    of: str

    def __str__(self) -> str:
        match self.kind:
            case "range":
                return f"range of {self.of}"
            case "lemma":
                return self.of
            case "wires":
                return inputs_text(self.of)
            case "contract":
                return contract_text(self.of)


def range_of(var: NumVar) -> Fact:
    """Return the key of the fact that a state variable stays in its range."""
    return Fact("range", var.name)


def inputs_of(part: Part) -> Fact:
    """Return the key of the fact that the wired inputs of a machine stay in their ranges."""
    return Fact("wires", part.name)


def contract_of(part: Part) -> Fact:
    """Return the key of the fact that earlier machines guarantee the discharged assumption of a machine."""
    return Fact("contract", part.name)


def about(system: TransitionSystem, rule: str, **more: object) -> dict[str, str]:
    """Return the header of a certificate: its system, the proof rule that it belongs to, and the data that this rule
    needs.
    """
    where = {"system": system.composition or system.name}
    if system.composition:
        where["part"] = system.machines[0].name
    return {**where, "rule": rule, **{key: str(value) for key, value in more.items()}}
