"""Random changes of sound examples, for where no coverage-guided fuzzer is installed, and for the ordinary tests."""

from __future__ import annotations

from collections.abc import Sequence
from random import Random

PIECES = (
    b"", b"\n", b"\r", b"\0", b"\xff", b"\xef\xbb\xbf", b'"', b"'", b",", b"{", b"}", b"[", b"]", b":", b"<", b">", b"&#1633;",
    b"null", b"true", b"NaN", b"-Infinity", b"1e999999999", b"-1", b"0", b"1_0", b"9" * 30, b"9" * 5_000, b"0.5", b"1.5",
    "\u0661\u0662".encode(), b"\\ud800", b"\\u0000", b'"marker": 7', b'"value": null', b'"x": 1, ', b"[" * 2_000, b"a." * 3_000,
    b"kind", b"cycle", b"vehicle", b"number", b"schema", b"id", b"ref", b" " * 300, b"A" * 2_000,
)  # fmt: skip
"""What has hurt readers of somebody's before."""


def changed(examples: Sequence[bytes], random: Random) -> bytes:
    """An example with some changes: bytes, pieces put in, cut out, doubled, moved, or crossed with another example."""
    data = random.choice(examples)
    for _ in range(random.choice((1, 1, 1, 2, 3, 8))):
        data = _once(data, examples, random)
    return data[:200_000]


def _once(data: bytes, examples: Sequence[bytes], random: Random) -> bytes:
    start, end = sorted(random.randrange(len(data) + 1) for _ in range(2))
    end = min(end, start + random.choice((0, 1, 2, 4, 8, 16, 64, 100_000)))
    match random.randrange(7):
        case 0:
            return data[:start] + bytes([random.randrange(256)]) + data[start + 1 :]
        case 1:
            return data[:start] + random.choice(PIECES) + data[start:]
        case 2:
            return data[:start] + random.choice(PIECES) + data[end:]
        case 3:
            return data[:start] + data[end:]
        case 4:
            return data[:end] + data[start:]
        case 5:
            return data[:start] + data[start:end] * random.choice((2, 3, 50)) + data[end:]
        case _:
            other = random.choice(examples)
            at = random.randrange(len(other) + 1)
            return data[:start] + other[at:]
