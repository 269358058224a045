"""The contract between a counting head and an axle counter, over one cycle of the counter (FVA-4).

The counter assumes it of each of its cycles (models.axle_counter.world); of the head it is proved of each row of samples that make a
cycle (models.counting_head). Both sides call this one function.
"""

from __future__ import annotations

from safeloc.language.expr import Bool, Num, ite
from safeloc.models.axle_head.variables import DOWN, NO_AXLE, UP


def counts_every_axle(*, fault: Bool, axle: Num, number: Num, passed: Num, upwards: Bool, downwards: Bool) -> Bool:
    """Return whether a cycle without a fault is reported as it was.

    axle, number         the direction that is reported of all axles of the cycle, and their number
    passed               axles that truly passed in the cycle
    upwards, downwards   all of them passed in this direction
    """
    reported = ite(axle.eq(NO_AXLE), 0, number)
    way = axle.eq(UP).implies(upwards) & axle.eq(DOWN).implies(downwards)
    return (~fault).implies(passed.eq(reported) & way)
