"""A machine for these tests: two receivers tell a place, and it is believed where they agree; between fixes it runs on."""

from __future__ import annotations

from safeloc.language.expr import FALSE, TRUE, Bool, Num, abs_, as_num, between, boolean, exact_to, ite, number
from safeloc.language.machine import ANY, Machine, Transition, current_mode, modes
from safeloc.language.spec import Property, always, reachable
from safeloc.language.system import lower
from safeloc.language.units import MM, NM, NM_PER_MM
from safeloc.language.world import Law, World
from safeloc.reported import Reported
from safeloc.target import Target

LINE_MM, FIX_MM, AGREE_MM, STEP_MM, WIDEST_MM = 1_000, 5, 3, 1, 12
TABLE = LOST, LOCATED = modes("LOST", "LOCATED")
MODE = current_mode(TABLE)
FIRST, SECOND = (number(f"{name}_mm", MM, -LINE_MM, LINE_MM) for name in ("first", "second"))
FIXED, RUN = boolean("fixed"), number("run_mm", MM, -9, 9)
PLACE, MARGIN = number("place_mm", MM, -2 * LINE_MM, 2 * LINE_MM), number("margin_mm", MM, 0, 50)
REACH = LINE_MM * NM_PER_MM
TRUTH, STEP = number("truth_nm", NM, -REACH, REACH), number("true_cycle_distance_nm", NM, -REACH, REACH)


def near(told: Num, most_mm: int) -> Bool:
    """What a receiver tells lies so near the true place after the step."""
    return FIXED.implies(between(-most_mm * NM_PER_MM, exact_to(told, NM) - TRUTH - STEP, most_mm * NM_PER_MM))


CLAUSES = {
    "the first receiver is right": Law(near(FIRST, FIX_MM), "The first receiver errs by 5 mm.", owner="supplier"),
    "the second receiver is right": Law(near(SECOND, FIX_MM), "The second one does.", owner="supplier"),
    "a run is measured": between(-STEP_MM * NM_PER_MM, STEP - exact_to(RUN, NM), STEP_MM * NM_PER_MM),
    "the line ends": between(TRUTH.low, TRUTH + STEP, TRUTH.high),
    "it is never fast": between(-100 * NM_PER_MM, STEP, 100 * NM_PER_MM),
}
"""The last one nothing needs: a measured run is short already."""


def machine() -> Machine:
    """Believes the first receiver where the second one agrees."""
    agree = FIXED & (abs_(FIRST - SECOND) <= AGREE_MM)
    wider = MARGIN + STEP_MM
    kept = (wider <= WIDEST_MM) & between(PLACE.low, PLACE + RUN, PLACE.high)
    world = World({TRUTH: ANY}, [STEP], {TRUTH: TRUTH + STEP}, CLAUSES)
    located = MODE.eq(LOCATED)
    gone = {PLACE: as_num(0, MM), MARGIN: as_num(0, MM)}
    return Machine(
        "receivers",
        TABLE,
        [FIRST, SECOND, FIXED, RUN],
        {PLACE: 0, MARGIN: 0},
        {
            "valid": located,
            "position_mm": ite(located, PLACE, 0),
            "margin_below_mm": ite(located, MARGIN, 0),
            "margin_above_mm": ite(located, MARGIN, 0),
        },
        [
            Transition("receivers contradict each other", TABLE, LOST, FIXED & ~agree, gone),
            Transition("fixed", TABLE, LOCATED, agree, {PLACE: FIRST, MARGIN: FIX_MM + AGREE_MM}, rank=1),
            Transition("run on", LOCATED, LOCATED, kept, {PLACE: PLACE + RUN, MARGIN: wider}, rank=2),
            Transition("too wide", LOCATED, LOST, TRUE, gone, rank=3),
        ],
        world=world,
        lemmas={"it lies inside": located.implies(inside())},
    )


def inside() -> Bool:
    """The interval holds the truth."""
    return between(-exact_to(MARGIN, NM), TRUTH - exact_to(PLACE, NM), exact_to(MARGIN, NM))


def claims() -> tuple[Property, ...]:
    """What is claimed of it."""
    return (
        always("containment", MODE.eq(LOCATED).implies(inside())),
        always("never wider", MARGIN <= WIDEST_MM, unconditional=True),
        always("nothing", FALSE.implies(MODE.eq(LOST)), unconditional=True),
        reachable("located", MODE.eq(LOCATED)),
    )


def target() -> Target:
    """The machine with its claims."""
    made = machine()
    return Target("receivers", (made,), lower(made), claims(), reported=Reported())
