"""Streams packed with gzip: `NAME.jsonl.gz` is read and written wherever `NAME.jsonl` is, and CSV likewise.

Parquet packs its columns itself and is not packed once more. A damaged file is refused by name: gzip keeps a check sum.
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

SUFFIX = ".gz"
PACKABLE = (".jsonl", ".ndjson", ".csv")
SMALLEST = 9
"""How hard to pack: a recording is written once, and reading takes the same time."""


def is_packed(path: PurePath) -> bool:
    """Tell whether the name is that of a packed stream."""
    return path.suffix == SUFFIX


def kind_of(path: PurePath) -> str:
    """Return the suffix for the format of the stream: `.jsonl` for `run.jsonl` and for `run.jsonl.gz`."""
    within = PurePath(path.stem).suffix
    return within if is_packed(path) and within in PACKABLE else path.suffix


def name_of(path: PurePath) -> str:
    """Return what findings and pictures call the stream: `run`, packed or not."""
    return path.stem.removesuffix(kind_of(path)) if is_packed(path) else path.stem


def unpacked_lines(path: Path, longest: int) -> Iterator[tuple[int, str]]:
    """Give every line of a packed file as `read_lines` does of a plain one; StreamError for a file that is damaged."""
    with reading(path):
        size = path.stat().st_size
        refuse_beyond(path, size, LARGEST_FILE, "bytes")
        if size == 0:  # which Python takes for a packed file with nothing in it
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
    """Open a stream to write text to, packed where the path ends in .gz: without name and time, so equal text gives equal
    bytes."""
    if not is_packed(path):
        with path.open("w", newline="", encoding="utf-8") as text:
            yield text
        return
    with (
        path.open("wb") as file,
        gzip.GzipFile("", "wb", SMALLEST, file, mtime=0) as packed,
        TextIOWrapper(packed, encoding="utf-8", newline="") as text,
    ):
        yield text
