"""`safeloc migrate`: convert files of an earlier version to the current names."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Annotated, Any

import typer

from safeloc.cli.console import out
from safeloc.runtime.migration import Migrated
from safeloc.runtime.migration import migrate as migrated


def migrate(
    paths: Annotated[
        list[Path], typer.Argument(help="streams, records, configurations, snapshots", show_default=False)
    ],
    in_place: Annotated[
        bool, typer.Option("--in-place", help="overwrite the file, and keep the old one as FILE.bak")
    ] = False,
) -> None:
    """Convert files of version 0.1.0 to the names of 0.2.0. If one of them is refused, no file is written."""
    from safeloc.catalogue import ENTRIES

    made = [migrated(path, ships=ENTRIES, fingerprint=_fingerprint) for path in paths]
    for one in made:
        one.require_room(in_place=in_place)
    for one in made:
        _write(one, in_place)


def _write(one: Migrated, in_place: bool) -> None:
    if not one.changes:
        out.print(f"{one.path}: has the current names; unchanged", markup=False)
        return
    out.print(f"{one.path} -> {one.write(in_place=in_place)}", markup=False)
    for change in one.changes:
        out.print(f"  {change.words}", markup=False)


def _fingerprint(machine: str, config: Mapping[str, Any]) -> str | None:
    """Return the digest of a shipped machine as it is now; None for any other machine."""
    from safeloc.catalogue import ENTRIES, checked_config
    from safeloc.runtime.embedding import Program

    if machine not in ENTRIES:
        return None
    entry = ENTRIES[machine]
    return Program(entry.make(checked_config(entry.config, config, "configuration"))).fingerprint
