"""The figures that a law of a world names, each with its value in the configuration of a target, unit and source."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass

from pydantic import BaseModel

from safeloc.config import figures
from safeloc.language.world import Law

FROM_MEMORY = "[M]"
"""Mark of a figure that was not read in any document."""
_REMEMBERED = re.compile(r"(?:^|; )\[M[],]")
"""The same mark of a source, or of one of several; also with how sure the memory is: `[M, unsure]`."""


def is_from_memory(source: str) -> bool:
    """Return whether a source, or a part of it, is somebody's memory."""
    return _REMEMBERED.search(source) is not None


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
        return is_from_memory(self.source)


@dataclass(frozen=True)
class ToConfirm:
    """A figure from memory, once: name, value, unit and source, and each place where a configuration has it.

    places  such as "guard: brake_mm_s2" and "marker_device: guard.brake_mm_s2"
    values  number of figures of this name with another value, unit or source, this one included
    """

    name: str
    value: str
    unit: str
    source: str
    places: tuple[str, ...]
    values: int


def to_confirm(figures: Iterable[tuple[str, Figure]]) -> list[ToConfirm]:
    """Return every figure that is from memory, once, out of the figures of targets; those of one name stand together."""
    found: dict[str, dict[tuple[str, str, str], list[str]]] = {}
    for target, one in figures:
        if one.to_confirm:
            name, said = one.name.rpartition(".")[2], (one.value, one.unit, one.source)
            found.setdefault(name, {}).setdefault(said, []).append(f"{target}: {one.name}")
    return [
        ToConfirm(name, *said, tuple(places), len(by_value))
        for name, by_value in found.items()
        for said, places in by_value.items()
    ]


def configured_figures(config: BaseModel | None) -> list[Figure]:
    """Return every figure of a configuration; none without one."""
    return [] if config is None else [Figure(**one) for one in figures(config)]


def figures_of(law: Law, section: str, every: Sequence[Figure]) -> Iterator[Figure]:
    """Yield the figures that the law names out of every configured one.

    section  the part of the configuration that is the machine's, often of its name
    """
    for name in law.figures:
        yield from figures_named(name, section, every) or [Figure(name, "", "", "not found in the configuration")]


def figures_named(name: str, section: str, every: Sequence[Figure]) -> list[Figure]:
    """Return the figures of a name; if several parts of the configuration have one, those of the section."""
    found = [one for one in every if one.name == name or one.name.endswith(f".{name}")]
    return [one for one in found if section in one.name.split(".")] or found
