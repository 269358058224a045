"""Breaches of the laws of a world that are observed in operation: law, distance and the values that show it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from safeloc.language.nodes import Value

Shown = Value | str | None


@dataclass(frozen=True)
class BrokenLaw:
    """A broken law: the machine whose world states it, and the law's name, statement and owner."""

    machine: str
    name: str
    statement: str
    owner: str

    def __str__(self) -> str:
        return f"{self.machine}: {self.name}"


@dataclass(frozen=True)
class Breach:
    """A breach of one law, or of at least one of two laws that cannot both hold.

    distance   by how many units the law is violated, as a negative number; None if the law has no distance
    values     the inputs and observed values that show it, by name; None for an absent input
    """

    laws: tuple[BrokenLaw, ...]
    distance: int | None
    unit: str
    values: Mapping[str, Shown]

    def words(self) -> str:
        """Return one sentence for a log."""
        named = " or ".join(f"{law} ({law.owner or 'no owner'})" for law in self.laws)
        by = "" if self.distance is None else f" by {-self.distance} {self.unit}"
        return f"law broken: {named}{by}"

    def as_data(self) -> dict[str, Any]:
        """Return plain data for JSON."""
        data: dict[str, Any] = {
            "laws": [{"machine": law.machine, "name": law.name, "owner": law.owner} for law in self.laws]
        }
        if self.distance is not None:
            data |= {"distance": self.distance, "unit": self.unit}
        return {**data, "values": dict(self.values)}
