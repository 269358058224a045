"""Before the view zone: the searched reflector, and the beginning of its search (RFL-1, RFL-8, figures 001 items 6, 7, 19)."""

from __future__ import annotations

from collections.abc import Iterator
from functools import partial

from safeloc.language.expr import Bool, any_of, before, exact_to
from safeloc.language.spec import Property, always
from safeloc.language.units import NM
from safeloc.models.reflector import ReflectorMachine
from safeloc.models.reflector.variables import Parts
from safeloc.models.vocabulary.reflectors import NO_MODEL
from safeloc.properties.reflector.figures import SIGHTED, balise_read, foremost, seen_from, was, width

for_all_inputs = partial(always, requirements=("RFL-1", "RFL-10"), unconditional=True)


def search(model: ReflectorMachine) -> Iterator[Property]:
    """Yield the properties of the odometry zone and the search zone."""
    for maker in (_clutter, _not_too_early, _zone_begins, _as_announced):
        yield from maker(model)


def _clutter(model: ReflectorMachine) -> Iterator[Property]:
    own = model.own
    yield for_all_inputs(
        "clutter is no reflector",
        (was(model, "ODOMETRY", "NOT_READY", "DELOCALIZED") & ~balise_read(own)).implies(
            ~model.machine.flag("precise") & ~own.recognised_now
        ),
        statement="in the odometry zone, not ready or without a position, the machine takes no echo, however strong, for a reflector",
    )


def _not_too_early(model: ReflectorMachine) -> Iterator[Property]:
    own, target = model.own, model.own.target
    begins = seen_from(own, target.position, target.view_from)
    yield for_all_inputs(
        "never too early",
        (model.in_mode("SEARCH") & ~was(model, "SEARCH")).implies(
            (exact_to(target.clear, NM) > width(own)) & (foremost(own) >= begins)
        ),
        statement="the search begins only when the vehicle may be in the view zone, and only if no other reflector of the model fits "
        "into the interval",
        requirements=("RFL-1", "RFL-8"),
    )


def _zone_begins(model: ReflectorMachine) -> Iterator[Property]:
    yield for_all_inputs(
        "no unfit neighbour",
        (model.in_mode("VIEW") & ~was(model, "VIEW")).implies(model.machine.fired(*SIGHTED)),
        statement="only a measurement of the searched reflector begins the view zone",
        requirements=("RFL-1",),
    )


def _as_announced(model: ReflectorMachine) -> Iterator[Property]:
    own, target = model.own, model.own.target
    changed = any_of(var.ne(before(var)) for var in (*target.kept, target.model))
    yield for_all_inputs(
        "the target is the next reflector of the map",
        (changed & target.model.ne(NO_MODEL)).implies(_announced(own)),
        statement="a new target is the map's next reflector, with all its figures",
        requirements=("RFL-3", "RFL-8"),
    )
    yield for_all_inputs(
        "a searched reflector is on the map",
        model.in_mode("SEARCH", "VIEW", "COAST", "PASSING", "REFERENCE").iff(target.model.ne(NO_MODEL)),
        statement="the machine searches or tracks a reflector exactly while it has a target",
        requirements=("RFL-3",),
    )


def _announced(own: Parts) -> Bool:
    target, ahead = own.target, own.ahead
    return (
        ahead.position.present
        & target.position.eq(ahead.position.value)
        & target.model.eq(ahead.model)
        & target.view_from.eq(ahead.view_from)
        & target.view_to.eq(ahead.view_to)
        & target.clear.eq(ahead.clear)
    )
