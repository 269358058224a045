"""Garbage collection in processes that were forked to prove, test or replay, and end soon."""

from __future__ import annotations

import gc

_RARELY = (50_000, 20, 50)
"""Thresholds of the collector's three generations. Python's own, 700, 10 and 10, take a twentieth of the processor time of `verify`: terms,
rows and runs are many small objects, of which few form cycles. Measured: the same memory, within 1 %."""


def collect_rarely() -> None:
    """Keep the collector away from inherited objects, since visiting them would copy every page, and let it look at new ones rarely."""
    gc.freeze()
    gc.set_threshold(*_RARELY)
