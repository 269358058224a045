"""Checks of a design: the written file passes the audit, the machine is proved to hold its position, and 1 mm more breaks it."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from safeloc.language.verdict import word
from safeloc.proof.provers.limits import Limits
from safeloc.railway.audit import audit
from safeloc.railway.audit.findings import AuditReport
from safeloc.railway.design.designing import Design
from safeloc.railway.design.held_stretch import HeldStretch, broken_beyond, proof_of, watched
from safeloc.railway.map.elements import BaliseGroup
from safeloc.railway.map.toml_files import from_toml, to_toml


@dataclass(frozen=True, eq=False)
class Held:
    """The findings on the machine behind groups of one location accuracy.

    verdict    of the claim that it holds its position as far as the bound says
    lost_in    the cycle, from 0, in which a run withdraws the position within 1 mm more; None: it does not
    """

    held: HeldStretch
    verdict: str
    lost_in: int | None

    @property
    def is_shown(self) -> bool:
        """True if the bound is proved, and 1 mm more breaks it."""
        return self.verdict == "proved" and self.lost_in is not None


def written(found: Design) -> tuple[str, AuditReport]:
    """Return the text of the designed line, and the audit of the line that is read from this text."""
    text = to_toml(found.line)
    return text, audit(from_toml(text, f"{found.line.name}, designed"), found.task.layout)


def held_by_the_machine(found: Design, seconds: float) -> Iterator[Held]:
    """Yield what the balise machine does behind the groups of the designed line, for each location accuracy among them."""
    groups = [one for one in found.line.balise_groups if isinstance(one, BaliseGroup)]
    machine = watched(found.reach.config)
    for accuracy_mm in sorted({found.reach.accuracy_mm(one) for one in groups}):
        held = found.reach.held(accuracy_mm)
        if held is not None:
            yield Held(held, word(proof_of(machine, held, Limits(seconds=seconds))), broken_beyond(machine, held))
