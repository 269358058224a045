"""Files of version 0.1.0 as files of 0.2.0: streams, records, configurations; what cannot be carried over is refused.

    migrated = migrate(path, ships=..., fingerprint=...)      what the file is to be, and what is changed in it
    migrated.write_beside(), migrated.write_in_place()        whole, or not at all

What stands in a file is kept, letter by letter, but for the names; a file of today is left alone.
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
    """A file as it is to be; `changes` is empty where it is one of today already."""

    path: Path
    text: str
    changes: tuple[Change, ...]

    @property
    def beside(self) -> Path:
        """The new file: `run.migrated.jsonl.gz` beside `run.jsonl.gz`."""
        name = name_of(self.path)
        return self.path.with_name(f"{name}.migrated{self.path.name.removeprefix(name)}")

    @property
    def backup(self) -> Path:
        """Where the old file is kept when the new one takes its place."""
        return self.path.with_name(f"{self.path.name}.bak")

    def require_room(self, *, in_place: bool) -> None:
        """InputError where a file is in the way."""
        wanted = self.backup if in_place else self.beside
        if self.changes and os.path.lexists(wanted):
            raise InputError(f"{wanted}: is there already, and would be lost; move it away.")

    def write(self, *, in_place: bool) -> Path:
        """Write the new file, whole or not at all: beside the old one, or in its place, which is kept as `backup` then."""
        self.require_room(in_place=in_place)
        with reading(self.path):
            if in_place:
                shutil.copy2(self.path, self.backup)
            target = self.path if in_place else self.beside
            _write(target, self.text)
            return target


def migrate(path: Path, *, ships: Collection[str], fingerprint: Fingerprint) -> Migrated:
    """What the file is to be. InputError, with file, line and reason, for what is not understood or not carried over.

    ships        names of the machines whose inputs were renamed
    fingerprint  machine and configuration -> digest of today; for snapshots
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
    """A file of any name that says in itself what it is."""
    try:
        content = json.loads(read_bytes(path))
    except (ValueError, RecursionError):
        content = None
    if not snapshots.is_snapshot(content):
        raise InputError(
            f"{path}: a file of kind {kind!r}, which is not carried over; known are {KINDS}, and snapshots. Rename the columns of a table by hand."
        )
    return _json(path, fingerprint)


def _write(path: Path, text: str) -> None:
    """Beside first, then renamed: a reader sees the old file or the new one, whole."""
    unfinished = path.with_name(f".unfinished-{path.name}")
    try:
        with created(unfinished) as file:
            file.write(text)
        with unfinished.open("rb+") as file:
            os.fsync(file.fileno())
        unfinished.replace(path)
    finally:
        unfinished.unlink(missing_ok=True)
