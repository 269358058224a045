"""A port that nobody listens on."""

from __future__ import annotations

import socket


def free_port() -> int:
    """One of this computer that nobody listens on now."""
    with socket.socket() as made:
        made.bind(("127.0.0.1", 0))
        return int(made.getsockname()[1])
