"""Properties of the turn-off seen in the radar image (RFL-12)."""

from __future__ import annotations

from collections.abc import Iterator
from functools import partial

from safeloc.language.expr import Bool, all_of, before, between, ite
from safeloc.language.spec import Property, always, earlier_bool, earlier_num, reachable
from safeloc.models.turn_off import TurnOff
from safeloc.models.turn_off.variables import COURSE, LEFT, RIGHT, STRAIGHT, UNDECIDED, Parts

LAW = (
    "the map gives a switch while it lies ahead, with its reflector; lateral places are measured within their error; the image "
    "of a reflector moves as geometry demands on straight track and in a turnout"
)
REQUIREMENTS = ("RFL-12",)
for_all_inputs = partial(always, requirements=REQUIREMENTS, unconditional=True)
under_assumption = partial(always, requirements=REQUIREMENTS, assumption=LAW)


def properties(model: TurnOff) -> list[Property]:
    """Return every property of the turn-off machine."""
    makers = (
        _course,
        _contradiction,
        _decided,
        _straight,
        _turning,
        _noting,
        _watched,
        _given_up,
        _misses,
        _backs_off,
        _announced,
    )
    return [prop for maker in makers for prop in maker(model)]


def _was_watching(model: TurnOff) -> Bool:
    return earlier_bool(model.machine.flag("watching"))


def _same_switch(own: Parts) -> Bool:
    """Return whether the map gives no other switch, or the radar does not measure its reflector."""
    return ~own.switch_position.present | own.switch_position.value.eq(before(own.here)) | ~own.measured


def _course(model: TurnOff) -> Iterator[Property]:
    """Yield that a stated course is true."""
    machine, own = model.machine, model.own
    course = machine.output("course")
    yield under_assumption(
        "course is true",
        all_of(course.eq(label).implies(own.true_course.eq(label)) for label in COURSE[1:]),
        statement="the machine states straight, left or right only if the vehicle takes that course",
    )
    yield for_all_inputs(
        "course only after the switch",
        machine.mode.eq(machine.modes[3]).iff(course.ne(UNDECIDED)),
        statement="the machine states a course exactly while the lateral motion has decided",
    )


def _contradiction(model: TurnOff) -> Iterator[Property]:
    machine, own = model.machine, model.own
    course = machine.output("course")
    known = own.authorised_course.ne(UNDECIDED) & course.ne(UNDECIDED)
    yield for_all_inputs(
        "contradiction",
        machine.flag("contradicts").iff(known & course.ne(own.authorised_course)),
        statement="the machine reports a contradiction exactly in the steps in which it states another course than map and movement "
        "authority",
    )
    yield reachable(
        "a contradiction is found",
        machine.flag("contradicts"),
        statement="the machine can notice a vehicle that takes another course than authorised",
        requirements=REQUIREMENTS,
    )


def _decided(model: TurnOff) -> Iterator[Property]:
    """Yield that a turn is stated once it must show, and not before it can show."""
    machine, own, config = model.machine, model.own, model.own.config
    through = (own.low - own.true_switch >= config.decide_mm) & (own.low - own.true_switch <= config.give_up_mm)
    yield under_assumption(
        "beyond the turnout a measured image decides",
        (
            _was_watching(model) & own.measured & ~own.switch_position.present & through & (own.high >= own.true_switch)
        ).implies(machine.output("course").eq(own.true_course)),
        statement="surely beyond the turnout, the first measurement of the reflector behind the switch leads to the true course",
    )
    newly = machine.output("course").ne(earlier_num(machine.output("course")))
    yield for_all_inputs(
        "a course is stated on a measurement over the switch",
        (newly & machine.output("course").ne(UNDECIDED)).implies(
            _was_watching(model) & own.measured & (own.high >= own.here)
        ),
        statement="the machine newly states a course only if the vehicle may be on the switch and the radar measures its reflector",
    )


def _straight(model: TurnOff) -> Iterator[Property]:
    machine, own, config = model.machine, model.own, model.own.config
    course = machine.output("course")
    moved = own.lateral - before(own.noted_lateral)
    yield for_all_inputs(
        "straight only beyond the turnout",
        (course.eq(STRAIGHT) & earlier_num(course).ne(STRAIGHT)).implies(
            own.measured
            & (own.low - before(own.here) >= config.decide_mm)
            & between(-config.straight_mm, moved, config.straight_mm)
        ),
        statement="the machine states straight on only when the vehicle is surely beyond the turnout and a turn would show",
    )


def _turning(model: TurnOff) -> Iterator[Property]:
    """Yield that a turn is stated with the first measurement that shows it, to the millimetre."""
    machine, own, turn_mm = model.machine, model.own, model.own.config.turn_mm
    watched = _was_watching(model) & _same_switch(own) & machine.mode.one_of(*machine.modes[2:4])
    to_right_mm = before(own.noted_lateral) - own.lateral
    for words, course, shown in (("left", LEFT, to_right_mm > turn_mm), ("right", RIGHT, to_right_mm + turn_mm < 0)):
        yield for_all_inputs(
            f"a turn to the {words} is stated when it shows",
            watched.implies(machine.output("course").eq(course).iff(own.measured & shown)),
            statement=f"over the switch the machine states a turn to the {words} exactly when a measured image has moved to "
            "the other side by more than the least motion of a turn",
        )


def _noting(model: TurnOff) -> Iterator[Property]:
    machine, own = model.machine, model.own
    _, ahead, over, *_ = machine.modes
    yield for_all_inputs(
        "the noted place is from before the switch",
        machine.mode.one_of(over, ahead).implies(
            own.noted_lateral.eq(before(own.noted_lateral))
            | (own.noted_lateral.eq(own.lateral) & own.measured & (own.high < own.here))
        ),
        statement="the machine notes a lateral place only from a measurement while the vehicle is surely before the switch",
    )
    yield for_all_inputs(
        "the last place before the switch is noted",
        (machine.mode.eq(ahead) & before(machine.mode).eq(ahead) & own.measured).implies(
            own.noted_lateral.eq(own.lateral)
        ),
        statement="before the switch the machine notes the lateral place anew with every measurement",
    )
    error = own.config.lateral_error_mm
    yield under_assumption(
        "the noted place is the reflector's",
        machine.mode.one_of(over, ahead).implies(between(-error, own.true_lateral - own.noted_lateral, error)),
        statement="the noted place is the true lateral place of the reflector behind the switch, within the lateral error",
    )


def _watched(model: TurnOff) -> Iterator[Property]:
    machine, own = model.machine, model.own
    idle, ahead, over, *_ = machine.modes
    yield for_all_inputs(
        "watched from the switch on",
        machine.mode.eq(ahead).implies(own.high < own.here) & machine.mode.eq(over).implies(own.high >= own.here),
        statement="the machine watches the image exactly while the vehicle may be on the switch",
    )
    yield for_all_inputs(
        "the switch is that of the map",
        (own.here.ne(before(own.here)) & machine.mode.ne(idle)).implies(
            own.switch_position.present & own.here.eq(own.switch_position.value) & machine.mode.eq(ahead)
        ),
        statement="the machine watches another switch only if the map gives it",
    )


def _given_up(model: TurnOff) -> Iterator[Property]:
    machine, own, config = model.machine, model.own, model.own.config
    idle, _, over, _, unseen = machine.modes
    far = own.low - before(own.here) > config.give_up_mm
    unmeasured = (before(own.unmeasured) > config.miss_limit_cycles - 1) & ~own.measured
    yield for_all_inputs(
        "given up only without an image",
        (machine.mode.eq(unseen) & before(machine.mode).ne(unseen)).implies(far | unmeasured),
        statement="the machine gives the decision up only far beyond the switch, or after too many cycles without a measurement",
    )
    yield for_all_inputs(
        "given up in the end",
        (machine.mode.eq(over) & _was_watching(model)).implies(~far & ~unmeasured),
        statement="far beyond the switch, or after too many cycles without a measurement, the machine stops watching the image",
    )
    yield for_all_inputs(
        "an image of another reflector decides nothing",
        (own.measured & own.switch_position.present & own.switch_position.value.ne(before(own.here)) & (own.high < own.switch_position.value))
        .implies(machine.output("course").eq(UNDECIDED) & machine.mode.ne(idle)),
        statement="when the radar measures the reflector behind another switch ahead, the machine watches that switch and states no course")  # fmt: skip


def _misses(model: TurnOff) -> Iterator[Property]:
    own, machine = model.own, model.machine
    _, ahead, over, *_ = machine.modes
    one_more = ite(
        before(own.unmeasured) < own.config.miss_limit_cycles, before(own.unmeasured) + 1, before(own.unmeasured)
    )
    yield for_all_inputs(
        "cycles without a measurement are counted",
        machine.mode.one_of(ahead, over).implies(own.unmeasured.eq(ite(~own.measured, one_more, 0))),
        statement="while it watches the image, before and on the switch, the machine counts cycles in a row without a measurement",
    )


def _backs_off(model: TurnOff) -> Iterator[Property]:
    machine, own = model.machine, model.own
    idle, ahead, over, _, unseen = machine.modes
    ran_over = ~before(machine.mode).one_of(idle, ahead, over)
    yield for_all_inputs(
        "a switch that was run over is forgotten before it",
        (ran_over & (before(own.here) > own.high) & _same_switch(own)).implies(machine.mode.eq(idle)),
        statement="when the vehicle backs off after the decision, or after giving it up, the machine watches no switch",
    )
    yield for_all_inputs(
        "before the switch nothing is stated of it",
        (own.high < own.here).implies(
            machine.output("course").eq(UNDECIDED) & machine.mode.one_of(ahead, idle, unseen)
        ),
        statement="surely before the watched switch, also after backing off, the machine states no course",
    )


def _announced(model: TurnOff) -> Iterator[Property]:
    machine, own = model.machine, model.own
    idle, ahead, *_ = machine.modes
    passed = own.switch_position.present & own.measured & (own.high < own.switch_position.value)
    yield for_all_inputs(
        "a switch in view is watched",
        (passed & before(machine.mode).eq(idle)).implies(
            machine.mode.eq(ahead) & own.here.eq(own.switch_position.value)
        ),
        statement="from IDLE the machine begins to watch a switch that surely lies ahead and whose reflector the radar measures",
    )
    yield for_all_inputs(
        "the same switch stays watched",
        (_was_watching(model) & _same_switch(own)).implies(own.here.eq(before(own.here))),
        statement="the machine stops watching a switch only for another one that the map gives",
    )
