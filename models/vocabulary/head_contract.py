"""The contract between a counting head and an axle counter, over one cycle of the counter (FVA-4).

`counts_every_axle` is proved of the head, of each row of samples that make a cycle (models.counting_head). The counter assumes less
of each of its cycles (models.axle_counter.world): `counts_every_axle_or_stays_damped`, which a head with a channel that stays damped keeps too.
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


def counts_every_axle_or_stays_damped(counted: Bool, *, fault: Bool, damped: Bool, missed: Bool) -> Bool:
    """Return whether a head that leaves an axle uncounted without a fault is damped from then on until it is at fault.

    counted   the cycle is reported as it was
    damped    the head is damped at the end of the cycle
    missed    an axle was left uncounted in an earlier cycle, and no fault came since
    """
    return (counted | damped) & (missed & ~fault).implies(damped)


def misses_an_axle(counted: Bool, *, fault: Bool, damped: Bool, missed: Bool) -> Bool:
    """Return whether an axle has been left uncounted, and neither a fault nor a free head came since."""
    return ~fault & damped & (missed | ~counted)
