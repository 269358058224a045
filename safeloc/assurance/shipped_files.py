"""Results that ship beside a machine: `NAME.KIND` in its folder of `models/`, read for the machine in its default figures only."""

from __future__ import annotations

from pathlib import Path

from safeloc.catalogue import ENTRIES
from safeloc.target import MODELS, Target, beside


def has_shipped_figures(target: Target) -> bool:
    """Return whether the target is a machine that ships, in its default figures."""
    named = target.spec.isidentifier() and target.spec in ENTRIES
    return named and target.config == ENTRIES[target.spec].config()


def shipped_file(target: Target, kind: str) -> Path | None:
    """Return the file of this kind that ships with the machine; None if there is none."""
    return beside(ENTRIES[target.spec].name, kind)


def place_of(target: Target, kind: str) -> Path:
    """Return the path of the file of this kind in the machine's folder, whether or not it is there."""
    entry = ENTRIES[target.spec]
    return MODELS / entry.folder / f"{entry.name}.{kind}"
