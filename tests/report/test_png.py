"""Small pictures as PNG: what is written can be read back, and nothing else is written."""

from __future__ import annotations

import base64
import struct
import zlib

import pytest

from safeloc.report.png import SIGNATURE, Colour, data_address, png

PALETTE: tuple[Colour, ...] = ((255, 255, 255), (0, 0, 0), (200, 10, 20))


def chunks(image: bytes) -> dict[bytes, bytes]:
    """Kind -> content; every checksum is right."""
    found, at = dict[bytes, bytes](), len(SIGNATURE)
    while at < len(image):
        (length,) = struct.unpack_from(">I", image, at)
        kind, content = image[at + 4 : at + 8], image[at + 8 : at + 8 + length]
        assert struct.unpack_from(">I", image, at + 8 + length) == (zlib.crc32(kind + content),)
        found[kind] = content
        at += 12 + length
    return found


def test_pixels_are_written_as_they_are() -> None:
    """Two rows of three pixels, each with its number of the palette."""
    image = png([bytes([0, 1, 2]), bytes([2, 2, 0])], PALETTE)
    assert image.startswith(SIGNATURE)
    parts = chunks(image)
    assert (3, 2, 8, 3, 0, 0, 0) == struct.unpack(">IIBBBBB", parts[b"IHDR"])
    assert bytes([255, 255, 255, 0, 0, 0, 200, 10, 20]) == parts[b"PLTE"]
    assert bytes([0, 0, 1, 2, 0, 2, 2, 0]) == zlib.decompress(parts[b"IDAT"])


@pytest.mark.parametrize("rows", [[], [b""], [b"\0", b"\0\0"]])
def test_what_is_no_picture_is_refused(rows: list[bytes]) -> None:
    """No rows, no pixel, rows of different lengths."""
    with pytest.raises(ValueError, match=r"^a picture needs rows of equal length, and at least one pixel\.$"):
        png(rows, PALETTE)


def test_a_colour_that_there_is_not_is_refused() -> None:
    """Number 3 of three colours."""
    with pytest.raises(ValueError, match="each pixel is one of them"):
        png([bytes([3])], PALETTE)


def test_an_address_holds_the_image() -> None:
    """It needs no file."""
    image = png([b"\1"], PALETTE)
    kind, text = data_address(image).split(",")
    assert "data:image/png;base64" == kind
    assert image == base64.b64decode(text)
