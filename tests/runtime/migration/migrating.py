"""Calls `migrate` on files that are written for it."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from safeloc.runtime.migration import Migrated, migrate

SHIPS = ("delocalized", "verification")


def no_machine(_machine: str, _config: Mapping[str, Any]) -> None:
    """Of a machine that does not ship there is no digest."""


def migrated(path: Path, text: str) -> Migrated:
    """What becomes of a file with this text."""
    path.write_text(text, encoding="utf-8")
    return migrate(path, ships=SHIPS, fingerprint=no_machine)


def changed(made: Migrated) -> list[str]:
    """What is changed, in words."""
    return [change.words for change in made.changes]
