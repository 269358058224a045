"""The register of assumptions: every law that the proofs of a target assume, numbered, with figures, source and owner.

For an assessor it is the list of safety-related application conditions (EN 50129): what others have to ensure, with figures
and documents, and how it can be checked in operation. It is made from the clauses themselves, so it is complete.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any, Literal

from pydantic import BaseModel

from safeloc.assurance.law_figures import Figure, ToConfirm, configured_figures, figures_of, to_confirm
from safeloc.assurance.law_ids import ids_of
from safeloc.language.machine import Machine
from safeloc.language.observable import seen
from safeloc.language.terms import text
from safeloc.proof.cores.clauses import ClauseId
from safeloc.runtime.source_clocks import BORDER, LAW, ONE_CLOCK
from safeloc.target import Target

Observed = Literal["whole", "part", "no"]
_CLOCK_TERM = "(< lag_ms period_ms)"
UNSEEN = "no: only with the truth"
NOBODY = "nobody"
"""Owner of a law that excludes nothing: it is true by definition or by arithmetic."""


@dataclass(frozen=True)
class Assumption:
    """One law of a machine's world.

    id          of the law in every report (safeloc.assurance.law_ids), such as "odometry/A3"
    guaranteed  it is proved that another machine of the target guarantees it, so nobody else has to ensure it
    observable  whether inputs and state show a breach in operation: of the whole law, of a part of it, or not at all
    against     laws for which inputs and state can show that they and this law do not both hold
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
        """Return in words how far a breach is visible in operation."""
        alone = {"whole": "as a whole", "part": "in part"}.get(self.observable, "")
        beside = f"against {', '.join(self.against)}" if self.against else ""
        return "; ".join(part for part in (alone, beside) if part) or UNSEEN

    @property
    def lacks(self) -> tuple[str, ...]:
        """Return the names of fields that an assessor needs and that are empty."""
        asked = {"statement": self.statement, "source": self.source, "owner": self.owner, "check": self.check}
        if self.owner == NOBODY:
            del asked["check"]
        return tuple(name for name, words in asked.items() if not words)


def register(target: Target) -> list[Assumption]:
    """Return every law of every machine of the target, in order."""
    guaranteed = {part.machine: part.guaranteed for part in target.system.parts}
    observed, ids, figures = _observed(target), ids_of(target), configured_figures(target.config)
    return [
        replace(one, id=ids[ClauseId(machine.name, one.name)], **observed[machine, one.name])
        for machine in target.machines
        for one in _of_machine(
            machine, target.sections.get(machine.name, machine.name), figures, guaranteed.get(machine, ())
        )
    ]


@dataclass(frozen=True)
class Listed:
    """An assumption of several targets, once.

    targets     that rest on it
    guaranteed  those of them in which another machine is proved to guarantee it
    monitored   words on how far a breach shows in operation -> the targets of which they are true
    """

    one: Assumption
    targets: tuple[str, ...]
    guaranteed: tuple[str, ...]
    monitored: Mapping[str, tuple[str, ...]]

    @property
    def is_left_to_others(self) -> bool:
        """Return whether at least one target has no machine that guarantees it."""
        return self.targets != self.guaranteed


@dataclass(frozen=True)
class Register:
    """The assumptions of several targets, each once, and the figures that the operator has to confirm."""

    rows: Sequence[Listed]
    to_confirm: Sequence[ToConfirm]

    @property
    def observable(self) -> int:
        """The number of those left to others of which a breach shows in operation, at least partly or against another one."""
        return sum(row.is_left_to_others and any(words != UNSEEN for words in row.monitored) for row in self.rows)

    @property
    def left_to_others(self) -> int:
        """The number of assumptions that no machine guarantees in at least one target, as a report counts its conditions."""
        return sum(row.is_left_to_others for row in self.rows)


def register_of(targets: Sequence[Target], other_kinds: Mapping[str, BaseModel] | None = None) -> Register:
    """Return the register of these targets, with the assumption of every target that runs on records at its end.

    other_kinds  configurations with sources of their own, by machine and name: their figures have to be confirmed as well
    """
    found: dict[str, list[tuple[str, Assumption]]] = {}
    for target in targets:
        for one in register(target):
            found.setdefault(one.id, []).append((target.name, one))
    border = of_border()
    found[border.id] = [("every target on records", border)]
    return Register([_listed(every) for every in found.values()], figures_to_confirm(targets, other_kinds))


def _listed(every: Sequence[tuple[str, Assumption]]) -> Listed:
    """Return one assumption with all targets that have it."""
    monitored: dict[str, list[str]] = {}
    for target, one in every:
        monitored.setdefault(one.monitored, []).append(target)
    guaranteed = tuple(target for target, one in every if one.guaranteed)
    seen = {words: tuple(of) for words, of in monitored.items()}
    return Listed(every[0][1], tuple(target for target, _ in every), guaranteed, seen)


def of_border() -> Assumption:
    """Return the assumption of every target that runs on records: a record belongs to the cycle of its time stamp."""
    fields = BORDER, ONE_CLOCK, LAW.statement, _CLOCK_TERM, (), LAW.source, LAW.owner, LAW.check
    return Assumption(f"{BORDER}/B1", *fields, guaranteed=False, observable="whole")


def _observed(target: Target) -> dict[tuple[Machine, str], dict[str, Any]]:
    """Return the observable part of each law, by machine and name."""
    around = seen(target.system)
    observed: dict[tuple[Machine, str], dict[str, Any]] = {}
    for clause in around.stated:
        found = around.of(clause)
        alone = [one for one in found if len(one.clauses) == 1]
        against = tuple(dict.fromkeys(str(other) for one in found for other in one.clauses if other is not clause))
        observable: Observed = "no" if not alone else "whole" if alone[0].is_equivalent else "part"
        observed[clause.machine, clause.name] = {"observable": observable, "against": against}
    return observed


def figures_to_confirm(
    targets: Iterable[Target], other_kinds: Mapping[str, BaseModel] | None = None
) -> list[ToConfirm]:
    """Return every configured figure of the targets, and of configurations of other kinds, that is from memory, once."""
    configured = [*((target.name, target.config) for target in targets), *(other_kinds or {}).items()]
    return to_confirm((name, one) for name, config in configured for one in configured_figures(config))


def _of_machine(
    machine: Machine, section: str, every: Sequence[Figure], guaranteed: tuple[str, ...]
) -> Iterator[Assumption]:
    for name, law in machine.world.laws.items():
        yield Assumption(
            "",
            machine.name,
            name,
            law.statement,
            text(law.term),
            tuple(figures_of(law, section, every)),
            law.source,
            law.owner,
            law.check,
            name in guaranteed,
        )
