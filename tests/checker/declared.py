"""Small declarations with everything that the checker has a rule for; loaded by name, as a user's own would be."""

from __future__ import annotations

from safeloc.language.composition import Composition, compose
from safeloc.language.expr import TRUE, Expr, Var, before, between, boolean, ite, minimum, number, optional
from safeloc.language.machine import Machine, Transition, current_mode, modes
from safeloc.language.nodes import INT64_MAX
from safeloc.language.spec import Property, always, earlier_bool, previous, reachable, within
from safeloc.language.units import COUNT
from safeloc.language.world import World

LOW, HIGH = modes("LOW", "HIGH")
MODE = current_mode((LOW, HIGH))
TICK, RISE = boolean("tick"), optional("rise", COUNT, 1, 3)
LEVEL, LAST, WIDE = number("level", COUNT, 0, 10), number("last", COUNT, 0, 10), number("wide", COUNT, 0, INT64_MAX)
TRUTH, STEP = number("truth", COUNT, 0, 20), number("true step", COUNT, 0, 1)
ROSE = RISE.present & TICK

counting = Machine(
    name="counting",
    modes=(LOW, HIGH),
    inputs=[TICK, RISE],
    state={LEVEL: 0, LAST: 0, WIDE: 5},
    outputs={"level": LEVEL},
    transitions=[
        Transition("full", HIGH, LOW, TICK & (LEVEL >= 8), {LEVEL: 0, LAST: LEVEL}),
        Transition("over", LOW, HIGH, ROSE & between(3, LEVEL, 7), {LEVEL: LEVEL + 1, LAST: LEVEL}, rank=1),
        Transition("up", LOW, LOW, ROSE & (LEVEL < 3), {LEVEL: LEVEL + RISE.value, LAST: LEVEL}, rank=1),
        Transition(
            "run on",
            HIGH,
            HIGH,
            TICK & (LEVEL < 8),
            {LEVEL: LEVEL + 1, LAST: LEVEL, WIDE: ite(WIDE <= 9, WIDE * 2, 5)},
            rank=2,
        ),
    ],
    world=World(
        ghosts={TRUTH: 0},
        choices=[STEP],
        moves={TRUTH: minimum(TRUTH + STEP, 20)},
        clauses={"assumption": (STEP >= 1).implies(TICK)},
    ),
    lemmas={
        "low is low": MODE.eq(LOW).implies(LEVEL <= 7),
        "narrow": WIDE <= 18,
        "never far": (LEVEL <= 8) | (TRUTH < 0),
    },
)
"""One machine by itself."""

GO, LEVEL_A = boolean("go"), number("level", COUNT, 0, 3)
HEARD, KEPT, SEEN = number("heard", COUNT, 0, 5), number("kept", COUNT, 0, 5), boolean("seen")
(ONLY,) = modes("ONLY")
source = Machine(
    "source",
    (ONLY,),
    [GO],
    {LEVEL_A: 1},
    {"level": LEVEL_A},
    [Transition("turn", ONLY, ONLY, GO, {LEVEL_A: 4 - LEVEL_A})],
    lemmas={"never nothing": LEVEL_A >= 1},
)
listener = Machine(
    "listener",
    (ONLY,),
    [HEARD],
    {KEPT: 1, SEEN: False},
    {"kept": KEPT},
    [Transition("keep", ONLY, ONLY, TRUE, {KEPT: HEARD, SEEN: HEARD >= 2})],
    world=World(clauses={"assumption": HEARD >= 1}),
    lemmas={"keeps something": KEPT >= 1},
)
_wires: dict[Var, Expr] = {HEARD: source.output("level")}
whole = compose("whole", [source, listener], _wires, discharge=[listener])
"""Two machines; what the second assumes the first keeps."""


JUMP, LEVEL_B = boolean("jump"), number("level", COUNT, 0, 3)
leaper = Machine(
    "leaper",
    (ONLY,),
    [GO, JUMP],
    {LEVEL_B: 1},
    {"level": LEVEL_B},
    [Transition("leap", ONLY, ONLY, JUMP, {LEVEL_B: 2}), Transition("stay", ONLY, ONLY, ~JUMP)],
    world=World(clauses={"assumption": ~JUMP}),
    lemmas={"never nothing": LEVEL_B >= 1},
)
_tells: dict[Var, Expr] = {HEARD: leaper.output("level")}
pair = compose("pair", [leaper, listener], _tells, discharge=[listener])
"""A row of the first machine fires only where the assumption is broken: it is shown of that machine by itself."""


LEFT, RIGHT, FAR = number("left", COUNT, 0, 10), number("right", COUNT, 0, 10), number("far", COUNT, 0, INT64_MAX)
twins = Machine(
    "twins",
    (ONLY,),
    [TICK],
    {LEFT: 0, RIGHT: 0, FAR: 5},
    {},
    [
        Transition("wrap", ONLY, ONLY, TICK & (LEFT >= 10), {LEFT: 0, RIGHT: 0}),
        Transition("count", ONLY, ONLY, TICK, {LEFT: LEFT + 1, RIGHT: minimum(RIGHT + 1, 10)}, rank=1),
        Transition("double", ONLY, ONLY, ~TICK & LEFT.eq(RIGHT), {FAR: ite(FAR <= 9, FAR * 2, 5)}, rank=2),
        Transition("never", ONLY, ONLY, ~TICK & (LEFT >= RIGHT + 1), rank=2),
        Transition("nor this", ONLY, ONLY, ~TICK & (RIGHT >= LEFT + 1), rank=2),
        Transition("nor now", ONLY, ONLY, ~TICK & (RIGHT >= LEFT + 2), rank=3),
        Transition("nor then", ONLY, ONLY, ~TICK & (RIGHT >= 5) & (LEFT <= 2), rank=3),
    ],
)
"""What one look at a step does not show: invariants, and proofs of obligations of their own."""


PLACE, READ, MOVED = number("place", COUNT, 0, 50), optional("read", COUNT, 0, 60), number("moved", COUNT, -3, 3)
KNOWN = number("known", COUNT, 0, 60)
tracking = Machine(
    name="tracking",
    modes=(ONLY,),
    inputs=[TICK, READ],
    state={KNOWN: 25},
    outputs={},
    transitions=[Transition("read", ONLY, ONLY, READ.present, {KNOWN: READ.value})],
    world=World(
        ghosts={PLACE: 25},
        choices=[MOVED],
        moves={PLACE: PLACE + MOVED},
        clauses={
            "assumption": READ.present
            & between(PLACE, READ.value, PLACE + 2)
            & between(1, PLACE + MOVED, 49)
            & ((MOVED >= 1) | (MOVED <= -1))
        },
    ),
)
"""What it hears is never at rest: lawful inputs are terms over state, and more than one is needed."""


CODE, CODED = number("code", COUNT, 0, 3), number("coded", COUNT, 0, 3)
coded = Machine(
    name="coded",
    modes=(ONLY,),
    inputs=[CODE],
    state={CODED: 0},
    outputs={},
    transitions=[Transition("read", ONLY, ONLY, TRUE, {CODED: CODE})],
    world=World(
        ghosts={TRUTH: 0},
        choices=[STEP],
        moves={TRUTH: minimum(TRUTH + STEP, 20)},
        clauses={"assumption": CODE.eq(0) | (TRUTH >= 1)},
    ),
)
"""Some input is lawful whatever the ghost is: the condition that shows this reads the ghost, and needs no fact about it."""


def made_of(figures: dict[str, int]) -> Machine:
    """A machine whose range is the user's."""
    level = number("level", COUNT, 0, figures["highest"])
    turn = Transition("turn", ONLY, ONLY, TICK, {level: ite(level < figures["highest"], level + 1, 0)})
    return Machine("made", (ONLY,), [TICK], {level: 0}, {}, [turn])


def properties(found: Machine | Composition) -> list[Property]:
    """What is to be proved of each."""
    if isinstance(found, Machine) and found.name == "made":
        return []
    if found is coded:
        return [always("no code before the truth", CODED.eq(0) | (TRUTH >= 1)), reachable("a code", CODED.eq(3))]
    if found is tracking:
        return [always("known is near", before(PLACE) <= KNOWN)]
    if found is twins:
        return [always("full together", RIGHT.eq(10).implies(LEFT.eq(10)))]
    if isinstance(found, Machine):
        return [
            always("never above eight", LEVEL <= 8, unconditional=True),
            always("one more or none", LEVEL <= before(LEVEL) + 3),
            always("last follows", previous(LEVEL.eq(5)).implies(LAST.eq(5) | LEVEL.eq(5)), unconditional=True),
            within(
                "answered",
                2,
                earlier_bool(MODE.eq(LOW)) & MODE.eq(HIGH),
                LEVEL >= 4,
                helper=lambda waited: (waited > 0).implies(MODE.eq(HIGH)),
            ),
            reachable("it comes to eight", LEVEL.eq(8)),
        ]
    if found is pair:
        return []
    return [
        always("kept is small", found.of(listener).num(KEPT) <= 3),
        found.inherited(listener, always("keeps what it hears", KEPT >= 1)),
        found.inherited(listener, always("heard is something", HEARD >= 1)),
    ]
