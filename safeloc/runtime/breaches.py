"""Breaches of the laws of a world, as they show in operation: which law, in which cycle, by how much, with what values."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from safeloc.language.nodes import Value

Shown = Value | str | None


@dataclass(frozen=True)
class BrokenLaw:
    """A law that is broken: the machine whose world states it, its name, statement and owner."""

    machine: str
    name: str
    statement: str
    owner: str

    def __str__(self) -> str:
        return f"{self.machine}: {self.name}"


@dataclass(frozen=True)
class Breach:
    """A breach: of the one law, or of at least one of two that cannot both hold.

    distance   by how many units the law is violated, below 0; None where it has no distance
    values     what was heard and worked out, by name; None is an input that was absent
    """

    laws: tuple[BrokenLaw, ...]
    distance: int | None
    unit: str
    values: Mapping[str, Shown]

    def words(self) -> str:
        """Return one sober sentence for a log."""
        named = " or ".join(f"{law} ({law.owner or 'no owner'})" for law in self.laws)
        by = "" if self.distance is None else f" by {-self.distance} {self.unit}"
        return f"law broken: {named}{by}"

    def as_data(self) -> dict[str, Any]:
        """Plain data for JSON."""
        data: dict[str, Any] = {
            "laws": [{"machine": law.machine, "name": law.name, "owner": law.owner} for law in self.laws]
        }
        if self.distance is not None:
            data |= {"distance": self.distance, "unit": self.unit}
        return {**data, "values": dict(self.values)}
