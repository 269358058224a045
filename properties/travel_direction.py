"""Properties of the direction of travel by reflector models (RFL-D5)."""

from __future__ import annotations

from collections.abc import Iterator
from functools import partial

from safeloc.language.expr import Bool, Num, before, ite, was
from safeloc.language.spec import Property, always, earlier_num, reachable
from safeloc.models.travel_direction import TravelDirection
from safeloc.models.travel_direction.variables import AGAINST, ALONG, UNKNOWN, Parts
from safeloc.models.vocabulary.reflectors import NO_MODEL

LAW = "at least one of the two models recognised around a balise is that of the map's reflector there"
REQUIREMENTS = ("RFL-D5",)
for_all_inputs = partial(always, requirements=REQUIREMENTS, unconditional=True)


def properties(model: TravelDirection) -> list[Property]:
    """Return every property of the direction machine."""
    makers = (_true, _both, _begins, _confirmed, _taken_back, _agrees, _stays, _turning, _half, _contradiction)
    return [prop for maker in makers for prop in maker(model)]


def _passed_last(own: Parts) -> Num:
    """Return the model of the last reflector passed, this cycle included."""
    return ite(own.passed_model.ne(NO_MODEL), own.passed_model, before(own.last_passed_model))


def _tells(own: Parts) -> Bool:
    """Return whether the vehicle reads a balise between reflectors of different models."""
    return own.balise_read & own.after.ne(own.before) & own.after.ne(NO_MODEL) & own.before.ne(NO_MODEL)


def _true(model: TravelDirection) -> Iterator[Property]:
    stated, own = model.machine.output("direction"), model.own
    yield always(
        "direction is true",
        stated.eq(ALONG).implies(own.runs_along) & stated.eq(AGAINST).implies(~own.runs_along),
        statement="a stated direction is the one in which the vehicle runs",
        requirements=REQUIREMENTS,
        assumption=LAW,
    )
    yield reachable(
        "against is found",
        stated.eq(AGAINST) & model.machine.flag("contradicts"),
        statement="the machine can notice a vehicle that runs against the expected direction",
        requirements=REQUIREMENTS,
    )


def _both(model: TravelDirection) -> Iterator[Property]:
    """Yield that a stated direction rests on both models."""
    machine, own = model.machine, model.own
    stated, (_, half, *_) = machine.output("direction"), machine.modes
    newly = stated.ne(UNKNOWN) & earlier_num(stated).ne(stated)
    seen = own.ahead_model.ne(NO_MODEL) & own.ahead_model.eq(before(own.awaited_model)) & ~own.balise_read
    yield for_all_inputs(
        "both models count",
        newly.implies(before(machine.mode).eq(half) & seen & ite(was(own.along), stated.eq(ALONG), stated.eq(AGAINST))),
        statement="the machine states a new direction only if the vehicle passed one neighbour of a balise and sees the other one ahead",
    )


def _begins(model: TravelDirection) -> Iterator[Property]:
    machine, own = model.machine, model.own
    half = machine.mode.eq(machine.modes[1])
    begun = half & (own.balise_read | before(machine.mode).ne(machine.modes[1]))
    passed = _passed_last(own)
    yield for_all_inputs(
        "equal models start no decision",
        begun.implies(_tells(own)),
        statement="a balise between equal models, or without one on either side, starts no decision",
    )
    along = own.along & passed.eq(own.before) & own.awaited_model.eq(own.after)
    against = ~own.along & passed.eq(own.after) & own.awaited_model.eq(own.before)
    yield for_all_inputs(
        "a decision begins with the model passed",
        begun.implies(along | against),
        statement="a decision begins only if the last model passed is that of one neighbour of the balise; it awaits the other one's",
    )
    agrees = machine.output("direction").eq(ite(passed.eq(own.before), ALONG, AGAINST))
    fits = passed.eq(own.before) | passed.eq(own.after)
    yield for_all_inputs(
        "a model passed before a balise begins a decision",
        (_tells(own) & ~own.backwards & fits).implies(half | agrees),
        statement="a balise after one of its neighbours begins a decision, or agrees with the stated direction",
    )


def _confirmed(model: TravelDirection) -> Iterator[Property]:
    machine, own = model.machine, model.own
    waits = before(machine.mode).eq(machine.modes[1]) & ~own.balise_read & ~own.backwards
    stated = machine.output("direction")
    yield for_all_inputs(
        "the awaited model states the direction",
        (waits & own.ahead_model.eq(before(own.awaited_model))).implies(stated.eq(ite(was(own.along), ALONG, AGAINST))),
        statement="if the awaited model is seen ahead, the machine states the direction of the half decision",
    )
    yield for_all_inputs(
        "another model ends the decision",
        (waits & own.ahead_model.ne(NO_MODEL) & own.ahead_model.ne(before(own.awaited_model))).implies(
            machine.mode.eq(machine.modes[0]) & stated.eq(UNKNOWN)
        ),
        statement="if another model is seen ahead, the decision ends without a direction",
    )
    yield for_all_inputs(
        "a decision waits for a reflector",
        (waits & own.ahead_model.eq(NO_MODEL)).implies(
            machine.mode.eq(machine.modes[1])
            & own.awaited_model.eq(before(own.awaited_model))
            & own.along.iff(was(own.along))
        ),
        statement="while no reflector is seen ahead, a half decision stays as it began",
    )


def _taken_back(model: TravelDirection) -> Iterator[Property]:
    machine, own = model.machine, model.own
    stated, passed = machine.output("direction"), _passed_last(own)
    refuted = (earlier_num(stated).eq(ALONG) & passed.eq(own.after)) | (
        earlier_num(stated).eq(AGAINST) & passed.eq(own.before)
    )
    yield for_all_inputs(
        "a balise that fits the other direction takes it back",
        (_tells(own) & refuted).implies(stated.eq(UNKNOWN)),
        statement="the machine withdraws a direction if the last model passed before a balise fits the other direction",
    )


def _agrees(model: TravelDirection) -> Iterator[Property]:
    machine, own = model.machine, model.own
    stated, passed = machine.output("direction"), _passed_last(own)
    agrees = ite(
        passed.eq(own.before), earlier_num(stated).eq(ALONG), passed.eq(own.after) & earlier_num(stated).eq(AGAINST)
    )
    yield for_all_inputs(
        "a balise that fits the direction leaves it stated",
        (_tells(own) & ~own.backwards & agrees).implies(stated.eq(earlier_num(stated))),
        statement="a direction stays at a balise if the last model passed before it fits that direction",
    )


def _stays(model: TravelDirection) -> Iterator[Property]:
    machine, own = model.machine, model.own
    stated = machine.output("direction")
    yield for_all_inputs(
        "a stated direction stays between balises",
        (~own.balise_read & ~own.backwards & earlier_num(stated).ne(UNKNOWN)).implies(stated.eq(earlier_num(stated))),
        statement="the machine withdraws a direction only at a balise, or when the vehicle turns",
    )
    yield for_all_inputs(
        "the model passed last stays stored",
        own.last_passed_model.eq(ite(own.backwards, NO_MODEL, _passed_last(own))),
        statement="the machine stores the model of the last reflector passed until the vehicle passes another one or turns",
    )


def _turning(model: TravelDirection) -> Iterator[Property]:
    machine, own = model.machine, model.own
    yield for_all_inputs(
        "turning forgets",
        own.backwards.implies(
            machine.output("direction").eq(UNKNOWN)
            & own.last_passed_model.eq(NO_MODEL)
            & machine.mode.eq(machine.modes[0])
        ),
        statement="when the vehicle turns, the machine withdraws the direction and forgets the last model",
    )


def _half(model: TravelDirection) -> Iterator[Property]:
    machine = model.machine
    unknown, half, *_ = machine.modes
    yield for_all_inputs(
        "half is not stated",
        machine.mode.one_of(half, unknown).implies(
            machine.output("direction").eq(UNKNOWN) & ~machine.flag("contradicts")
        ),
        statement="one model alone states no direction and contradicts no route",
    )


def _contradiction(model: TravelDirection) -> Iterator[Property]:
    stated, own = model.machine.output("direction"), model.own
    known = own.route_direction.ne(UNKNOWN) & stated.ne(UNKNOWN)
    yield for_all_inputs(
        "another direction than expected contradicts",
        model.machine.flag("contradicts").iff(known & stated.ne(own.route_direction)),
        statement="the machine reports a contradiction exactly in the steps in which it states another direction than route and authority",
    )
