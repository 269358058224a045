"""What must hold of a counting head (FVA-4, FVA-5)."""

from __future__ import annotations

from safeloc.language.expr import before, was
from safeloc.language.spec import Property, always, reachable
from safeloc.models.axle_head import DOWN, NO_AXLE, OFF, OVER_A, OVER_B, OVER_BOTH, UP, AxleHead

TRACE = ("FVA-4", "FVA-5")
LAW = "one wheel at a time, sampled often enough, and no false damping"


def properties(model: AxleHead) -> list[Property]:
    """Every axle is counted once, in its direction; nothing else is."""
    machine, own = model.machine, model.own
    free, *_, disturbed = machine.modes
    mode = machine.mode
    leaves = before(own.place).ne(OFF) & own.place.eq(OFF)
    through_up = leaves & before(own.place).eq(OVER_B) & was(own.from_low)
    heard = own.a.iff(own.place.one_of(OVER_A, OVER_BOTH)) & own.b.iff(own.place.one_of(OVER_B, OVER_BOTH))
    through_down = leaves & before(own.place).eq(OVER_A) & ~was(own.from_low)
    return [
        always(
            "every axle is counted",
            own.axle.eq(UP).iff(through_up) & own.axle.eq(DOWN).iff(through_down),
            statement="an axle is counted upwards in exactly the sample in which a wheel from below left above; and downwards",
            requirements=TRACE,
            assumption=LAW,
        ),
        always(
            "no disturbance by wheels",
            heard.implies(~machine.flag("disturbed")),
            statement="wheels alone, also those that turn back on the head, never disturb it",
            requirements=TRACE,
            assumption=LAW,
        ),
        always(
            "no axle without overlap",
            own.axle.ne(NO_AXLE).implies(machine.fired("axle upwards", "axle downwards") & ~own.a & ~own.b),
            statement="an axle is counted only at the end of the whole sequence",
            requirements=TRACE,
            unconditional=True,
        ),
        always(
            "unknown direction disturbs",
            (before(mode).eq(free) & own.a & own.b).implies(mode.eq(disturbed)),
            statement="both channels at once tell no direction: the head is disturbed in that sample",
            requirements=TRACE,
            unconditional=True,
        ),
        always(
            "a disturbed head counts nothing",
            (before(mode).eq(disturbed) | mode.eq(disturbed)).implies(own.axle.eq(NO_AXLE)),
            statement="while disturbed, and in the sample in which that ends, no axle is counted",
            requirements=TRACE,
            unconditional=True,
        ),
        reachable("axle upwards", own.axle.eq(UP), statement="axles are counted upwards", requirements=TRACE),
        reachable("axle downwards", own.axle.eq(DOWN), statement="axles are counted downwards", requirements=TRACE),
    ]
