"""Snapshots of a partition that moves between processes: each owner writes under an epoch of its own.

The broker decides who owns a partition: whoever has the session of the partition. An owner that was replaced may not know it
yet, and may be writing a snapshot at this moment. So an owner writes only into the files of its own epoch, and the next one
reads the file of the highest epoch and takes a higher one.

An epoch is claimed by creating a file that must not exist (O_EXCL), and is used only after the broker has confirmed,
later than the claim, that the session is still one's own. Therefore a snapshot of a higher epoch is from a later owner:

- an owner that comes later claims after the confirmation of the earlier one, sees its epoch and takes a higher one;
- a process that was replaced before it claimed is never confirmed, and writes nothing under its epoch.

The folder has to be on a file system on which a created file is seen by all processes at once: a local one, for all
processes of one computer.
"""

from __future__ import annotations

import os
import re
from pathlib import Path
from typing import Any

from safeloc.errors import InputError
from safeloc.runtime.locked_folder import locked
from safeloc.runtime.service.saving import read_saved, write_atomically

_CLAIM = re.compile(r"([0-9]{1,18})\.claim")
_SNAPSHOT = re.compile(r"([0-9]{1,18})\.snapshot")
_LAYOUT = "partitions"


def require_layout(folder: Path, partitions: int) -> None:
    """Make the folder, or check that its snapshots are of so many partitions; InputError if they are not.

    With another number, vehicles would be in other partitions, without their snapshots. Of processes that begin at the same
    moment one makes it, and the others check it.
    """
    path = folder / _LAYOUT
    try:
        folder.mkdir(parents=True, exist_ok=True)
        with locked(folder):
            found = path.read_bytes() if path.exists() else b""
            if not found:
                write_atomically(path, b"%d\n" % partitions)
                return
    except OSError as error:
        raise InputError(f"{folder}: no folder for snapshots: {error.strerror}.") from error
    if found.strip() != b"%d" % partitions:
        raise InputError(
            f"{folder}: snapshots of {found[:20].decode(errors='replace').strip()} partitions, not {partitions}; name "
            "another folder, and let the vehicles send to the partitions that they are in now."
        )


class Epochs:
    """The snapshots of one partition in a folder."""

    def __init__(self, folder: Path, partition: int) -> None:
        self._folder = folder / str(partition)
        try:
            self._folder.mkdir(exist_ok=True)
        except OSError as error:
            raise InputError(f"{self._folder}: cannot be made: {error.strerror}.") from error

    def claim(self) -> int:
        """Return a new epoch, above all others; InputError if the folder cannot be written."""
        epoch = max([0, *self._found(_CLAIM), *self._found(_SNAPSHOT)]) + 1
        while True:
            try:
                os.close(os.open(self._folder / f"{epoch}.claim", os.O_WRONLY | os.O_CREAT | os.O_EXCL | os.O_CLOEXEC))
                return epoch
            except FileExistsError:
                epoch += 1
            except OSError as error:
                raise InputError(f"{self._folder}: cannot be written: {error.strerror}.") from error

    def path(self, epoch: int) -> Path:
        """Return the file for the snapshots of an epoch."""
        return self._folder / f"{epoch}.snapshot"

    def last(self, below: int) -> dict[str, Any] | None:
        """Return the newest snapshot of the owners before; None if there is none. SnapshotError if it is damaged."""
        while found := [epoch for epoch in self._found(_SNAPSHOT) if epoch < below]:
            saved = read_saved(self.path(max(found)))
            if saved is not None:
                return saved  # otherwise the owner before has just replaced it by one of its own
        return None

    def alone_between(self, earlier: int, later: int) -> bool:
        """Return whether nobody claimed an epoch between two of one process."""
        return not any(earlier < epoch < later for epoch in self._found(_CLAIM))

    def forget_before(self, epoch: int) -> None:
        """Remove what owners before this epoch left, after a snapshot of this epoch is on disk."""
        for kind, ending in ((_SNAPSHOT, "snapshot"), (_CLAIM, "claim")):
            for old in self._found(kind):
                if old < epoch:
                    (self._folder / f"{old}.{ending}").unlink(missing_ok=True)

    def _found(self, kind: re.Pattern[str]) -> list[int]:
        return [int(match[1]) for name in os.listdir(self._folder) if (match := kind.fullmatch(name)) is not None]
