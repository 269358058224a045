"""The world of the direction machine: the true direction, and the true models of the reflectors around a balise.

In counting direction the vehicle passes the reflector before a balise, then the balise, and then sees the one after it; in the
other direction, the other way round.
"""

from __future__ import annotations

from safeloc.language.expr import Bool, Num, ite
from safeloc.language.world import Law, World
from safeloc.models.travel_direction.variables import Parts
from safeloc.models.vocabulary.reflectors import NO_MODEL


def world(own: Parts) -> World:
    """Return the world."""
    return own.declared.world(
        moves={
            own.runs_along: ite(own.backwards, own.next_runs_along, own.runs_along),
            own.last_read_model: ite(own.backwards, NO_MODEL, _read(own)),
            own.true_next_model: _due(own),
            own.first_model_right: ite(
                _between_models(own), _read(own).eq(_behind(own)), own.first_model_right & ~own.balise_read
            ),
        },
        clauses={"one of two models is recognised rightly": _recognised(own)},
    )


def _read(own: Parts) -> Num:
    """Return the model recognised of the last reflector passed, this cycle included."""
    return ite(own.passed_model.ne(NO_MODEL), own.passed_model, own.last_read_model)


def _behind(own: Parts) -> Num:
    """Return the true model of the last reflector before the balise."""
    return ite(own.runs_along, own.before, own.after)


def _between_models(own: Parts) -> Bool:
    """Return whether the vehicle passes a balise between two reflectors of different models."""
    different = own.after.ne(own.before)
    return different & own.after.ne(NO_MODEL) & own.before.ne(NO_MODEL) & own.balise_read


def _due(own: Parts) -> Num:
    """Return the true model of the next reflector: from a balise after a reflector, until the vehicle turns or meets the next one."""
    next_one = ite(_read(own).eq(NO_MODEL), NO_MODEL, ite(own.runs_along, own.after, own.before))
    over = own.backwards | own.balise_read | own.ahead_model.ne(NO_MODEL)
    return ite(_between_models(own) & ~own.backwards, next_one, ite(over, NO_MODEL, own.true_next_model))


def _recognised(own: Parts) -> Law:
    first_seen = own.true_next_model.ne(NO_MODEL) & ~own.balise_read & ~own.backwards & own.ahead_model.ne(NO_MODEL)
    return Law(
        first_seen.implies(own.first_model_right | own.ahead_model.eq(own.true_next_model)),
        "Of the last reflector before a balise and the first one seen after it, at least one is recognised with the model that "
        "the map has; and the direction changes only in a cycle in which the vehicle reports that it turned.",
        source="[M] signatures told apart; source l. 161 and 290",
        owner="supplier",
        check="models read against the map, in operation",
    )
