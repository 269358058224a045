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
    over = any_of(
        [was_near.eq(NO_MODEL), ~runs_on(whole), _run(whole) < before(_remaining(whole)), _still_near(whole, was_near)]
    )
    yield for_all_inputs(
        "a reflector is passed where its distance is run",
        over | heard.eq(was_near),
        statement="where the run measured since a reflector was seen near is the distance from the balise antenna to it, and the frame does not show it "
        "near, the direction hears that it is passed",
    )
    yield for_all_inputs(
        "no other reflector is passed",
        heard.eq(NO_MODEL) | (heard.eq(was_near) & ~over),
        statement="the direction hears of no passed reflector before the run measured since it was seen near is its distance from the antenna, nor while "
        "the frame shows it near, nor in a cycle in which the vehicle may have turned",
    )
    yield reachable(
        "a reflector is passed",
        heard.ne(NO_MODEL),
        statement="the direction can hear that a reflector is passed",
        requirements=REQUIREMENTS,
    )


def _near(whole: ReflectorDevice) -> Iterator[Property]:
    near, was_near = _near_model(whole), before(_near_model(whole))
    passes, told = _into_direction(whole, "passed_model").ne(NO_MODEL), range(len(whole.source.own.slots))
    first = any_of([was_near.eq(NO_MODEL), passes])
    yield for_all_inputs(
        "the nearest reflector is measured as it comes near",
        all_of(
            any_of([
                ~runs_on(whole), ~_within(whole, one), _nearer_beside(whole, one), ~(first | was_near.eq(_model(whole, one))),
                near.eq(_model(whole, one)) & _remaining(whole).eq(_range(whole, one) + _behind_mm(whole)), _tied(whole, one),
            ])
            for one in told
        ),
        statement="where the nearest reflector of the frame is near, and no other one comes before it, it is the one that comes next, at the measured distance",
    )  # fmt: skip
    unseen = all_of(~(_within(whole, one) & (first | was_near.eq(_model(whole, one)))) for one in told)
    left, most = before(_remaining(whole)) - _run(whole), whole.config.passing_range_mm + whole.config.balise.antenna_mm
    yield for_all_inputs(
        "a reflector that is near is carried on by the odometer",
        any_of([
            ~runs_on(whole), first, ~unseen,
            near.eq(was_near) & any_of([_remaining(whole).eq(left), _remaining(whole).eq(0) & (left < 0), _remaining(whole).eq(most) & (left > most)]),
        ]),
        statement="a reflector that comes next, and is not seen, stays the next one, and its distance is less by the measured run, but no less than 0 and no more than the farthest at which one is near",
    )  # fmt: skip
    yield for_all_inputs(
        "without a reflector near nothing comes next",
        any_of([near.eq(NO_MODEL), ~first, ~unseen]) & (runs_on(whole) | near.eq(NO_MODEL)),
        statement="nothing comes next where nothing did, or what did is passed, and the frame shows nothing near; nor in a cycle in which the vehicle may have turned",
    )


# ------------------------------------------------------------------ words


def _into_direction(whole: ReflectorDevice, name: str) -> Num:
    into = whole.composition.of(whole.direction.machine)
    return into.num(getattr(whole.direction.own, name))


def _near_model(whole: ReflectorDevice) -> NumVar:
    found = whole.composition.of(whole.met.machine).num(whole.met.near_model)
    assert isinstance(found, NumVar)
    return found


def _remaining(whole: ReflectorDevice) -> NumVar:
    found = whole.composition.of(whole.met.machine).num(whole.met.remaining)
    assert isinstance(found, NumVar)
    return found


def _run(whole: ReflectorDevice) -> Num:
    """Return the distance that the balise machine hears; it is measured wherever the vehicle runs on."""
    return whole.composition.of(whole.groups.machine).num(whole.groups.own.odometer.measured.value)


def _behind_mm(whole: ReflectorDevice) -> int:
    """Return how far the balise antenna is behind the radar."""
    return whole.config.balise.antenna_mm - whole.config.reflector.radar_offset_mm


def _model(whole: ReflectorDevice, slot: int) -> Num:
    return whole.source.own.slots[slot].model


def _range(whole: ReflectorDevice, slot: int) -> Num:
    return whole.source.own.slots[slot].range.value


def _no_reflector(whole: ReflectorDevice, slot: int) -> Bool:
    """Return whether this echo is none, too weak, shows no model, or is not beyond near range and front end."""
    one, figures = whole.source.own.slots[slot], whole.config.reflector
    near = (one.range.value < figures.near_range_mm) | (one.range.value < figures.radar_offset_mm)
    weak = one.intensity < figures.minimum_intensity_cdb
    return any_of([near, one.model.eq(NO_MODEL), weak, ~one.range.present, ~whole.source.own.frame_present])


def _within(whole: ReflectorDevice, slot: int) -> Bool:
    """Return whether this echo is of a reflector within the passing range of the front end."""
    limit_mm = whole.config.passing_range_mm
    return ~_no_reflector(whole, slot) & (_range(whole, slot) - whole.config.reflector.radar_offset_mm <= limit_mm)


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


def _tied(whole: ReflectorDevice, slot: int) -> Bool:
    """Return whether another echo of a reflector is just as near: then either may count as the nearest."""
    others = [other for other in range(len(whole.source.own.slots)) if other != slot]
    return any_of(~_no_reflector(whole, other) & _range(whole, other).eq(_range(whole, slot)) for other in others)


def _still_near(whole: ReflectorDevice, model: Num) -> Bool:
    """Return whether an echo within the passing range shows this model."""
    shown = range(len(whole.source.own.slots))
    return any_of(_within(whole, one) & _model(whole, one).eq(model) for one in shown)
