"""Which files of a command are one: what is read must not be written over."""

from __future__ import annotations

from pathlib import Path

from safeloc.errors import InputError


def same_file(one: Path, other: Path) -> bool:
    """Whether both names lead to one file, also where it is not there yet."""
    try:
        return one.samefile(other)
    except OSError:
        return one.absolute() == other.absolute()


def require_not_read(out: Path, *read: str | Path | None) -> None:
    """InputError where the file to be written is one of those that are read."""
    if any(same_file(out, Path(one)) for one in read if one is not None):
        raise InputError(f"{out}: it is read, and writing would lose it; give --out another file.")
