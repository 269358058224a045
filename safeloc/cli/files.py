"""Detect when two file names of a command mean the same file: an input must not be overwritten."""

from __future__ import annotations

from pathlib import Path

from safeloc.errors import InputError


def same_file(one: Path, other: Path) -> bool:
    """Return whether both names mean the same file, even if it does not exist yet."""
    try:
        return one.samefile(other)
    except OSError:
        return one.absolute() == other.absolute()


def require_not_read(out: Path, *read: str | Path | None) -> None:
    """Raise InputError if the file to write is one of those to read."""
    if any(same_file(out, Path(one)) for one in read if one is not None):
        raise InputError(f"{out}: this file is the input and would be overwritten; give --out another file.")
