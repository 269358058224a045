"""The words in which a proxy introduces a vehicle (PROXY protocol, version 2)."""

from __future__ import annotations

from safeloc.runtime.service.introduction import COMMON_NAME, SIGNATURE, TLS

ADDRESSES = bytes([127, 0, 0, 1, 127, 0, 0, 1, 0x80, 0, 0x23, 0x28])
VERSION = 0x21


def part(kind: int, value: bytes) -> bytes:
    """One part: kind, length, value."""
    return bytes([kind]) + len(value).to_bytes(2, "big") + value


def tls(*names: bytes, client: int = 0x07, verified: int = 0) -> bytes:
    """The TLS part: what was checked, the version, and common names."""
    inner = part(VERSION, b"TLSv1.3") + b"".join(part(COMMON_NAME, name) for name in names)
    return part(TLS, bytes([client]) + verified.to_bytes(4, "big") + inner)


def header(parts: bytes, *, command: int = 0x21, family: int = 0x11, addresses: bytes = ADDRESSES) -> bytes:
    """A whole header."""
    rest = addresses + parts
    return SIGNATURE + bytes([command, family]) + len(rest).to_bytes(2, "big") + rest
