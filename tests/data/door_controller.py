"""A user's own machine: a train door that opens only at standstill and reports a closed and locked door."""

from safeloc.language.expr import TRUE, boolean, number
from safeloc.language.machine import Machine, Transition, modes
from safeloc.language.spec import always, never, reachable, within
from safeloc.language.units import MM_S, MS

STANDSTILL_MM_S = 100
CLOSING_MS = 3_000
CYCLE_MS = 500

LOCKED, OPEN, CLOSING = modes("LOCKED", "OPEN", "CLOSING")
speed = number("speed", MM_S, 0, 100_000)
released = boolean("released")
blocked = boolean("blocked")
closing_for = number("closing_for", MS, 0, CLOSING_MS)

machine = Machine(
    "door",
    modes=(LOCKED, OPEN, CLOSING),
    inputs=[speed, released, blocked],
    state={closing_for: 0},
    outputs={"closing_for": closing_for},
    transitions=[
        Transition("open", LOCKED, OPEN, released & (speed <= STANDSTILL_MM_S)),
        Transition("start to close", OPEN, CLOSING, ~released, {closing_for: 0}),
        Transition("obstacle", CLOSING, OPEN, blocked, {closing_for: 0}),
        Transition("lock", CLOSING, LOCKED, closing_for + CYCLE_MS >= CLOSING_MS, {closing_for: 0}, rank=1),
        Transition("close", CLOSING, CLOSING, TRUE, {closing_for: closing_for + CYCLE_MS}, rank=2),
    ],
    doc="A train door: opened at standstill on release, closed within three seconds, opened again by an obstacle.",
)

properties = [
    never("opens at speed", machine.fired("open") & (speed > STANDSTILL_MM_S), statement="no opening while it moves"),
    always("clock at rest", machine.mode.eq(LOCKED).implies(closing_for.eq(0)), statement="a locked door has no clock"),
    within("closes", 6, machine.fired("start to close"), machine.mode.eq(LOCKED) | blocked, statement="locked in 3 s"),
    reachable("opens", machine.mode.eq(OPEN), statement="the door can be opened"),
]
