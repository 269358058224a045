"""The axles of a cycle, as the section between the counters hears them: those of the counters' own heads, into the area and out of it.

At the low end who runs up comes in, at the high end who runs down. A fault of either head is one of the section, and so is a wheel on either.
"""

from __future__ import annotations

from safeloc.language.declared import Declared
from safeloc.language.expr import TRUE, Expr, Lit, Num, NumVar, as_num, boolean, choice, enumeration, ite, number
from safeloc.language.machine import Model, Transition, modes
from safeloc.language.rows import Updates
from safeloc.language.units import COUNT
from safeloc.models.axle_head import AXLE, DOWN, UP
from safeloc.models.fibre_device.configuration import SIDES, FibreDeviceConfig

NAME = "counted_axles"


class Parts:
    """The variables of the machine; pairs are of the low and of the high end.

    axle, axles    direction of the axles of this cycle, and their number
    fault, damped  the head is at fault; a wheel is on it
    into, out      state: axles that came into the area, and went out of it, in this cycle
    head_fault, head_damped  state: of either head
    """

    def __init__(self, config: FibreDeviceConfig) -> None:
        self.declared = declared = Declared()
        most = config.counter.axles_a_cycle
        self.axle = tuple(declared.sensor(choice(f"axle_{side}", enumeration(AXLE))) for side in SIDES)
        self.axles = tuple(declared.sensor(number(f"axles_{side}", COUNT, 1, most)) for side in SIDES)
        self.fault = tuple(declared.sensor(boolean(f"head_fault_{side}")) for side in SIDES)
        self.damped = tuple(declared.sensor(boolean(f"head_damped_{side}")) for side in SIDES)
        self.into = tuple(declared.state(number(f"axles_in_{side}", COUNT, 0, most), first=0) for side in SIDES)
        self.out = tuple(declared.state(number(f"axles_out_{side}", COUNT, 0, most), first=0) for side in SIDES)
        self.head_fault = declared.state(boolean("head_fault"), first=False)
        self.head_damped = declared.state(boolean("head_damped"), first=False)


CountedAxles = Model[Parts]


def build(own: Parts) -> CountedAxles:
    """Return the machine over the given variables."""
    table = modes("COUNTING")
    outputs: dict[str, Expr] = {one.name: one for one in (*own.into, *own.out)}
    outputs |= {one.name: one for one in (own.head_fault, own.head_damped)}
    machine = own.declared.machine(
        name=NAME,
        modes=table,
        outputs=outputs,
        transitions=[Transition("count", table[0], table[0], TRUE, _counts(own), ("FVA-2", "FVA-12"), 0)],
        doc="The axles of a cycle as the section between both counters hears them: those that the counters' heads report.",
    )
    return Model(machine, own)


def _counts(own: Parts) -> Updates:
    (low, high), (at_low, at_high) = own.axle, own.axles
    return {
        own.into[0]: _if(low, UP, at_low),
        own.out[0]: _if(low, DOWN, at_low),
        own.into[1]: _if(high, DOWN, at_high),
        own.out[1]: _if(high, UP, at_high),
        own.head_fault: own.fault[0] | own.fault[1],
        own.head_damped: own.damped[0] | own.damped[1],
    }


def _if(axle: NumVar, way: Lit, axles: NumVar) -> Num:
    return ite(axle.eq(way), axles, as_num(0, COUNT))
