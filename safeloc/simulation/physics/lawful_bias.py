"""The systematic error of a sensor that explains all that it measured, if any does: it changes slowly, and begins with any size.

In every cycle what was measured permits a stretch of errors. The possible ones are that stretch as far as it can be reached from those of the
cycle before; where nothing is left of it, none explains the cycle, and the error is the reachable one that is nearest. Backwards from
the last cycle, one error of each stretch is then taken (as `lawful_wander` does).
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Whole = NDArray[np.int64]
FREE = 1 << 60
"""End of a stretch in a cycle that permits every error."""


def lawful_bias(low: Whole, high: Whole, most_change: int) -> Whole:
    """Return the error in each cycle, as near to 0 as can be at the end: arrays [cycle, vehicle].

    low, high    ends of the stretch that each cycle permits; -FREE and FREE where it permits all
    most_change  the greatest change from one cycle to the next
    """
    least, most = np.empty_like(low), np.empty_like(high)
    below, above = np.full(low.shape[1:], -FREE), np.full(low.shape[1:], FREE)
    for cycle, (begin, end) in enumerate(zip(low, high, strict=True)):
        from_, to = np.maximum(below - most_change, -FREE), np.minimum(above + most_change, FREE)
        below, above = (np.minimum(np.maximum(one, from_), to) for one in (begin, end))
        none = below > above  # the cycle permits nothing, whatever was before
        below, above = np.where(none, from_, below), np.where(none, to, above)
        least[cycle], most[cycle] = below, above
    found = np.empty_like(low)
    now = np.zeros(low.shape[1:], dtype=np.int64)
    for cycle in range(len(low) - 1, -1, -1):
        now = np.minimum(np.maximum(now, least[cycle]), most[cycle])
        found[cycle] = now
    return found
