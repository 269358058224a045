"""Loaded by each local worker: Ctrl-C at a terminal reaches all its processes, and ends the campaign by the one that was called."""

from __future__ import annotations

import signal


def dask_setup(_: object) -> None:
    """Leave an interrupt to the process that was called, which then ends its workers."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
