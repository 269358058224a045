"""What must hold of the direction of travel by reflector models (RFL-D5)."""

from __future__ import annotations

from safeloc.language.expr import before
from safeloc.language.spec import Property, always, reachable
from safeloc.models.travel_direction import AGAINST, ALONG, UNKNOWN, TravelDirection
from safeloc.models.vocabulary.reflectors import NO_MODEL

LAW = "of the two models recognised around a balise at least one is that of the map's reflector there"


def properties(model: TravelDirection) -> list[Property]:
    """Every property of the direction machine."""
    return [*_stated(model), *_withheld(model)]


def _stated(model: TravelDirection) -> list[Property]:
    """A stated direction is the true one and rests on both models."""
    machine, own = model.machine, model.own
    _, half, *_ = machine.modes
    stated = machine.output("direction")
    confirmed = machine.fired("confirmed along", "confirmed against")
    return [
        always(
            "direction is true",
            stated.eq(ALONG).implies(own.runs_along) & stated.eq(AGAINST).implies(~own.runs_along),
            statement="a stated direction is the one in which the vehicle runs",
            requirements=("RFL-D5",),
            assumption=LAW,
        ),
        always(
            "both models count",
            confirmed.implies(
                before(machine.mode).eq(half) & own.ahead.eq(before(own.awaited)) & before(own.awaited).ne(NO_MODEL)
            ),
            statement="a direction is stated only after a balise whose one neighbour was passed and whose other is seen ahead",
            requirements=("RFL-D5",),
            unconditional=True,
        ),
        reachable(
            "against is found",
            stated.eq(AGAINST) & machine.flag("contradicts"),
            statement="a vehicle that runs against the expected direction is found out",
            requirements=("RFL-D5",),
        ),
    ]


def _withheld(model: TravelDirection) -> list[Property]:
    """Where nothing is stated."""
    machine, own = model.machine, model.own
    unknown, half, *_ = machine.modes
    stated = machine.output("direction")
    return [
        always(
            "equal models tell nothing",
            machine.fired("fits along", "fits against").implies(
                own.balise & own.before.ne(own.after) & own.before.ne(NO_MODEL) & own.after.ne(NO_MODEL)
            ),
            statement="a balise between equal models, or without one on either side, starts no decision",
            requirements=("RFL-D5",),
            unconditional=True,
        ),
        always(
            "turning forgets",
            own.backwards.implies(stated.eq(UNKNOWN) & own.last.eq(NO_MODEL)),
            statement="after moving backwards nothing is stated until another balise",
            requirements=("RFL-D5",),
            unconditional=True,
        ),
        always(
            "half is not stated",
            machine.mode.one_of(unknown, half).implies(stated.eq(UNKNOWN) & ~machine.flag("contradicts")),
            statement="one model alone states no direction and contradicts no route",
            requirements=("RFL-D5",),
            unconditional=True,
        ),
    ]
