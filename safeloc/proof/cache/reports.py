"""The cache of complete reports without a bad verdict: if nothing at all has changed, the report is restored from it.

Reports are cached for shipped machines only: the files that a user's module depends on are unknown, so that only its loaded
declarations can be compared (safeloc.proof.cache.targets).
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

_KIND, _SAID = "reports", "said.txt"


@dataclass(frozen=True)
class KeptReport:
    """A cached report of an earlier run.

    summary  the text that the run displayed at its end
    since    the time at which the report was cached (UTC)
    archive  its files, as the bytes of a zip file
    """

    summary: str
    since: str
    archive: bytes

    def put_back(self, folder: Path) -> None:
        """Write the files of the report into a folder without a report; InputError if the folder cannot be written."""
        try:
            with zipfile.ZipFile(io.BytesIO(self.archive)) as archive:
                archive.extractall(folder, [name for name in archive.namelist() if name != _SAID])
        except OSError as error:
            raise InputError(f"{folder}: the report cannot be written here: {error}") from error


def report_key(machines: Sequence[str], config: Path | None, *question: object) -> str | None:
    """Return the key of a run of shipped machines; None if one is a user's own, or the configuration cannot be read."""
    if any(":" in name for name in machines):
        return None
    try:
        content = b"" if config is None else config.read_bytes()
    except OSError:
        return None
    request = "\0".join([engine_digest(), source_digest(), *machines, *map(repr, question)])
    return hashlib.sha256(request.encode() + b"\0config\0" + content).hexdigest()


def kept_report(store: Store, key: str | None) -> KeptReport | None:
    """Return the cached report of the same run; None if there is none."""
    entry = None if key is None else store.get(_KIND, key)
    if entry is None:
        return None
    with zipfile.ZipFile(io.BytesIO(entry.data)) as archive:
        return KeptReport(archive.read(_SAID).decode(), entry.since, entry.data)


def keep_report(store: Store, key: str | None, folder: Path, names: Sequence[str], summary: str) -> None:
    """Cache the files of a report, by their names in its folder, and the text that the run displayed at its end."""
    if key is None or not undisturbed():
        return
    buffer = io.BytesIO()
    with zipfile.ZipFile(buffer, "w", zipfile.ZIP_DEFLATED) as archive:
        for name in names:
            archive.write(folder / name, name)
        archive.writestr(_SAID, summary)
    store.put(_KIND, key, buffer.getvalue())
