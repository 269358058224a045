"""A small picture of few colours as PNG, and as a data URL for a self-contained page."""

from __future__ import annotations

import base64
import struct
import zlib
from collections.abc import Sequence

SIGNATURE = b"\x89PNG\r\n\x1a\n"
_BITS, BY_PALETTE = 8, 3
_MOST_COLOURS = 256
Colour = tuple[int, int, int]


def png(rows: Sequence[bytes], palette: Sequence[Colour]) -> bytes:
    """Return the PNG of rows from the top; a byte is the number of a pixel's colour. ValueError for rows of different
    lengths, and for a colour that the palette does not have."""
    width = len(rows[0]) if rows else 0
    if not width or any(len(row) != width for row in rows):
        raise ValueError("a picture needs rows of equal length, and at least one pixel.")
    if not len(palette) <= _MOST_COLOURS or max(map(max, rows)) >= len(palette):
        raise ValueError(f"a picture has up to {_MOST_COLOURS} colours, and each pixel is one of them.")
    head = struct.pack(">IIBBBBB", width, len(rows), _BITS, BY_PALETTE, 0, 0, 0)
    data = zlib.compress(b"".join(b"\0" + row for row in rows), 9)
    parts = (
        (b"IHDR", head),
        (b"PLTE", bytes(part for colour in palette for part in colour)),
        (b"IDAT", data),
        (b"IEND", b""),
    )
    return SIGNATURE + b"".join(_chunk(kind, content) for kind, content in parts)


def data_address(image: bytes) -> str:
    """Return the image as a data URL."""
    return "data:image/png;base64," + base64.b64encode(image).decode("ascii")


def _chunk(kind: bytes, content: bytes) -> bytes:
    return struct.pack(">I", len(content)) + kind + content + struct.pack(">I", zlib.crc32(kind + content))
