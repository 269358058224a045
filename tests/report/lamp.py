"""A small machine with one property that is proved, one that is violated and one that is left undecided."""

from __future__ import annotations

from functools import cache

from safeloc.catalogue import Target
from safeloc.language.expr import boolean, number
from safeloc.language.machine import Machine, Transition, modes
from safeloc.language.spec import Property, always, never
from safeloc.language.system import lower
from safeloc.language.units import COUNT
from safeloc.language.verdict import Unknown
from safeloc.language.world import World
from safeloc.proof.provers.limits import Limits
from safeloc.proof.provers.portfolio import prove
from safeloc.proof.results import Finding

DOC = "<script>alert('doc')</script> & more"
DARK, LIT = modes("DARK", "LIT")
press, wear = boolean("press"), number("wear", COUNT, 0, 100)
machine = Machine(
    "lamp",
    modes=(DARK, LIT),
    inputs=[press],
    state={wear: 0},
    outputs={"wear": wear},
    transitions=[
        Transition("switch <on>", DARK, LIT, press, {wear: wear + 1}, requirements=("MRK-1",)),
        Transition("burnt out", LIT, DARK, wear >= 3, requirements=("MRK-1", "MRK-D1"), rank=0),
        Transition("switch off", LIT, DARK, ~press, rank=1),
    ],
    world=World(clauses={"assumption": wear < 100}, reads_machine="the test asks it"),
    doc=DOC,
)
PROPERTIES = (
    always("new", machine.mode.eq(LIT).implies(wear >= 1), statement="light wears", requirements=("MRK-1",)),
    never(
        "wears & tears", wear > 1, statement="never <b>twice</b>", requirements=("MRK-D1",), assumption="few presses"
    ),
)
UNDECIDED = Finding(
    "lamp/property/later", "lamp", "property", "something later", Unknown("no <i>time</i>", 4), "none", 0.5, ("MRK-D1",)
)


@cache
def target() -> Target:
    """The machine as the catalogue has it."""
    properties: tuple[Property, ...] = PROPERTIES
    return Target("lamp", (machine,), lower(machine), properties, doc=machine.doc)


@cache
def findings() -> tuple[Finding, ...]:
    """Proved, violated, and undecided."""
    one = target()
    return (*prove(one.system, one.properties, Limits(depth=8, seconds=20)), UNDECIDED)
