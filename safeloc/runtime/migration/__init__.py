"""Conversion of files of version 0.1.0 to 0.2.0: streams, records, configurations. A file that cannot be converted is refused.

    migrated = migrate(path, ships=..., fingerprint=...)      the new content, and the changes
    migrated.write(in_place=...)                              the complete file, or nothing

Only names are changed, the rest is kept letter by letter; a file with the current names is not changed.
"""

from __future__ import annotations

import json
import os
import shutil
from collections.abc import Collection
from dataclasses import dataclass
from pathlib import Path

from safeloc.errors import InputError
from safeloc.runtime.migration import configurations, snapshots, streams
from safeloc.runtime.migration.changes import Change
from safeloc.runtime.migration.snapshots import Fingerprint
from safeloc.runtime.outside import read_bytes, read_text, reading
from safeloc.runtime.streams.files import existing
from safeloc.runtime.streams.gzipped import created, kind_of, name_of

__all__ = ["Change", "Migrated", "migrate"]
KINDS = ".jsonl and .ndjson (also with .gz), .toml, .json"


@dataclass(frozen=True)
class Migrated:
    """The new content of a file; `changes` is empty if the file already has the current names."""

    path: Path
    text: str
    changes: tuple[Change, ...]

    @property
    def beside(self) -> Path:
        """Return the path of the new file: `run.migrated.jsonl.gz` beside `run.jsonl.gz`."""
        name = name_of(self.path)
        return self.path.with_name(f"{name}.migrated{self.path.name.removeprefix(name)}")

    @property
    def backup(self) -> Path:
        """Return the path for the old file when the new one takes its place."""
        return self.path.with_name(f"{self.path.name}.bak")

    def require_room(self, *, in_place: bool) -> None:
        """Raise InputError if a file that would be overwritten exists."""
        wanted = self.backup if in_place else self.beside
        if self.changes and os.path.lexists(wanted):
            raise InputError(f"{wanted}: already exists and would be overwritten; move it away.")

    def write(self, *, in_place: bool) -> Path:
        """Write the complete new file beside the old one, or in its place, with the old one as `backup`; return its path."""
        self.require_room(in_place=in_place)
        with reading(self.path):
            if in_place:
                shutil.copy2(self.path, self.backup)
            target = self.path if in_place else self.beside
            _write(target, self.text)
            return target


def migrate(path: Path, *, ships: Collection[str], fingerprint: Fingerprint) -> Migrated:
    """Return the new content of a file. InputError with file, line and reason for a file that cannot be converted.

    ships        names of the machines whose inputs were renamed
    fingerprint  machine and configuration -> current digest; for snapshots
    """
    match kind_of(existing(path)):
        case ".jsonl" | ".ndjson":
            return Migrated(path, *streams.migrated(path, ships))
        case ".toml":
            return Migrated(path, *configurations.migrated(path))
        case ".json":
            return _json(path, fingerprint)
        case kind:
            return _snapshot(path, kind, fingerprint)


def _json(path: Path, fingerprint: Fingerprint) -> Migrated:
    text = read_text(path)
    try:
        content = json.loads(text)
    except (ValueError, RecursionError) as error:
        raise InputError(f"{path}: no JSON ({error}).") from error
    if not snapshots.is_snapshot(content):
        return Migrated(path, *configurations.migrated(path))
    snapshots.require_current(path, content, fingerprint)
    return Migrated(path, text, ())


def _snapshot(path: Path, kind: str, fingerprint: Fingerprint) -> Migrated:
    """Return a snapshot, recognised by its content; InputError for any other file."""
    try:
        content = json.loads(read_bytes(path))
    except (ValueError, RecursionError):
        content = None
    if not snapshots.is_snapshot(content):
        raise InputError(
            f"{path}: files of kind {kind!r} cannot be converted, only {KINDS} and snapshots. Rename the columns of a table by hand."
        )
    return _json(path, fingerprint)


def _write(path: Path, text: str) -> None:
    """Write to another name first, then rename: a reader sees the complete old file or the complete new one."""
    unfinished = path.with_name(f".unfinished-{path.name}")
    try:
        with created(unfinished) as file:
            file.write(text)
        with unfinished.open("rb+") as file:
            os.fsync(file.fileno())
        unfinished.replace(path)
    finally:
        unfinished.unlink(missing_ok=True)
