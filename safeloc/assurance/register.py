"""The register of assumptions: every law that a proof of a target rests on, numbered, with its figures and whose it is.

An assessor reads it as the list of safety-related application conditions (EN 50129): what others have to see to, from which
figure and document, and how it can be checked in operation. It is made from the clauses themselves, so it is complete.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass

from pydantic import BaseModel

from safeloc.config import figures
from safeloc.language.machine import Machine
from safeloc.language.terms import text
from safeloc.language.world import Law
from safeloc.target import Target

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
    return [
        one for machine in target.machines for one in _of_machine(machine, target.config, guaranteed.get(machine, ()))
    ]


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
