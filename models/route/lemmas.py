"""Lemmas of the route machine, over the machine and its world. They are proved themselves."""

from __future__ import annotations

from safeloc.language.expr import Bool, Lit, Num, between
from safeloc.models.route.cycle import count, now
from safeloc.models.route.variables import Parts


def lemmas(own: Parts, current: Num, table: tuple[Lit, ...]) -> dict[str, Bool]:
    """Return the lemmas: the true route is possible and its bounds hold the truth; every interval is in order and tolerable."""
    carried, seen = current.one_of(table[1], table[2]), own.ghosts
    found: dict[str, Bool] = {}
    if not own.config.checked_distance:
        found["machine and world agree on the last odometer distance"] = _gated_alike(own)
    for route, kept in zip(own.routes, now(own), strict=True):
        inside = route.possible & between(route.low, seen.truth - seen.wander, route.high)
        found[f"route {route.number} holds the truth"] = (carried & seen.route.eq(route.number)).implies(inside)
        found[f"route {route.number} is in order"] = route.possible.implies(carried & (route.low <= route.high))
        found[f"route {route.number} is tolerable"] = route.possible.implies(kept.tolerable)
        found[f"route {route.number} rests at zero"] = route.possible | (route.low.eq(0) & route.high.eq(0))
    found["one route while decided"] = current.eq(table[2]).iff(count(now(own)).eq(1))
    found["several while undecided"] = current.eq(table[1]).iff(count(now(own)) > 1)
    return found


def _gated_alike(own: Parts) -> Bool:
    """Return whether the machine remembers the same last distance and the same silence as the world."""
    return own.odometer.gap.eq(own.ghosts.silent) & own.odometer.last.eq(own.ghosts.last_delivered)
