"""The files of the cache, named by digests: written completely or not at all, and read only if their checksum is right."""

from __future__ import annotations

import contextlib
import hashlib
import json
import os
import shutil
import tempfile
import time
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from platformdirs import user_cache_path

_FORMAT = "safeloc-kept/1"
_LONGEST_HEAD = 1000
_MOST_BYTES = 1_000_000_000
"""Greatest size of the cache; beyond it the least recently used files are deleted."""


def usual_folder() -> Path:
    """Return the user's cache folder for safeloc."""
    return user_cache_path("safeloc")


def utc_now() -> str:
    """Return the present time as entries store it (UTC); a later time is a greater text."""
    return time.strftime("%Y-%m-%dT%H:%M:%SZ", time.gmtime())


@dataclass(frozen=True)
class Entry:
    """A cached item, with its date (UTC)."""

    data: bytes
    since: str


@dataclass(frozen=True)
class Store:
    """A folder of entries by kind and key, for several processes at once. An entry that cannot be written is not cached."""

    folder: Path

    def get(self, kind: str, key: str) -> Entry | None:
        """Return the entry; None if there is none, or if its file does not contain what `put` wrote."""
        path = self._path(kind, key)
        try:
            head, _, data = path.read_bytes().partition(b"\n")
            header = json.loads(head) if len(head) < _LONGEST_HEAD else {}
        except (OSError, ValueError):
            return None
        if not isinstance(header, dict) or header != _head(kind, key, str(header.get("since")), data):
            return None
        with contextlib.suppress(OSError):
            os.utime(path)
        return Entry(data, header["since"])

    def put(self, kind: str, key: str, data: bytes) -> None:
        """Store an entry; if the folder cannot be written, do nothing, since the entry can be computed again."""
        path = self._path(kind, key)
        head = json.dumps(_head(kind, key, utc_now(), data))
        with contextlib.suppress(OSError):
            path.parent.mkdir(parents=True, exist_ok=True)
            _put_in_place(path, head.encode() + b"\n" + data)

    def entries(self) -> Iterator[tuple[Path, os.stat_result]]:
        """Yield the path of every file of the cache, with its size and times."""
        for folder, _, names in os.walk(self._own):
            for path in (Path(folder, name) for name in names):
                with contextlib.suppress(OSError):  # another process may have deleted it
                    yield path, path.stat()

    @property
    def bytes(self) -> int:
        """The total size of all cached files."""
        return sum(found.st_size for _, found in self.entries())

    def trim(self, most_bytes: int = _MOST_BYTES) -> None:
        """Delete the least recently used files until the cache has at most `most_bytes`."""
        found = sorted(self.entries(), key=lambda one: one[1].st_mtime)
        left = sum(one.st_size for _, one in found)
        for path, one in found:
            if left <= most_bytes:
                break
            path.unlink(missing_ok=True)
            left -= one.st_size

    def clean(self) -> None:
        """Delete all files of the cache, and nothing else in the folder."""
        if self._own.exists():
            shutil.rmtree(self._own)

    @property
    def libraries(self) -> Path:
        """The folder for compiled machines, which `trim` and `clean` treat as the rest; a file in it may vanish at any time."""
        return self._own / "libraries"

    @property
    def _own(self) -> Path:
        return self.folder / "kept"

    def _path(self, kind: str, key: str) -> Path:
        return self._own / kind / key[:2] / key[2:]


def _put_in_place(path: Path, content: bytes) -> None:
    """Write a file completely, or not at all."""
    with tempfile.NamedTemporaryFile(dir=path.parent, delete=False) as file:
        try:
            file.write(content)
            file.flush()
            os.replace(file.name, path)
        except OSError:
            os.unlink(file.name)
            raise


def _head(kind: str, key: str, since: str, data: bytes) -> dict[str, str]:
    """Return the header of a file: format, kind, key, time, and a checksum over these and the data."""
    total = hashlib.sha256("\0".join([_FORMAT, kind, key, since, ""]).encode() + data)
    return {"format": _FORMAT, "kind": kind, "key": key, "since": since, "sha256": total.hexdigest()}
