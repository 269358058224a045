"""Which route the vehicle is on, and where on it: hypotheses carried until they are refuted (RFL-D6; source l. 85, 281-304).

From a common start (a balise with known direction) a vehicle may run along one of several routes through switches.
Each route is a hypothesis with an interval of its own. What is seen refutes hypotheses: a reflector of a model, at a
place, that a route does not have where the vehicle would be on it; or a turn that the route does not take. A sequence
of models alone never decides: DCD is the end of ADCD, and ADCD with one reflector missed is ACD. So a reflector that
was NOT seen refutes nothing.

    IDLE        no start yet
    UNDECIDED   several routes are possible, each with its interval
    DECIDED     one route is possible
    LOST        contradiction, tolerance exceeded or sensors failed: nothing is reported until the next start

Distances are those of end A from the common start, in mm along each route.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from safeloc.language.expr import (
    TRUE,
    Bool,
    Expr,
    Lit,
    Num,
    Optional,
    Var,
    all_of,
    any_of,
    as_num,
    between,
    ceil_to,
    exact_to,
    floor_div,
    floor_to,
    ite,
    maximum,
    minimum,
)
from safeloc.language.machine import ANY, Initial, Machine, Transition, current_mode, modes
from safeloc.language.units import COUNT, MM, NM, NM_PER_MM
from safeloc.language.world import World
from safeloc.models.route.variables import (
    CONTRADICTION,
    NO_REASON,
    NO_START,
    SENSOR_FAILURE,
    TOLERANCE,
    Hypothesis,
    Parts,
    RouteConfig,
    parts,
)
from safeloc.models.turn_off import UNDECIDED as NO_COURSE
from safeloc.models.vocabulary.absent import margin_if, position_if

TRACE = ("RFL-D6",)


@dataclass(frozen=True, eq=False)
class After:
    """One hypothesis after the cycle."""

    possible: Bool
    low: Num
    high: Num


@dataclass(frozen=True, eq=False)
class Route:
    """The machine together with the terms it was built from, for properties to speak about."""

    machine: Machine
    own: Parts
    after: tuple[After, ...]


def machine(config: RouteConfig | None = None) -> Machine:
    """The route machine (RFL-D6)."""
    return build(parts(config or RouteConfig())).machine


def build(own: Parts) -> Route:
    """The machine over the given variables."""
    table = modes("IDLE", "UNDECIDED", "DECIDED", "LOST")
    current = current_mode(table)
    after = tuple(_after(own, route) for route in own.routes)
    ghosts, moves, choices = _world(own)
    made = Machine(
        name="route",
        modes=table,
        inputs=_inputs(own),
        state=_state(own),
        outputs=_outputs(own, current, table),
        transitions=list(_table(own, after, table)),
        world=World(
            ghosts=ghosts,
            choices=choices,
            moves=moves,
            clauses=_clauses(own, current, table),
            reads_machine="its clauses still assume what passes the machine's own checks",
        ),
        lemmas=_lemmas(own, current, table),
        definitions={f"route {route.number} fits what is seen": fits(own, route) for route in own.routes},
        mode_variable=current,
        doc=(
            "The routes on which the vehicle may be, each with its interval. Assumed: at a start the true route is among the "
            "candidates and the vehicle within the start's error; admitted distances obey the odometer's error law; a "
            "sighted reflector stands along the true route, is of the sighted model, is the one that the map input names for "
            "that route (layout rule: places of one model differ by more than all errors), and was measured within its "
            "error; a turn that was seen was taken. Nothing is assumed of what is not seen."
        ),
    )
    return Route(made, own, after)


def _inputs(own: Parts) -> list[Var | Optional]:
    named: list[Var | Optional] = [own.odometer.step, own.start, own.sighting, own.sighting_error, own.sighting_model]
    for route in own.routes:
        named += [route.candidate, route.reflector, route.model, route.course]
    return [*named, own.turned, own.authorised]


def _state(own: Parts) -> dict[Var, Initial]:
    state: dict[Var, Initial] = {**own.odometer.state(), own.refuted: 0, own.reason: NO_START}
    for route in own.routes:
        state |= {route.possible: False, route.low: 0, route.high: 0}
    return state


# ------------------------------------------------------------------ what a cycle does to a hypothesis


def fits(own: Parts, route: Hypothesis) -> Bool:
    """What is seen in this cycle is possible on the route: the reflector's model and place, and the turn."""
    low, high = _moved(own, route)
    first, last = _sighted(own, route)
    there = route.reflector.present & route.model.eq(own.sighting_model) & (first <= high) & (low <= last)
    turn = own.turned.eq(NO_COURSE) | route.course.eq(NO_COURSE) | own.turned.eq(route.course)
    return (~own.seen | there) & turn


def _moved(own: Parts, route: Hypothesis) -> tuple[Num, Num]:
    """The bounds after the measured distance, nm."""
    distance, growth = exact_to(own.odometer.distance, NM), own.odometer.growth
    return route.low + distance - growth, route.high + distance + growth


def _sighted(own: Parts, route: Hypothesis) -> tuple[Num, Num]:
    """The bounds that the sighted reflector gives, nm: where it stands, less the measured range, with its error."""
    place = exact_to(route.reflector.value - own.sighting.value, NM)
    error = exact_to(own.sighting_error, NM) + own.half_nm
    return place - error, place + error


def _after(own: Parts, route: Hypothesis) -> After:
    """Run on, narrowed by what is seen; at a start, at the start."""
    low, high = _moved(own, route)
    first, last = _sighted(own, route)
    seen = own.seen
    spread = exact_to(own.start.value, NM) + own.half_nm
    possible = ite(own.start.present, route.candidate, route.possible & fits(own, route))
    return After(
        possible,
        ite(own.start.present, -spread, ite(seen, maximum(low, first), low)),
        ite(own.start.present, spread, ite(seen, minimum(high, last), high)),
    )


def _tolerable(own: Parts, after: After) -> Bool:
    """The reported interval is no wider than the tolerance to either side of its middle, and on the line."""
    width = after.high - after.low + 2 * own.half_nm
    limit = own.config.length_limit_mm * NM_PER_MM
    return (width <= (2 * own.config.tolerance_mm - 2) * NM_PER_MM) & (after.low >= -limit) & (after.high <= limit)


# ------------------------------------------------------------------ the transition table


def _table(own: Parts, after: tuple[After, ...], table: tuple[Lit, ...]) -> Iterator[Transition]:
    idle, undecided, decided, lost = table
    carried = (undecided, decided)
    left = _count(after)
    tolerable = all_of(~one.possible | _tolerable(own, one) for one in after)
    keep = {**own.odometer.listen(), **_become(own, after), own.reason: NO_REASON}
    waiting: dict[Var, Expr] = dict(own.odometer.listen())

    def drop(reason: Lit) -> dict[Var, Expr]:
        return {**own.odometer.listen(), **_nothing(own), own.reason: reason, own.refuted: as_num(0, COUNT)}

    begun = own.start.present
    yield Transition("start without a route", table, lost, begun & left.eq(0), drop(CONTRADICTION), TRACE, 0)
    yield Transition("start on one route", table, decided, begun & left.eq(1), keep, TRACE, 1)
    yield Transition("start on several routes", table, undecided, begun & (left > 1), keep, TRACE, 1)
    yield Transition("sensors failed", carried, lost, own.odometer.failed, drop(SENSOR_FAILURE), TRACE, 2)
    yield Transition("no route fits", carried, lost, left.eq(0), drop(CONTRADICTION), TRACE, 3)
    yield Transition("tolerance exceeded", carried, lost, ~tolerable, drop(TOLERANCE), TRACE, 4)
    yield Transition("one route is left", undecided, decided, left.eq(1), keep, TRACE, 5)
    yield Transition("run on along several routes", undecided, undecided, TRUE, keep, TRACE, 6)
    yield Transition("run on along one route", decided, decided, TRUE, keep, TRACE, 6)
    yield Transition("wait for a start", idle, idle, TRUE, waiting, TRACE, 7)
    yield Transition("stay lost", lost, lost, TRUE, waiting, TRACE, 7)


def _count(after: tuple[After, ...]) -> Num:
    total = as_num(0, COUNT)
    for one in after:
        total = total + ite(one.possible, as_num(1, COUNT), 0)
    return total


def _become(own: Parts, after: tuple[After, ...]) -> dict[Var, Expr]:
    updates: dict[Var, Expr] = {}
    for route, one in zip(own.routes, after, strict=True):
        updates[route.possible] = one.possible
        updates[route.low] = ite(one.possible, one.low, 0)
        updates[route.high] = ite(one.possible, one.high, 0)
    return {**updates, own.refuted: ite(_refutes_authority(own, after), as_num(1, COUNT), 0)}


def _refutes_authority(own: Parts, after: tuple[After, ...]) -> Bool:
    """The route by movement authority is not among those possible."""
    return any_of(own.authorised.eq(route.number) & ~one.possible for route, one in zip(own.routes, after, strict=True))


def _nothing(own: Parts) -> dict[Var, Expr]:
    updates: dict[Var, Expr] = {}
    for route in own.routes:
        updates |= {route.possible: ~TRUE, route.low: as_num(0, NM), route.high: as_num(0, NM)}
    return updates


# ------------------------------------------------------------------ what is reported


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


# ------------------------------------------------------------------ the environment, and what helps to prove


def _world(own: Parts) -> tuple[dict[Var, Initial], dict[Var, Expr], list[Var]]:
    begun = own.start.present
    moves: dict[Var, Expr] = {
        own.truth: ite(begun, own.next_truth, own.truth + own.true_step),
        own.wander: ite(begun | own.odometer.admitted, own.next_wander, own.wander),
        own.true_route: ite(begun, own.next_route, own.true_route),
    }
    choices: list[Var] = [own.true_step, own.next_truth, own.next_wander, own.next_route]
    return dict.fromkeys(moves, ANY), moves, choices


def _clauses(own: Parts, current: Num, table: tuple[Lit, ...]) -> dict[str, Bool]:
    begun, after = own.start.present, own.truth + own.true_step
    carried = ~begun & current.one_of(table[1], table[2])
    most = own.odometer.most_error
    error = own.true_step - exact_to(own.odometer.distance, NM) - (own.next_wander - own.wander)
    spread = exact_to(own.start.value, NM)
    started = between(-spread, own.next_truth, spread) & any_of(
        own.next_route.eq(route.number) & route.candidate for route in own.routes
    )
    seen = [(carried & own.true_route.eq(route.number)).implies(_is_seen(own, route, after)) for route in own.routes]
    lawful = (own.odometer.admitted & ~begun).implies(between(-most, error, most))
    return {
        "admitted distances are true within their error": lawful,
        "the start names the true route and place": begun.implies(started),
        "what a route shows is seen on it": all_of(seen),
        "the vehicle stays on the line": between(own.truth.low, after, own.truth.high),
    }


def _is_seen(own: Parts, route: Hypothesis, after: Num) -> Bool:
    """Of the true route: what is sighted is the reflector that the map names, and a turn seen is a turn taken."""
    error = exact_to(own.sighting_error, NM)
    off = exact_to(route.reflector.value - own.sighting.value, NM) - after
    is_it = route.reflector.present & route.model.eq(own.sighting_model) & between(-error, off, error)
    turn = own.turned.eq(NO_COURSE) | route.course.eq(NO_COURSE) | own.turned.eq(route.course)
    return own.seen.implies(is_it) & turn


def _lemmas(own: Parts, current: Num, table: tuple[Lit, ...]) -> dict[str, Bool]:
    carried = current.one_of(table[1], table[2])
    lemmas: dict[str, Bool] = {}
    for route in own.routes:
        inside = route.possible & between(route.low, own.truth - own.wander, route.high)
        lemmas[f"route {route.number} holds the truth"] = (carried & own.true_route.eq(route.number)).implies(inside)
        lemmas[f"route {route.number} is in order"] = route.possible.implies(carried & (route.low <= route.high))
        fine = _tolerable(own, After(route.possible, route.low, route.high))
        lemmas[f"route {route.number} is tolerable"] = route.possible.implies(fine)
        lemmas[f"route {route.number} rests at zero"] = route.possible | (route.low.eq(0) & route.high.eq(0))
    now = tuple(After(route.possible, route.low, route.high) for route in own.routes)
    lemmas["one route while decided"] = current.eq(table[2]).iff(_count(now).eq(1))
    lemmas["several while undecided"] = current.eq(table[1]).iff(_count(now) > 1)
    return lemmas
