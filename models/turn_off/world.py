"""The world of the turn-off machine: the switch whose reflector is measured, the vehicle's course, and the motion of the image.

The map gives a switch while it surely lies ahead. From then on, until it gives another one, the radar measures the
reflector behind that switch.
"""

from __future__ import annotations

from safeloc.language.expr import Bool, Num, between, ite
from safeloc.language.world import Law, World
from safeloc.models.turn_off.variables import LEFT, RIGHT, STRAIGHT, UNDECIDED, Parts

GIVEN = "the map gives a switch only while it lies ahead"
"""The clause that the wire of the switch can guarantee."""


def world(own: Parts) -> World:
    """Return the world; the course may change while the vehicle is before the switch."""
    chosen = _another(own) | (own.measured & (own.high < own.true_switch))
    return own.declared.world(
        moves={
            own.true_switch: _switch(own),
            own.true_course: _course(own, chosen),
            own.true_lateral: _place(own),
        },
        clauses={
            GIVEN: _given_ahead(own),
            "a vehicle takes one course": _one_course(own),
            "images are measured within their error": _measured(own),
            "the image rests before the switch": _rests(own),
            "running straight only sways the image": _sways(own, chosen),
            "turning left moves the image right": _turns(own, chosen, left=True),
            "turning right moves the image left": _turns(own, chosen, left=False),
        },
    )


def _another(own: Parts) -> Bool:
    """Return whether the map gives another switch, and the radar measures its reflector."""
    return own.switch_position.present & own.measured & own.switch_position.value.ne(own.true_switch)


def _switch(own: Parts) -> Num:
    return ite(_another(own), own.switch_position.value, own.true_switch)


def _place(own: Parts) -> Num:
    return ite(_another(own), own.next_true_lateral, own.true_lateral)


def _given_ahead(own: Parts) -> Law:
    return Law(
        own.switch_position.present.implies(own.switch_position.value > own.high),
        "The map is looked up ahead of the reported interval, and returns a switch together with the reflector behind it.",
        source="[D] the interface of the map on board",
        owner="supplier",
        check="the look-up is tested with the map",
    )


def _one_course(own: Parts) -> Law:
    return Law(
        own.next_true_course.ne(UNDECIDED),
        "At a switch a vehicle runs straight on, to the left or to the right.",
        source="[D] a switch has two legs, a three-way switch three",
        owner="infrastructure",
        check="the interlocking's supervision of switch blades",
    )


def _measured(own: Parts) -> Law:
    error = own.config.lateral_error_mm
    return Law(
        own.measured.implies(between(-error, own.lateral - own.shift - _place(own), error)),
        "The measured lateral place is the place before the switch plus the motion of the image, within the measuring error.",
        ("lateral_error_mm",),
        "[D] 3 mrad at 100 m, and 0.1 m of sway and survey",
        "supplier",
        "lateral places along straight track against the map",
    )


def _rests(own: Parts) -> Law:
    return Law(
        (own.high < _switch(own)).implies(own.shift.eq(0)),
        "The image keeps its place until the vehicle is on the switch; the reported interval holds the vehicle.",
        source="[D] geometry of straight track; containment of the reflector machine",
        owner="infrastructure",
        check="a reflector is placed so that it is seen along straight track before the switch",
    )


def _sways(own: Parts, chosen: Bool) -> Law:
    sway = own.config.sway_mm
    return Law(
        _course(own, chosen).eq(STRAIGHT).implies(between(-sway, own.shift, sway)),
        "If the vehicle runs straight on, the image moves by no more than the vehicle sways.",
        ("sway_mm",),
        "[M]",
        "operator",
        "maintenance of the running gear",
    )


def _turns(own: Parts, chosen: Bool, *, left: bool) -> Law:
    config, moved = own.config, -own.shift if left else own.shift
    beyond = own.low - _switch(own) >= config.decide_mm
    course = _course(own, chosen).eq(LEFT if left else RIGHT)
    side, other = ("left", "right") if left else ("right", "left")
    return Law(
        course.implies((moved >= -config.sway_mm) & (beyond.implies(moved >= config.least_shift_mm))),
        f"If the vehicle turns {side}, the image moves to the {other}: never farther to the {side} than the vehicle sways, and, "
        "once the vehicle is beyond the turnout, by at least the least shift.",
        ("least_shift_mm", "decide_mm", "sway_mm"),
        "[D] turnout 1:9: 6.3 degrees, 2.5 m at 23 m of range; source l. 294",
        "infrastructure",
        "survey of reflector and switch; commissioning runs over both courses",
    )


def _course(own: Parts, chosen: Bool) -> Num:
    return ite(chosen, own.next_true_course, own.true_course)
