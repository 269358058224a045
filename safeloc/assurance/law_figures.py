"""The figures that a law of a world names, each with its value in the configuration of a target, unit and source."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from pydantic import BaseModel

from safeloc.config import figures
from safeloc.language.world import Law

FROM_MEMORY = "[M]"
"""Beginning of the source of a figure that was not read in any document."""


@dataclass(frozen=True)
class Figure:
    """A configured figure that a law uses: its place in the configuration, value, unit and source."""

    name: str
    value: str
    unit: str
    source: str

    @property
    def to_confirm(self) -> bool:
        """Return whether the operator has to confirm it, because it is an engineering default."""
        return self.source.startswith(FROM_MEMORY)


def configured_figures(config: BaseModel | None) -> list[Figure]:
    """Return every figure of a configuration; none without one."""
    return [] if config is None else [Figure(**one) for one in figures(config)]


def figures_of(law: Law, machine: str, every: Sequence[Figure]) -> Iterator[Figure]:
    """Yield the figures that the law names out of every configured one; if several parts have one of that name, that of the machine."""
    for name in law.figures:
        found = [one for one in every if one.name == name or one.name.endswith(f".{name}")]
        of_machine = [one for one in found if machine in one.name.split(".")]
        yield from of_machine or found or [Figure(name, "", "", "not found in the configuration")]
