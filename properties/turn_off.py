"""What must hold of the turn-off seen in the radar image (RFL-12)."""

from __future__ import annotations

from safeloc.language.expr import abs_, all_of
from safeloc.language.spec import Property, always, earlier_num, reachable
from safeloc.models.turn_off import COURSE, STRAIGHT, UNDECIDED, TurnOff

LAW = "lateral places within their error; the image of a reflector moves as it must on straight track and in a turnout"


def properties(model: TurnOff) -> list[Property]:
    """Every property of the turn-off machine."""
    return [*_course(model), *_noting(model)]


def _course(model: TurnOff) -> list[Property]:
    """The course that is stated is the true one; a contradiction with the authority is flagged, and nothing else is."""
    machine, own = model.machine, model.own
    decided = machine.modes[3]
    course, mode = machine.output("course"), machine.mode
    return [
        always(
            "course is true",
            all_of(course.eq(label).implies(own.true.eq(label)) for label in COURSE[1:]),
            statement="straight, left or right are stated only where the vehicle takes that course",
            requirements=("RFL-12",),
            assumption=LAW,
        ),
        always(
            "course only after the switch",
            mode.ne(decided).implies(course.eq(UNDECIDED)),
            statement="nothing is stated until the lateral motion has decided",
            requirements=("RFL-12",),
            unconditional=True,
        ),
        always(
            "contradiction",
            machine.fired("turns left", "turns right", "runs straight on", "keep the course").implies(
                machine.flag("contradicts").iff(
                    mode.eq(decided) & course.ne(own.authorised) & own.authorised.ne(UNDECIDED) & course.ne(UNDECIDED)
                )
            ),
            statement="a course other than that by map and movement authority is flagged in the step in which it is seen",
            requirements=("RFL-12",),
            unconditional=True,
        ),
        reachable(
            "a contradiction is found",
            machine.flag("contradicts"),
            statement="a vehicle that takes another course than authorised is found out",
            requirements=("RFL-12",),
        ),
    ]


def _noting(model: TurnOff) -> list[Property]:
    """What a decision rests on."""
    machine, own = model.machine, model.own
    _, before, over, *_ = machine.modes
    course, mode = machine.output("course"), machine.mode
    return [
        always(
            "straight only beyond the turnout",
            machine.fired("runs straight on").implies(
                own.measured
                & (own.low >= earlier_num(own.here) + own.config.decide_mm)
                & (abs_(own.lateral - earlier_num(own.noted)) <= own.config.straight_mm)
                & course.eq(STRAIGHT)
            ),
            statement="straight on is stated only when the vehicle is surely through and a turn would have shown",
            requirements=("RFL-12",),
            unconditional=True,
        ),
        always(
            "the noted place is from before the switch",
            mode.one_of(before, over).implies(
                own.noted.eq(earlier_num(own.noted))
                | (own.measured & (own.high < own.here) & own.noted.eq(own.lateral))
            ),
            statement="the lateral place is noted only while the vehicle is surely before the switch, from a measurement",
            requirements=("RFL-12",),
            unconditional=True,
        ),
    ]
