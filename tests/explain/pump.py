"""A machine with a property of each fate: violated, proved, late, and undecided by induction alone."""

from __future__ import annotations

from safeloc.catalogue import Target
from safeloc.language.expr import before, boolean, ite, maximum, number, optional
from safeloc.language.machine import ANY, Machine, Transition, modes
from safeloc.language.spec import Property, always, never, once, reachable, within
from safeloc.language.system import lower
from safeloc.language.units import COUNT

OFF, ON, COOL = modes("OFF", "ON", "COOL")
go, extra = boolean("go"), optional("extra", COUNT, 0, 3)
strokes, counted, hot = number("strokes", COUNT, 0, 100), number("counted", COUNT, 0, 100), boolean("hot")
label = number("label", COUNT, 0, 9)
machine = Machine(
    name="pump",
    modes=(OFF, ON, COOL),
    inputs=[go, extra],
    state={strokes: 0, counted: 0, hot: False, label: ANY},
    outputs={"strokes": strokes, "left": ite(hot, 9 - strokes, 0)},
    transitions=[
        Transition("begin", OFF, ON, go, {strokes: 0, counted: 0, hot: True}),
        Transition("count", ON, ON, strokes < 9, {strokes: strokes + 1, counted: counted + 1}, rank=0),
        Transition("cool", ON, COOL, strokes >= 9, {hot: False}, rank=1),
        Transition("rest", COOL, OFF, go & extra.present),
    ],
)
is_on = machine.mode.eq(ON)
TOO_MANY = never(
    "too many strokes", (strokes > 3) & (maximum(strokes, counted) > 2) & hot, statement="at most 3 strokes"
)
LATE = within("off soon", 3, is_on, machine.mode.eq(OFF))
FALLS = always("strokes never fall", is_on.implies(strokes >= before(strokes)) & ~(once(hot) & machine.mode.eq(COOL)))
KEPT = never("cold while on", is_on & ~hot, requirements=("MRK-1",))
OPEN = never("counted too high", counted > 20)
COMES = reachable("cools", machine.mode.eq(COOL))
FEW_LEFT = always("six left", machine.output("left") >= 6)
AT_FIRST = never("label 7", label.eq(7))


def target(*properties: Property) -> Target:
    """The pump with these properties."""
    return Target("pump", (machine,), lower(machine), properties, doc=machine.doc)
