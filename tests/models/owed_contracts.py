"""Whether what one machine of a composition assumes of earlier ones follows from what is proved of them, also with wrong wires."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from types import ModuleType
from typing import Any, TypeVar

import pytest

from safeloc.codegen.smtlib import Query
from safeloc.language.composition import Composition, compose
from safeloc.language.expr import Expr, Var
from safeloc.language.system import environment, in_range
from safeloc.language.terms import Substitution
from safeloc.proof.provers.implication import Failure, unproved
from safeloc.proof.provers.inherited import contracts

Wires = Mapping[Var, Expr]
Device = TypeVar("Device", bound=Any)
"""A composition with its machines: a dataclass with the field `composition`."""


def contract(whole: Composition, owner: str, *without: str) -> Failure | None:
    """None if the contract of `owner` follows in one step from the laws of the world and the lemmas of the machines before it, except some."""
    system = whole.system
    names = [part.name for part in system.parts]
    after = Substitution(dict(system.next))
    earlier = tuple(f"{name}: " for name in names[: names.index(owner)])
    lemmas = [term for name, term in system.lemmas.items() if name.startswith(earlier) and name not in without]
    given = [environment(system), in_range(system.state), *lemmas, *(after.bool(one) for one in lemmas)]
    [owed] = [term for fact, term in contracts(system).items() if str(fact) == f"contract of {owner} holds"]
    return unproved(Query("contract", given, {"owed": owed}), 120).get("owed")


def rewired(
    module: ModuleType,
    make: Callable[[], Device],
    wrong: Callable[[Device, Wires], Wires],
    monkeypatch: pytest.MonkeyPatch,
) -> Device:
    """Return the device that `make` of that module composes, with some wires replaced."""
    given: list[tuple[str, list[Any], Wires, dict[str, Any]]] = []

    def noted(name: str, machines: list[Any], wires: Wires, **others: Any) -> Composition:
        given.append((name, machines, wires, others))
        return compose(name, machines, wires, **others)

    monkeypatch.setattr(module, "compose", noted)
    whole = make()
    [(name, machines, wires, others)] = given
    made: Device = replace(whole, composition=compose(name, machines, {**wires, **wrong(whole, wires)}, **others))
    return made
