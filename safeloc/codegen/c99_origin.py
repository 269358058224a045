"""The purpose of an exported folder of C: version, configuration, cycle length, and what its inputs and outputs mean."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field


@dataclass(frozen=True)
class Figure:
    """A figure of the configuration: name, value and unit as text."""

    name: str
    value: str
    unit: str = ""


@dataclass(frozen=True)
class Origin:
    """The origin of an exported machine, for header and README. It changes no statement of the code.

    version      version of safeloc
    configuration  name of the configuration's file; "" for the defaults
    figures      every figure of the configuration; none for a machine without one
    period_ms    length of a cycle; None where the configuration has none
    meanings     what inputs and outputs mean, by their names in the declaration: sign, reference point
    """

    version: str = ""
    configuration: str = ""
    figures: Sequence[Figure] = ()
    period_ms: int | None = None
    meanings: Mapping[str, str] = field(default_factory=dict)

    @property
    def sentences(self) -> list[str]:
        """Return version, configuration and cycle as sentences."""
        said = [f"Made by safeloc {self.version}."] if self.version else []
        if self.figures:
            said.append(
                f"Exported with the configuration {self.configuration}."
                if self.configuration
                else "Exported with the default configuration."
            )
        return said + ([f"One step is one cycle of {self.period_ms} ms."] if self.period_ms is not None else [])


NO_ORIGIN = Origin()


def as_comment(origin: Origin) -> list[str]:
    """Return the paragraphs of the header's comment: sentences, then a line for each figure."""
    figures = [f"    {one.name} = {one.value} {one.unit}".rstrip() for one in origin.figures]
    return [*(["", " ".join(origin.sentences)] if origin.sentences else []), *(["", *figures] if figures else [])]


def as_table(origin: Origin) -> str:
    """Return the README's section; "" where nothing is known of the origin."""
    if not origin.sentences:
        return ""
    rows = [f"| {one.name} | {one.value} {one.unit}".rstrip() + " |" for one in origin.figures]
    table = "\n".join(["", "| figure | value |", "|---|---|", *rows, ""]) if rows else ""
    return f"## What it was exported for\n\n{' '.join(origin.sentences)}\n{table}\n\n"
