"""Properties of the models that the direction of the reflector device hears: the nearest reflector ahead, and one that is passed (RFL-D5)."""

from __future__ import annotations

from collections.abc import Iterator
from functools import partial

from safeloc.language.expr import Bool, Num, NumVar, all_of, any_of, before
from safeloc.language.spec import Property, always, reachable
from safeloc.models.reflector_device import ReflectorDevice
from safeloc.models.vocabulary.reflectors import NO_MODEL
from safeloc.properties.reflector_device.host import runs_on

REQUIREMENTS = ("RFL-D5",)
for_all_inputs = partial(always, requirements=REQUIREMENTS, unconditional=True)


def properties(whole: ReflectorDevice) -> list[Property]:
    """Return the properties of the models that the direction hears."""
    return [prop for maker in (_ahead, _passed, _near) for prop in maker(whole)]


def _ahead(whole: ReflectorDevice) -> Iterator[Property]:
    heard, told = _into_direction(whole, "ahead_model"), range(len(whole.source.own.slots))
    yield for_all_inputs(
        "the direction hears the nearest reflector ahead",
        all_of(
            any_of(
                [
                    _no_reflector(whole, one),
                    _nearer_beside(whole, one),
                    heard.eq(_model(whole, one)),
                    _as_near(whole, one),
                ]
            )
            for one in told
        ),
        statement="of a frame with a strong echo that shows a reflector's model, the direction hears the model of the nearest one",
    )
    yield for_all_inputs(
        "the direction hears nothing else ahead",
        heard.eq(NO_MODEL) | any_of(~_no_reflector(whole, one) & heard.eq(_model(whole, one)) for one in told),
        statement="a model that the direction hears ahead is that of a strong echo of this cycle's frame",
    )


def _passed(whole: ReflectorDevice) -> Iterator[Property]:
    heard, was_near = _into_direction(whole, "passed_model"), before(_near_model(whole))
    turned, frame = _turned(whole), _frame(whole)
    yield for_all_inputs(
        "a reflector that was near and is seen no more is passed",
        any_of([turned, ~frame, was_near.eq(NO_MODEL), _still_near(whole, was_near), heard.eq(was_near)]),
        statement="where the last frame showed a reflector within the passing range, and this one shows none there, the direction hears that it is passed",
    )
    yield for_all_inputs(
        "no other reflector is passed",
        heard.eq(NO_MODEL) | all_of([heard.eq(was_near), frame, ~turned, ~_still_near(whole, was_near)]),
        statement="the direction hears of no passed reflector but one that was near and is not in this cycle's frame, in which the vehicle did not turn",
    )
    yield reachable(
        "a reflector is passed",
        heard.ne(NO_MODEL),
        statement="the direction can hear that a reflector is passed",
        requirements=REQUIREMENTS,
    )


def _near(whole: ReflectorDevice) -> Iterator[Property]:
    near, told = _near_model(whole), range(len(whole.source.own.slots))
    within = [~_no_reflector(whole, one) & (_range(whole, one) <= whole.config.passing_range_mm) for one in told]
    yield for_all_inputs(
        "near is what the last frame showed near",
        any_of([
            _turned(whole),
            ~_frame(whole),
            any_of(shown & near.eq(_model(whole, one)) for one, shown in zip(told, within, strict=True)),
            ~any_of(within) & near.eq(NO_MODEL),
        ]),
        statement="after each frame a reflector is near exactly if the frame shows one within the passing range, and it is of that model",
    )  # fmt: skip
    yield for_all_inputs(
        "without a frame what was near stays, and turning forgets it",
        any_of(
            [
                _frame(whole) & ~_turned(whole),
                near.eq(before(near)) & ~_turned(whole),
                _turned(whole) & near.eq(NO_MODEL),
            ]
        ),
        statement="a cycle without a frame changes nothing of what is near; in a cycle in which the vehicle turned nothing is",
    )


# ------------------------------------------------------------------ words


def _into_direction(whole: ReflectorDevice, name: str) -> Num:
    into = whole.composition.of(whole.direction.machine)
    return into.num(getattr(whole.direction.own, name))


def _near_model(whole: ReflectorDevice) -> NumVar:
    found = whole.composition.of(whole.met.machine).num(whole.met.near_model)
    assert isinstance(found, NumVar)
    return found


def _turned(whole: ReflectorDevice) -> Bool:
    """Return whether the vehicle turned, or may have."""
    return ~runs_on(whole)


def _frame(whole: ReflectorDevice) -> Bool:
    return whole.source.own.frame_present


def _model(whole: ReflectorDevice, slot: int) -> Num:
    return whole.source.own.slots[slot].model


def _range(whole: ReflectorDevice, slot: int) -> Num:
    return whole.source.own.slots[slot].range.value


def _no_reflector(whole: ReflectorDevice, slot: int) -> Bool:
    """Return whether this echo is none, too weak, or shows no model."""
    one, least = whole.source.own.slots[slot], whole.config.reflector.minimum_intensity_cdb
    return any_of([one.model.eq(NO_MODEL), one.intensity < least, ~one.range.present, ~whole.source.own.frame_present])


def _nearer_beside(whole: ReflectorDevice, slot: int) -> Bool:
    """Return whether another echo of a reflector is nearer."""
    others = [other for other in range(len(whole.source.own.slots)) if other != slot]
    return any_of(~_no_reflector(whole, other) & (_range(whole, other) < _range(whole, slot)) for other in others)


def _as_near(whole: ReflectorDevice, slot: int) -> Bool:
    """Return whether another echo of a reflector is just as near, and the direction hears that one."""
    heard, others = _into_direction(whole, "ahead_model"), range(len(whole.source.own.slots))
    return any_of(
        all_of(
            [~_no_reflector(whole, other), _range(whole, other).eq(_range(whole, slot)), heard.eq(_model(whole, other))]
        )
        for other in others
        if other != slot
    )


def _still_near(whole: ReflectorDevice, model: Num) -> Bool:
    """Return whether an echo within the passing range shows this model."""
    shown = range(len(whole.source.own.slots))
    return any_of(
        all_of(
            [
                ~_no_reflector(whole, one),
                _range(whole, one) <= whole.config.passing_range_mm,
                _model(whole, one).eq(model),
            ]
        )
        for one in shown
    )
