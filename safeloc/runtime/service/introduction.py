"""The proxy's header before the first line of a connection, with the name of the vehicle whose certificate was checked.

This is the header of the PROXY protocol, version 2, with its TLS part, as HAProxy's `send-proxy-v2-ssl-cn` sends it
(https://www.haproxy.org/download/2.6/doc/proxy-protocol.txt, sections 2.2 and 2.2.6). The common name of the
certificate is the vehicle's name. A header that does not identify the sender is refused.
"""

from __future__ import annotations

from collections.abc import Iterator

from safeloc.errors import InputError
from safeloc.runtime.outside import quoted
from safeloc.runtime.service.messages import VEHICLE

SIGNATURE = b"\r\n\r\n\0\r\nQUIT\n"
_FIXED = 16
"""Bytes of signature, command, family and length."""

LONGEST = 4_096
"""Most bytes of the rest; with a name of 64 letters it has about a hundred."""

_PROXIED = 0x21
"""Version 2, for a client; with 0x20 the proxy only checks that this process is running."""

_BYTES_OF_ADDRESSES = {0x1: 12, 0x2: 36, 0x3: 216}
"""IPv4, IPv6 and Unix, by the upper half of the family's byte; 0 means no addresses."""

TLS, COMMON_NAME = 0x20, 0x22
_OVER_TLS, WITH_CERTIFICATE = 0x01, 0x06
"""Bits of the TLS part; the certificate was given in this connection, or in the session that it resumes."""


class Introduction:
    """A reader of the header at the beginning of a connection.

    vehicle   the only one for which the peer may send; None while the header is incomplete
    """

    def __init__(self) -> None:
        self.vehicle: str | None = None
        self._header = b""

    def after(self, data: bytes) -> bytes:
        """Return the data after the header, as it arrives; InputError if there is no header, or it names no vehicle."""
        if self.vehicle is not None:
            return data
        self._header += data
        end = _end(self._header)
        if end is None or len(self._header) < end:
            return b""
        self.vehicle = _vehicle(self._header[:end])
        rest, self._header = self._header[end:], b""
        return rest


def _end(data: bytes) -> int | None:
    """Return the end of the header; None while unknown. InputError as soon as the data cannot be a header."""
    if not SIGNATURE.startswith(data[: len(SIGNATURE)]):
        raise InputError("no PROXY header of version 2; only the proxy may connect here, with send-proxy-v2-ssl-cn")
    if len(data) < _FIXED:
        return None
    length = int.from_bytes(data[14:_FIXED], "big")
    if length > LONGEST:
        raise InputError(f"a PROXY header of {length} bytes; at most {LONGEST} are read")
    return _FIXED + length


def _vehicle(header: bytes) -> str:
    """Return the name in the certificate; InputError if no certificate was checked, or if it cannot name a vehicle."""
    if header[12] != _PROXIED:
        raise InputError("the proxy connects for itself and names no vehicle")
    family = header[13] >> 4
    if family and family not in _BYTES_OF_ADDRESSES:
        raise InputError(f"a PROXY header with addresses of unknown kind {family}")
    parts = _only(header[_FIXED + _BYTES_OF_ADDRESSES.get(family, 0) :], TLS, "TLS part: no send-proxy-v2-ssl-cn")
    client, verified = parts[:1], parts[1:5]
    if len(verified) < 4 or not client[0] & _OVER_TLS or not client[0] & WITH_CERTIFICATE or any(verified):
        raise InputError("the proxy got no valid certificate; configure it with `verify required`")
    return _named(_only(parts[5:], COMMON_NAME, "common name: the certificate has none"))


def _named(common_name: bytes) -> str:
    name = common_name.decode("latin-1")
    if not VEHICLE.fullmatch(name):
        raise InputError(f"the certificate is of {quoted(name)}, which cannot be the name of a vehicle")
    return name


def _only(data: bytes, kind: int, what: str) -> bytes:
    """Return the only part of this kind; InputError if there is none, or more than one."""
    found = [value for each, value in _parts(data) if each == kind]
    if len(found) != 1:
        raise InputError(f"a PROXY header with {len(found)} times a {what}")
    return found[0]


def _parts(data: bytes) -> Iterator[tuple[int, bytes]]:
    """Yield kind and value of each part: one byte of kind, two of length, and the value."""
    while data:
        length = int.from_bytes(data[1:3], "big")
        if len(data) < 3 + length:
            raise InputError("a PROXY header that ends within one of its parts")
        yield data[0], data[3 : 3 + length]
        data = data[3 + length :]
