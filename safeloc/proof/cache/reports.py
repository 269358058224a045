"""The whole report of a run in which all was well: where nothing at all has changed, it is put back, and nothing is built.

Of shipped machines only: what a user's own module is made of, only its declarations tell (safeloc.proof.cache.targets).
"""

from __future__ import annotations

import hashlib
import io
import zipfile
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from safeloc.errors import InputError
from safeloc.proof.cache.engine import engine_digest, source_digest, undisturbed
from safeloc.proof.cache.store import Store

KIND, SAID = "reports", "said.txt"


@dataclass(frozen=True)
class KeptReport:
    """A report of an earlier run: what was said of it in the end, since when it is kept, and its files."""

    said: str
    since: str
    archive: bytes

    def put_back(self, folder: Path) -> None:
        """Write its files into a folder that holds no report; InputError where that cannot be."""
        try:
            with zipfile.ZipFile(io.BytesIO(self.archive)) as archive:
                archive.extractall(folder, [name for name in archive.namelist() if name != SAID])
        except OSError as error:
            raise InputError(f"{folder}: the report cannot be written here: {error}") from error


def report_key(machines: Sequence[str], config: Path | None, *question: object) -> str | None:
    """Return the key of a run of shipped machines; None where one is a user's own, or the configuration cannot be read."""
    if any(":" in name for name in machines):
        return None
    try:
        content = b"" if config is None else config.read_bytes()
    except OSError:
        return None
    told = "\0".join([engine_digest(), source_digest(), *machines, *map(repr, question)])
    return hashlib.sha256(told.encode() + b"\0config\0" + content).hexdigest()


def kept_report(store: Store, key: str | None) -> KeptReport | None:
    """Return the report of the same run, if one is kept."""
    entry = None if key is None else store.get(KIND, key)
    if entry is None:
        return None
    with zipfile.ZipFile(io.BytesIO(entry.data)) as archive:
        return KeptReport(archive.read(SAID).decode(), entry.since, entry.data)


def keep_report(store: Store, key: str | None, folder: Path, names: Sequence[str], said: str) -> None:
    """Keep the files of a report, by their names in its folder, and what was said of it in the end."""
    if key is None or not undisturbed():
        return
    buffer = io.BytesIO()
    with zipfile.ZipFile(buffer, "w", zipfile.ZIP_DEFLATED) as archive:
        for name in names:
            archive.write(folder / name, name)
        archive.writestr(SAID, said)
    store.put(KIND, key, buffer.getvalue())
