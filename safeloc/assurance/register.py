"""The register of assumptions: every law that a proof of a target rests on, numbered, with its figures and whose it is.

An assessor reads it as the list of safety-related application conditions (EN 50129): what others have to see to, from which
figure and document, and how it can be checked in operation. It is made from the clauses themselves, so it is complete.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace
from typing import Any, Literal

from pydantic import BaseModel

from safeloc.config import figures
from safeloc.language.machine import Machine
from safeloc.language.observable import seen
from safeloc.language.terms import text
from safeloc.language.world import Law
from safeloc.runtime.source_clocks import BORDER, LAW, ONE_CLOCK
from safeloc.target import Target

Observed = Literal["whole", "part", "no"]
CLOCK_TERM = "(< lag_ms period_ms)"
FROM_MEMORY = "[M]"
"""What the source of a figure begins with that nobody has read anywhere."""


@dataclass(frozen=True)
class Figure:
    """A configured figure that a law uses: its place in the configuration, value, unit and source."""

    name: str
    value: str
    unit: str
    source: str

    @property
    def to_confirm(self) -> bool:
        """The operator has to confirm it: it is an engineering default."""
        return self.source.startswith(FROM_MEMORY)


@dataclass(frozen=True)
class Assumption:
    """One law of a machine's world.

    id          machine and number in the order of declaration, such as "odometry/A3"
    guaranteed  another machine of the target guarantees it, and that is proved: nobody else has to see to it
    observable  whether inputs and state show a breach in operation: of all that it says, or of a part of it
    against     laws of which they show that these and this one cannot both hold
    """

    id: str
    machine: str
    name: str
    statement: str
    term: str
    figures: tuple[Figure, ...]
    source: str
    owner: str
    check: str
    guaranteed: bool
    observable: Observed = "no"
    against: tuple[str, ...] = ()

    @property
    def monitored(self) -> str:
        """How far a breach shows in operation, in words."""
        alone = {"whole": "as a whole", "part": "in part"}.get(self.observable, "")
        beside = f"against {', '.join(self.against)}" if self.against else ""
        return "; ".join(part for part in (alone, beside) if part) or "no: only with the truth"

    @property
    def lacks(self) -> tuple[str, ...]:
        """The fields that an assessor needs and that are empty."""
        asked = {"statement": self.statement, "source": self.source, "owner": self.owner, "check": self.check}
        if self.owner == "nobody":
            del asked["check"]
        return tuple(name for name, said in asked.items() if not said)


def register(target: Target) -> list[Assumption]:
    """Return every law of every machine of the target, in order."""
    guaranteed = {part.machine: part.guaranteed for part in target.system.parts}
    observed = _observed(target)
    return [
        replace(one, **observed[machine, one.name])
        for machine in target.machines
        for one in _of_machine(machine, target.config, guaranteed.get(machine, ()))
    ]


def of_border() -> Assumption:
    """Return the law that every target rests on when it is run on records: they are of the cycle that their time says."""
    said = BORDER, ONE_CLOCK, LAW.statement, CLOCK_TERM, (), LAW.source, LAW.owner, LAW.check
    return Assumption(f"{BORDER}/B1", *said, guaranteed=False, observable="whole")


def _observed(target: Target) -> dict[tuple[Machine, str], dict[str, Any]]:
    """Machine and name of a law -> what is observable of it."""
    around = seen(target.system)
    told: dict[tuple[Machine, str], dict[str, Any]] = {}
    for clause in around.stated:
        found = around.of(clause)
        alone = [one for one in found if len(one.clauses) == 1]
        against = tuple(str(other) for one in found for other in one.clauses if other is not clause)
        observable: Observed = "no" if not alone else "whole" if alone[0].is_whole else "part"
        told[clause.machine, clause.name] = {"observable": observable, "against": against}
    return told


def to_confirm(targets: Iterable[Target]) -> dict[str, Figure]:
    """Return every configured figure of the targets that is from memory, by machine and name."""
    return {
        f"{target.name}.{one.name}": one
        for target in targets
        if target.config is not None
        for one in _figures(target.config)
        if one.to_confirm
    }


def _of_machine(machine: Machine, config: BaseModel | None, guaranteed: tuple[str, ...]) -> Iterator[Assumption]:
    for number, (name, law) in enumerate(machine.world.laws.items(), 1):
        yield Assumption(
            f"{machine.name}/A{number}",
            machine.name,
            name,
            law.statement,
            text(law.term),
            tuple(_figures_of(law, machine.name, config)),
            law.source,
            law.owner,
            law.check,
            name in guaranteed,
        )


def _figures(config: BaseModel) -> list[Figure]:
    return [Figure(**one) for one in figures(config)]


def _figures_of(law: Law, machine: str, config: BaseModel | None) -> Iterator[Figure]:
    """The figures that the law names; where several parts of a configuration have one of that name, the machine's own."""
    every = [] if config is None else _figures(config)
    for name in law.figures:
        found = [one for one in every if one.name == name or one.name.endswith(f".{name}")]
        own = [one for one in found if machine in one.name.split(".")]
        yield from own or found or [Figure(name, "", "", "not found in the configuration")]
