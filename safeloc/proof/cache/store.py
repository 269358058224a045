"""Files under digests: written at once or not at all, and read only if their checksum is right."""

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

FORMAT = "safeloc-kept/1"
LONGEST_HEAD = 1000
MOST_BYTES = 1_000_000_000
"""What is kept in all; the longest unused goes first."""


def usual_folder() -> Path:
    """Return the user's own folder for what can be made again."""
    return user_cache_path("safeloc")


def utc_now() -> str:
    """Return the time of day as entries tell it; later is greater."""
    return time.strftime("%Y-%m-%dT%H:%M:%SZ", time.gmtime())


@dataclass(frozen=True)
class Entry:
    """A cached item, with its date (UTC)."""

    data: bytes
    since: str


@dataclass(frozen=True)
class Store:
    """A folder of entries by kind and key; several processes may use it at a time. What cannot be written is not kept."""

    folder: Path

    def get(self, kind: str, key: str) -> Entry | None:
        """Return the entry; None where there is none, or none that can be trusted to be what was put there."""
        path = self._path(kind, key)
        try:
            head, _, data = path.read_bytes().partition(b"\n")
            told = json.loads(head) if len(head) < LONGEST_HEAD else {}
        except (OSError, ValueError):
            return None
        if not isinstance(told, dict) or told != _head(kind, key, str(told.get("since")), data):
            return None
        with contextlib.suppress(OSError):
            os.utime(path)
        return Entry(data, told["since"])

    def put(self, kind: str, key: str, data: bytes) -> None:
        """Keep it. Where the folder cannot be written, nothing is kept: whatever it is can be made again."""
        path = self._path(kind, key)
        head = json.dumps(_head(kind, key, utc_now(), data))
        with contextlib.suppress(OSError):
            path.parent.mkdir(parents=True, exist_ok=True)
            _put_in_place(path, head.encode() + b"\n" + data)

    def entries(self) -> Iterator[tuple[Path, os.stat_result]]:
        """Return the files, each with what the system knows of it."""
        for folder, _, names in os.walk(self._own):
            for path in (Path(folder, name) for name in names):
                with contextlib.suppress(OSError):  # another process may have taken it away
                    yield path, path.stat()

    @property
    def bytes(self) -> int:
        """The total size of all cached files."""
        return sum(found.st_size for _, found in self.entries())

    def trim(self, most_bytes: int = MOST_BYTES) -> None:
        """Take away what has not been used for longest, until no more is left than that."""
        found = sorted(self.entries(), key=lambda one: one[1].st_mtime)
        left = sum(one.st_size for _, one in found)
        for path, one in found:
            if left <= most_bytes:
                break
            path.unlink(missing_ok=True)
            left -= one.st_size

    def clean(self) -> None:
        """Take away all that is kept, and nothing else that may stand in the folder."""
        if self._own.exists():
            shutil.rmtree(self._own)

    @property
    def _own(self) -> Path:
        return self.folder / "kept"

    def _path(self, kind: str, key: str) -> Path:
        return self._own / kind / key[:2] / key[2:]


def _put_in_place(path: Path, content: bytes) -> None:
    """Write a file whole, or leave nothing behind."""
    with tempfile.NamedTemporaryFile(dir=path.parent, delete=False) as file:
        try:
            file.write(content)
            file.flush()
            os.replace(file.name, path)
        except OSError:
            os.unlink(file.name)
            raise


def _head(kind: str, key: str, since: str, data: bytes) -> dict[str, str]:
    """Make the header of a file: its kind and key, and a checksum over everything."""
    total = hashlib.sha256("\0".join([FORMAT, kind, key, since, ""]).encode() + data)
    return {"format": FORMAT, "kind": kind, "key": key, "since": since, "sha256": total.hexdigest()}
