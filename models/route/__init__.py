"""Route of the vehicle, and its position on it: hypotheses that stay until a sighting refutes them (RFL-D6; source l. 85, 281-304).

From a common start (a balise with known direction) a vehicle may run along one of several routes through switches.
Each route is a hypothesis with an interval of its own. A sighting refutes it if the route has no reflector of that model
where the vehicle would see it, and the map has none beside another track in view from there; a turn refutes it if the route
does not take that turn. A sighting whose image stands near and on the own track's side is none of another track's. A sequence of models alone never
decides: DCD is the end of ADCD, and ADCD with one reflector missed is ACD. A reflector that was NOT seen therefore
refutes nothing.

    IDLE        no start yet
    UNDECIDED   several routes are possible, each with its interval
    DECIDED     one route is possible
    LOST        contradiction, tolerance exceeded or sensors failed: the machine reports nothing until the next start

Positions are distances of end A from the common start, in mm along each route.
"""

from __future__ import annotations

from collections.abc import Iterator

from safeloc.language.expr import (
    FALSE,
    TRUE,
    Bool,
    Expr,
    Lit,
    Num,
    Var,
    all_of,
    any_of,
    as_num,
    ceil_to,
    floor_div,
    floor_to,
    ite,
)
from safeloc.language.machine import Machine, Model, Transition, current_mode, modes
from safeloc.language.rows import Updates, together
from safeloc.language.units import COUNT, MM, NM
from safeloc.models.route.cycle import Bounded, Cycle, count
from safeloc.models.route.lemmas import lemmas
from safeloc.models.route.variables import (
    CONTRADICTION,
    NO_REASON,
    SENSOR_FAILURE,
    TOLERANCE,
    Parts,
    RouteConfig,
    parts,
)
from safeloc.models.route.world import world
from safeloc.models.vocabulary.absent import margin_if, position_if

REQUIREMENTS = ("RFL-D6",)


Route = Model[Parts]


def machine(config: RouteConfig | None = None) -> Machine:
    """Return the route machine (RFL-D6)."""
    return build(parts(config or RouteConfig())).machine


def build(own: Parts) -> Route:
    """Return the machine over the given variables."""
    table = modes("IDLE", "UNDECIDED", "DECIDED", "LOST")
    current = current_mode(table)
    cycles = tuple(Cycle(own, route) for route in own.routes)
    made = own.declared.machine(
        name="route",
        modes=table,
        outputs=_outputs(own, current, table),
        transitions=list(_table(own, tuple(cycle.after for cycle in cycles), table)),
        world=world(own),
        lemmas=lemmas(own, current, table),
        definitions={f"route {cycle.route.number} fits what is seen": cycle.fits for cycle in cycles},
        doc=(
            "The routes on which the vehicle may be, each with its interval. Assumed: at a start the true route is among the "
            "candidates, and the vehicle is within the start's error; the odometer obeys its error law; each sighting is of a "
            "reflector beside the true route, with its range and model, and the map names that reflector for the route; or it is of one "
            "beside another track, which the map has in view, and whose image does not stand by the own track "
            "(layout rule: places of one model differ by more than all errors); the vehicle took a turn that was seen. Nothing "
            "is assumed of reflectors and turns that were not seen."
        ),
    )
    return Route(made, own)


# ------------------------------------------------------------------ the transition table


def _table(own: Parts, after: tuple[Bounded, ...], table: tuple[Lit, ...]) -> Iterator[Transition]:
    idle, undecided, decided, lost = table
    carried, odometer = (undecided, decided), own.odometer
    left = count(after)
    tolerable = all_of(~one.possible | one.tolerable for one in after)
    measured: Updates = {
        odometer.last: odometer.last_after,
        odometer.gap: odometer.gap_after,
        odometer.last_verdict: odometer.verdict,
    }
    refuted: Updates = {own.refuted: ite(_refutes_authority(own, after), as_num(1, COUNT), 0)}
    keep = together(measured, _run_on(own, after), refuted, {own.reason: NO_REASON})
    none = together(measured, _no_route(own), {own.refuted: 0})
    contradiction = together(none, {own.reason: CONTRADICTION})
    failed = together(none, {own.reason: SENSOR_FAILURE})
    too_wide = together(none, {own.reason: TOLERANCE})
    begun = own.start_error.present
    yield Transition("start without a route", table, lost, begun & left.eq(0), contradiction, REQUIREMENTS, 0)
    yield Transition("start on one route", table, decided, begun & left.eq(1), keep, REQUIREMENTS, 1)
    yield Transition("start on several routes", table, undecided, begun & (left > 1), keep, REQUIREMENTS, 1)
    yield Transition("sensors failed", carried, lost, odometer.failed, failed, REQUIREMENTS, 2)
    yield Transition("no route fits", carried, lost, left.eq(0), contradiction, REQUIREMENTS, 3)
    yield Transition("tolerance exceeded", carried, lost, ~tolerable, too_wide, REQUIREMENTS, 4)
    yield Transition("one route is left", undecided, decided, left.eq(1), keep, REQUIREMENTS, 5)
    yield Transition("run on along several routes", undecided, undecided, TRUE, keep, REQUIREMENTS, 6)
    yield Transition("run on along one route", decided, decided, TRUE, keep, REQUIREMENTS, 6)
    yield Transition("wait for a start", idle, idle, TRUE, measured, REQUIREMENTS, 7)
    yield Transition("stay lost", lost, lost, TRUE, measured, REQUIREMENTS, 7)


def _run_on(own: Parts, after: tuple[Bounded, ...]) -> Updates:
    """Return the updates of every route: new bounds of those that stay possible, 0 of the others."""
    updates: dict[Var, Expr] = {}
    for route, one in zip(own.routes, after, strict=True):
        updates[route.possible] = one.possible
        updates[route.low] = ite(one.possible, one.low, 0)
        updates[route.high] = ite(one.possible, one.high, 0)
    return updates


def _no_route(own: Parts) -> Updates:
    """Return the updates after which no route is possible."""
    updates: dict[Var, Expr] = {}
    for route in own.routes:
        updates[route.possible] = FALSE
        updates[route.low] = updates[route.high] = as_num(0, NM)
    return updates


def _refutes_authority(own: Parts, after: tuple[Bounded, ...]) -> Bool:
    """Return whether the route by movement authority is impossible."""
    return any_of(
        own.authorised_route.eq(route.number) & ~one.possible for route, one in zip(own.routes, after, strict=True)
    )


# ------------------------------------------------------------------ outputs


def _outputs(own: Parts, current: Num, table: tuple[Lit, ...]) -> dict[str, Expr]:
    decided = current.eq(table[2])
    of_route: dict[str, Expr] = {}
    route, low, high = as_num(0, COUNT), as_num(0, MM), as_num(0, MM)
    for one in own.routes:
        name, least = f"route_{one.number}", floor_to(one.low - own.half_nm, MM)
        most = ceil_to(one.high + own.half_nm, MM)
        of_route[f"{name}_possible"] = one.possible
        of_route[f"{name}_low_mm"] = position_if(one.possible, least)
        of_route[f"{name}_high_mm"] = position_if(one.possible, most)
        taken = decided & one.possible
        route = ite(taken, as_num(one.number, COUNT), route)
        low, high = ite(taken, least, low), ite(taken, most, high)
    middle = floor_div(low + high, 2)
    return {
        "valid": decided,
        "route": route,
        "position_mm": position_if(decided, middle),
        "margin_below_mm": margin_if(decided, middle - low),
        "margin_above_mm": margin_if(decided, high - middle),
        "refutes_authority": own.refuted.eq(1),
        "reason": own.reason,
        **of_route,
    }
