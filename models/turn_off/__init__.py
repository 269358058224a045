"""Straight on or turning off at a switch, from the lateral motion of a reflector in view (RFL-12; source l. 169, 294).

Before the switch the image of a reflector ahead keeps its place beside the vehicle's axis. If the vehicle turns off, the
image moves to the other side; if it runs straight on, the image stays. The machine compares the course that it sees with
the one that map and movement authority give.

    IDLE      no switch in view
    BEFORE    a switch lies ahead, in view of a reflector behind it: the machine notes the reflector's lateral place
    OVER      the vehicle may be on the switch: the machine watches the lateral place
    DECIDED   straight on, left or right
    UNSEEN    the reflector was not measured long enough: only the next reflector's model can tell the course
"""

from __future__ import annotations

from collections.abc import Iterator

from safeloc.language.expr import TRUE, Bool, Lit, Num, abs_, as_num, ite
from safeloc.language.machine import Machine, Model, Transition, current_mode, modes
from safeloc.language.rows import Updates, together
from safeloc.language.units import COUNT
from safeloc.models.turn_off.variables import COURSE, LEFT, RIGHT, STRAIGHT, UNDECIDED, Parts, TurnOffConfig, parts
from safeloc.models.turn_off.world import world

__all__ = [
    "COURSE",
    "LEFT",
    "RIGHT",
    "STRAIGHT",
    "UNDECIDED",
    "Parts",
    "TurnOff",
    "TurnOffConfig",
    "build",
    "machine",
    "parts",
]
REQUIREMENTS = ("RFL-12",)


TurnOff = Model[Parts]


def machine(config: TurnOffConfig | None = None) -> Machine:
    """Return the turn-off machine (RFL-12)."""
    return build(parts(config or TurnOffConfig())).machine


def build(own: Parts) -> TurnOff:
    """Return the machine over the given variables."""
    table = modes("IDLE", "BEFORE", "OVER", "DECIDED", "UNSEEN")
    current = current_mode(table)
    _, _, over, decided, _ = table
    contradicts = current.eq(decided) & own.asked_course.ne(UNDECIDED) & own.asked_course.ne(own.course)
    made = own.declared.machine(
        name="turn_off",
        modes=table,
        outputs={"course": own.course, "contradicts": contradicts, "watching": current.eq(over)},
        transitions=list(_table(own, table)),
        world=world(own),
        lemmas=_lemmas(own, current, table),
        definitions={"the image moved by": own.motion, "surely before": own.before, "surely through": own.through},
        doc=(
            "Decides from the lateral motion of a reflector, in view over a switch, whether the vehicle runs straight on or "
            "turns off, and compares that with the course by map and movement authority. Assumed: the map gives a switch only "
            "while the whole interval lies before it, and from then on, until it gives another one, the radar measures the "
            "reflector behind that switch; lateral places are measured within their error; if the vehicle runs straight on, "
            "the image moves by no more than the sway; if it turns off, the image moves to the other side, beyond the turnout by "
            "at least the configured shift; the reported interval holds the true position."
        ),
    )
    return TurnOff(made, own)


def _table(own: Parts, table: tuple[Lit, ...]) -> Iterator[Transition]:
    idle, before, over, decided, unseen = table
    turn, straight = own.config.turn_mm, own.config.straight_mm
    asked: Updates = {own.asked_course: own.authorised_course}
    found: Updates = {own.unmeasured: 0}
    missed: Updates = {own.unmeasured: _misses(own)}
    nearer: Updates = {own.noted_lateral: ite(own.measured, own.lateral, own.noted_lateral)}
    noting = together(
        asked, found, {own.here: own.switch_position.value, own.noted_lateral: own.lateral, own.course: UNDECIDED}
    )
    unseen_on, watched, noted = together(asked, found), together(asked, missed), together(asked, missed, nearer)
    left, right, on = (together(asked, found, {own.course: course}) for course in (LEFT, RIGHT, STRAIGHT))
    forgotten: Updates = {own.here: own.here.low, own.course: UNDECIDED, own.asked_course: UNDECIDED}
    yield Transition("switch in view", table, before, own.announced, noting, REQUIREMENTS, 0)
    yield Transition("reflector unseen", (before, over), unseen, own.given_up, unseen_on, REQUIREMENTS, 1)
    yield Transition("still before", before, before, own.before, noted, REQUIREMENTS, 2)
    yield Transition("on the switch", before, over, ~own.before, watched, REQUIREMENTS, 2)
    yield Transition("backs off", over, before, own.before, watched, REQUIREMENTS, 2)
    yield Transition("turns left", over, decided, own.measured & (own.motion < -turn), left, REQUIREMENTS, 3)
    yield Transition("turns right", over, decided, own.measured & (own.motion > turn), right, REQUIREMENTS, 3)
    goes_on = own.measured & own.through & (abs_(own.motion) <= straight)
    yield Transition("runs straight on", over, decided, goes_on, on, REQUIREMENTS, 4)
    yield Transition("watch", over, over, TRUE, watched, REQUIREMENTS, 5)
    yield Transition("back before the switch", (decided, unseen), idle, own.before, forgotten, REQUIREMENTS, 5)
    yield Transition("course stays decided", decided, decided, TRUE, asked, REQUIREMENTS, 6)


def _misses(own: Parts) -> Num:
    """Return the cycles in a row without a measurement, this one included."""
    counted = ite(own.unmeasured >= own.unmeasured.high, own.unmeasured, own.unmeasured + 1)
    return ite(own.measured, as_num(0, COUNT), counted)


def _lemmas(own: Parts, current: Num, table: tuple[Lit, ...]) -> dict[str, Bool]:
    idle, before, over, decided, unseen = table
    noted = abs_(own.noted_lateral - own.true_lateral) <= own.config.lateral_error_mm
    return {
        "the noted place is true": current.one_of(before, over).implies(noted & own.true_course.ne(UNDECIDED)),
        "the switch is that of the measured reflector": current.one_of(before, over, decided, unseen).implies(
            own.here.eq(own.true_switch)
        ),
        "the decided course is true": current.eq(decided).implies(own.course.eq(own.true_course)),
        "no course before the decision": current.ne(decided).implies(own.course.eq(UNDECIDED)),
        "a decision has a course": current.eq(decided).implies(own.course.ne(UNDECIDED)),
        "no switch while idle": current.eq(idle).implies(own.here.eq(own.here.low)),
    }
