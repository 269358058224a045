"""What tests of composed devices ask: whether a contract or a claim is kept, what a recording shows, and which input of a machine is meant."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from types import ModuleType
from typing import Any

import pytest

from safeloc.catalogue import load_target
from safeloc.language.composition import Composition
from safeloc.language.expr import Bool, Expr, Var
from safeloc.language.machine import Machine
from safeloc.language.spec import Property
from safeloc.language.trace import Trace
from safeloc.language.units import NM_PER_MM
from safeloc.proof.provers.implication import Refuted
from safeloc.proof.provers.replayed_evidence import admissible_run
from safeloc.runtime.streams.steps import read_steps
from tests.models.inductive import inductive_in
from tests.models.owed_contracts import Wires, contract, rewired
from tests.shipped_recordings import shipped


def holds(whole: Composition, claims: Iterable[Property], claim: str) -> bool:
    """Whether `contract of MACHINE` follows, or a claim of the whole is inductive with the lemmas."""
    if claim.startswith("contract of "):
        return contract(whole, claim.removeprefix("contract of ")) is None
    [prop] = [one for one in claims if one.name == claim]
    return inductive_in(whole.system, prop, claim)


Wrong = Callable[[Any, Wires], Wires]
"""The wires that are wrong, of the device and of its right wires."""


@dataclass(frozen=True)
class Wiring:
    """A device, and the claims that are asked of it: the right wires keep what the wrong ones lose.

    module  composes the device: `compose_machines`
    claims  the claims of a device
    """

    module: ModuleType
    claims: Callable[[Any], Sequence[Property]]

    def loses(self, wrong: Wrong, claim: str, monkeypatch: pytest.MonkeyPatch) -> bool:
        """Whether the claim, or the contract, is not kept with wrong wires."""
        whole = rewired(self.module, self.module.compose_machines, wrong, monkeypatch)
        return not holds(whole.composition, self.claims(whole), claim)

    def keeps(self, claim: str) -> bool:
        """Whether the device as it is keeps the claim, or the contract."""
        whole = self.module.compose_machines()
        return holds(whole.composition, self.claims(whole), claim)

    def owes(self, owner: str, *lemmas: str) -> bool:
        """Whether a machine's contract follows from the machines before it, and not without these lemmas of them."""
        whole = self.module.compose_machines().composition
        return contract(whole, owner) is None and isinstance(contract(whole, owner, *lemmas), Refuted)


def flag(term: Expr) -> Bool:
    """The term, which is a condition."""
    assert isinstance(term, Bool)
    return term


def input_of(machine: Machine, name: str) -> Var:
    """An input of a machine, by its name."""
    [found] = [var for var in machine.inputs if isinstance(var, Var) and var.name == name]
    return found


@cache
def recorded(recording: str) -> Trace:
    """A shipped recording, refused in the first step that breaks what is assumed."""
    stream = read_steps(shipped(recording))
    return admissible_run(load_target(recording.partition("-")[0]).system, dict(stream.first), stream.steps)


class Runs:
    """The shipped recordings of a device, by the ends of their names."""

    def __init__(self, device: str) -> None:
        self._device = device

    def recorded(self, name: str) -> Trace:
        """A recording, run again."""
        return recorded(f"{self._device}-{name}")

    def fired(self, name: str, machine: str, *transitions: str) -> list[int]:
        """The cycles of a recording in which a machine took one of the transitions."""
        steps = self.recorded(name).steps
        return [at for at, one in enumerate(steps) if one.fired[f"{machine}.fired"] in transitions]

    def are_written(self, write: Callable[[Path], list[Path]], folder: Path) -> bool:
        """Whether the shipped recordings are those that the simulation writes, to the byte."""
        return all(
            shipped(one.name.removesuffix(".jsonl.gz")).read_bytes() == one.read_bytes() for one in write(folder)
        )

    def located(self, name: str) -> int:
        """In how many cycles the host has an interval; it holds the truth in each, and every law is obeyed to the end of the recording."""
        target, trace = load_target(self._device), self.recorded(name)
        assert len(trace.steps) == len(read_steps(shipped(f"{self._device}-{name}")).steps)
        found = 0
        for one in trace.steps:
            interval = target.reported.interval_mm(one.outputs) if target.reported else None
            if interval is not None:
                found += 1
                assert interval[0] * NM_PER_MM <= int(one.state["truth_nm"]) <= interval[1] * NM_PER_MM
        return found
