"""Files packed with xz, read within bounds. A damaged or truncated file is refused by name: xz files contain a checksum."""

from __future__ import annotations

import lzma
from pathlib import Path

from safeloc.errors import InputError
from safeloc.runtime.outside import LARGEST_FILE, read_bytes, refuse_beyond

SUFFIX = ".xz"
_PRESET = 6
"""Preset of xz: it takes six times as long as 2, and saves a fifth."""
_OF_TEXT = {"pb": 0, "nice_len": 128, "depth": 16}
"""Text has no aligned words, and long repetitions, among which the best is sought in vain for long: without a limit of the search a
fiftieth is saved, in almost twice the time.
"""
_MOST_MEMORY = 256 << 20
"""Bytes of memory for unpacking, besides the result."""


def packed(data: bytes) -> bytes:
    """Return the content of a packed file; equal data give equal bytes."""
    return lzma.compress(data, filters=[{"id": lzma.FILTER_LZMA2, "preset": _PRESET, **_OF_TEXT}])


def read_packed(path: Path, most: int = LARGEST_FILE) -> bytes:
    """Return the unpacked content. InputError for a file that is damaged, has data after its end, or is too large."""
    content = read_bytes(path, most)
    unpacking = lzma.LZMADecompressor(lzma.FORMAT_XZ, _MOST_MEMORY)
    try:
        data = unpacking.decompress(content, most + 1)
    except (lzma.LZMAError, EOFError) as error:
        raise InputError(f"{path}: damaged, it cannot be unpacked ({error}). Write the report again.") from error
    refuse_beyond(path, len(data), most, "bytes when unpacked")
    if not unpacking.eof:
        raise InputError(f"{path}: damaged, it ends too early. Write the report again.")
    if unpacking.unused_data:
        raise InputError(f"{path}: damaged, something follows after its end. Write the report again.")
    return data
