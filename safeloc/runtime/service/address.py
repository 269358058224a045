"""Addresses on this computer. There is no password on the wire, so other computers cannot connect."""

from __future__ import annotations

import ipaddress
import socket
from dataclasses import dataclass

from safeloc.errors import InputError


@dataclass(frozen=True)
class Address:
    """A port of the loopback interface; port 0 means any free port."""

    host: str
    port: int

    @property
    def family(self) -> socket.AddressFamily:
        """Return the family: IPv4 or IPv6."""
        return socket.AF_INET6 if ":" in self.host else socket.AF_INET


def address(text: str) -> Address:
    """Return the address in `9000`, `127.0.0.1:9000`, `localhost:9000` or `[::1]:9000`; InputError for anything else."""
    host, _, port = text.rpartition(":")
    host = {"": "127.0.0.1", "localhost": "127.0.0.1"}.get(host, host.strip("[]"))
    if not (port.isascii() and port.isdecimal() and int(port) < 65_536):
        raise InputError(f"{text!r} is no port; give a number up to 65535, or 127.0.0.1:NUMBER.")
    try:
        is_loopback = ipaddress.ip_address(host).is_loopback
    except ValueError as error:
        raise InputError(f"{text!r} is no address; give 127.0.0.1, localhost or [::1], and a port.") from error
    if not is_loopback:
        raise InputError(
            f"{host} is not on this computer; only loopback is served, since there is no password on the wire."
        )
    return Address(host, int(port))


def bound(where: Address, kind: socket.SocketKind) -> socket.socket:
    """Return a socket that is bound to the address; InputError if the port is taken."""
    made = socket.socket(where.family, kind)
    made.setblocking(False)
    if kind == socket.SOCK_STREAM:
        made.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
    try:
        made.bind((where.host, where.port))
    except OSError as error:
        made.close()
        raise InputError(f"port {where.port} of {where.host} is not available: {error.strerror}.") from error
    return made
