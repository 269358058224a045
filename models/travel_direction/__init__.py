"""Direction of travel from the reflector models before and after a balise (RFL-D5; source l. 161, 290).

One balise alone does not tell the direction in which a vehicle runs along the line. The models of the reflectors on its two
sides do, by the order in which the vehicle meets them. `before` and `after` refer to the line's counting direction.

    UNKNOWN  the machine states no direction
    HALF     the vehicle passed a balise, and the last reflector before it fits one direction; the next one has to confirm it
    ALONG    the vehicle runs in counting direction
    AGAINST  the vehicle runs against the counting direction
"""

from __future__ import annotations

from collections.abc import Iterator

from safeloc.language.expr import TRUE, Bool, Lit, Num, ite
from safeloc.language.machine import Machine, Model, Transition, current_mode, modes
from safeloc.language.rows import Updates, together
from safeloc.models.travel_direction.variables import (
    AGAINST,
    ALONG,
    DIRECTION,
    UNKNOWN,
    DirectionConfig,
    Parts,
    parts,
)
from safeloc.models.travel_direction.world import world
from safeloc.models.vocabulary.reflectors import NO_MODEL

__all__ = [
    "AGAINST",
    "ALONG",
    "DIRECTION",
    "UNKNOWN",
    "DirectionConfig",
    "Parts",
    "TravelDirection",
    "build",
    "machine",
    "parts",
]
REQUIREMENTS = ("RFL-D5",)


TravelDirection = Model[Parts]


def machine(_: DirectionConfig | None = None) -> Machine:
    """Return the direction machine (RFL-D5)."""
    return build(parts()).machine


def build(own: Parts) -> TravelDirection:
    """Return the machine over the given variables."""
    table = modes("UNKNOWN", "HALF", "ALONG", "AGAINST")
    current = current_mode(table)
    _, _, along, against = table
    made = own.declared.machine(
        name="travel_direction",
        modes=table,
        outputs={
            "direction": ite(current.eq(along), ALONG, ite(current.eq(against), AGAINST, UNKNOWN)),
            "contradicts": ite(
                current.eq(along), own.asked_direction.eq(AGAINST), current.eq(against) & own.asked_direction.eq(ALONG)
            ),
        },
        transitions=list(_table(own, current, table)),
        world=world(own),
        lemmas=_lemmas(own, current, table),
        definitions={"neighbours differ": own.telling, "confirmed ahead": own.confirmed, "refuted ahead": own.refuted},
        doc=(
            "Direction of travel from the models of the reflectors before and after a balise, in the order in which the "
            "vehicle meets them. Assumed: at least one of the two models recognised around a balise is that of the map's "
            "reflector there, and the direction changes only in a cycle in which the vehicle reports that it turned."
        ),
    )
    return TravelDirection(made, own)


def _table(own: Parts, current: Num, table: tuple[Lit, ...]) -> Iterator[Transition]:
    unknown, half, along, against = table
    asked: Updates = {own.asked_direction: own.route_direction}
    with_latest = together(asked, {own.last_passed_model: own.latest})
    none: Updates = {own.awaited_model: NO_MODEL, own.along: False}
    ended, turned = together(with_latest, none), together(asked, none, {own.last_passed_model: NO_MODEL})
    begun_along = together(with_latest, {own.awaited_model: own.after, own.along: True})
    begun_against = together(with_latest, {own.awaited_model: own.before, own.along: False})
    fits_along = own.telling & own.latest.eq(own.before) & current.ne(along)
    fits_against = own.telling & own.latest.eq(own.after) & current.ne(against)
    yield Transition("turned", table, unknown, own.backwards, turned, REQUIREMENTS, 0)
    yield Transition("fits along", table, half, fits_along, begun_along, REQUIREMENTS, 1)
    yield Transition("fits against", table, half, fits_against, begun_against, REQUIREMENTS, 1)
    yield Transition("fits neither", half, unknown, own.balise_read, ended, REQUIREMENTS, 2)
    yield Transition("confirmed along", half, along, own.confirmed & own.along, ended, REQUIREMENTS, 2)
    yield Transition("confirmed against", half, against, own.confirmed & ~own.along, ended, REQUIREMENTS, 2)
    yield Transition("refuted", half, unknown, own.refuted, ended, REQUIREMENTS, 2)
    for mode in table:
        yield Transition(f"stay {mode.label.lower()}", mode, mode, TRUE, with_latest, REQUIREMENTS, 3)


def _lemmas(own: Parts, current: Num, table: tuple[Lit, ...]) -> dict[str, Bool]:
    _, half, along, against = table
    return {
        "the last model is the one read last": own.last_passed_model.eq(own.last_read_model),
        "a half that began rightly is right": (current.eq(half) & own.first_model_right).implies(
            own.along.iff(own.runs_along)
        ),
        "a half awaits what is due if it is right": current.eq(half).implies(
            own.true_next_model.ne(NO_MODEL)
            & own.awaited_model.eq(own.true_next_model).iff(own.along.iff(own.runs_along))
        ),
        "a half awaits a model": current.eq(half).implies(own.awaited_model.ne(NO_MODEL)),
        "along is along": current.eq(along).implies(own.runs_along),
        "against is against": current.eq(against).implies(~own.runs_along),
    }
