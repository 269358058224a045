"""Streams packed with gzip: wherever `NAME.jsonl` is read or written, `NAME.jsonl.gz` is too, and CSV likewise.

Parquet packs its columns itself, so it is not packed again. A damaged file is refused by name: gzip files contain a checksum.
"""

from __future__ import annotations

import gzip
import zlib
from collections.abc import Iterator
from contextlib import contextmanager
from io import TextIOWrapper
from pathlib import Path, PurePath
from typing import TextIO

from safeloc.errors import StreamError
from safeloc.runtime.outside import LARGEST_FILE, cut_lines, reading, refuse_beyond

_SUFFIX = ".gz"
_PACKABLE = (".jsonl", ".ndjson", ".csv")
_SMALLEST = 9
"""Level of gzip: a recording is written once, and the time to read it does not depend on the level."""


def is_packed(path: PurePath) -> bool:
    """Return whether the name ends in .gz."""
    return path.suffix == _SUFFIX


def kind_of(path: PurePath) -> str:
    """Return the suffix for the format of the stream: `.jsonl` for `run.jsonl` and for `run.jsonl.gz`."""
    within = PurePath(path.stem).suffix
    return within if is_packed(path) and within in _PACKABLE else path.suffix


def name_of(path: PurePath) -> str:
    """Return the stream's name for findings and pictures: `run` for `run.jsonl` and `run.jsonl.gz`."""
    return path.stem.removesuffix(kind_of(path)) if is_packed(path) else path.stem


def unpacked_lines(path: Path, longest: int) -> Iterator[tuple[int, str]]:
    """Yield the lines of a packed file, as `read_lines` does for a plain one; StreamError for a damaged file."""
    with reading(path):
        size = path.stat().st_size
        refuse_beyond(path, size, LARGEST_FILE, "bytes")
        if size == 0:  # Python would accept it as an empty packed file
            raise _damaged(path, "it is empty")
        try:
            with gzip.open(path) as file:
                yield from cut_lines(path, file, longest, "bytes when unpacked")
        except (gzip.BadGzipFile, EOFError, zlib.error) as error:
            raise _damaged(path, str(error)) from error


def _damaged(path: Path, why: str) -> StreamError:
    return StreamError(f"{path}: damaged, it cannot be unpacked ({why}); copy it again, or record it again.")


@contextmanager
def created(path: Path) -> Iterator[TextIO]:
    """Open a stream for writing text, packed if the path ends in .gz. Equal text gives equal bytes, without name and time."""
    if not is_packed(path):
        with path.open("w", newline="", encoding="utf-8") as text:
            yield text
        return
    with (
        path.open("wb") as file,
        gzip.GzipFile("", "wb", _SMALLEST, file, mtime=0) as packed,
        TextIOWrapper(packed, encoding="utf-8", newline="") as text,
    ):
        yield text
