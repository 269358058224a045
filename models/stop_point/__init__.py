"""Precise stop at a platform on the measured distance, and repositioning after an overrun (RFL-D7; source l. 245-265).

A platform has several stop points, for vehicles of different lengths. The mission selects one of them; from then on the
machine orders what the vehicle may do.

    IDLE           no stop is pending: the machine orders nothing
    APPROACH       the stop lies ahead: the vehicle may proceed
    BRAKING        the distance left is no longer than the braking distance: brake
    STOPPED        standing within the stop window: hold, doors may open
    SHORT          standing before the window: hold
    CREEPING       forward at reduced speed into the window
    OVERRUN        possibly beyond the window: hold
    REPOSITIONING  backwards at reduced speed into the window
    HELD           the stop cannot be made: hold until released

The vehicle's front end lies in the interval that the reflector machine reports. "Beyond" is judged by the interval's far end,
"short" by its near end: a vehicle is in place only if the whole interval fits into the window.
"""

from __future__ import annotations

from safeloc.language.expr import Bool, Expr, Lit, Num, all_of, ite
from safeloc.language.machine import Machine, Model, current_mode, modes
from safeloc.language.units import MM_S
from safeloc.models.stop_point.cycle import Judgement, judge
from safeloc.models.stop_point.table import rows
from safeloc.models.stop_point.variables import (
    BRAKE,
    CREEP,
    HOLD,
    MODES,
    NO_ORDER,
    PROCEED,
    REVERSE,
    Parts,
    StopPointConfig,
    parts,
)
from safeloc.models.stop_point.world import world

_ORDERS = (NO_ORDER, PROCEED, BRAKE, HOLD, HOLD, CREEP, HOLD, REVERSE, HOLD)


def machine(config: StopPointConfig | None = None) -> Machine:
    """Return the stop-point machine of a vehicle (RFL-D7)."""
    return build(parts(config or StopPointConfig())).machine


class StopPoint(Model[Parts]):
    """The machine with the variables that its properties read."""


def build(own: Parts) -> StopPoint:
    """Return the machine over the given variables."""
    table = modes(*MODES)
    current, judgement = current_mode(table), judge(own)
    made = own.declared.machine(
        name="stop_point",
        modes=table,
        outputs=_outputs(own, current, table),
        transitions=list(rows(own, judgement, table)),
        world=world(own),
        lemmas=_lemmas(own, current, table),
        definitions=_definitions(judgement),
        doc=(
            "Precise stop at a selected stop point on the measured distance, with repositioning after an overrun. Assumed: "
            "a valid interval holds the truth (the reflector machine's own proof discharges this), speed is measured "
            "within its error, and an order to brake stops the vehicle within reaction and braking distance. Nothing is "
            "assumed of the driver."
        ),
    )
    return StopPoint(made, own)


def _outputs(own: Parts, current: Num, table: tuple[Lit, ...]) -> dict[str, Expr]:
    order: Num = NO_ORDER
    for mode, given in zip(table[1:], _ORDERS[1:], strict=True):
        order = ite(current.eq(mode), given, order)
    slow = current.one_of(table[MODES.index("CREEPING")], table[MODES.index("REPOSITIONING")])
    return {
        "order": order,
        "speed_limit_mm_s": ite(slow, Lit(own.config.reduced_speed_mm_s, MM_S), 0),
        "in_position": current.eq(table[MODES.index("STOPPED")]),
        "pending_stop": own.pending_number,
        "distance_mm": own.to_go,
        "reason": own.reason,
    }


def _lemmas(own: Parts, current: Num, table: tuple[Lit, ...]) -> dict[str, Bool]:
    """Return the lemmas: a stop is pending in every mode but IDLE; without one, no place is stored and no distance shown."""
    idle = current.eq(table[0])
    return {
        "a stop is pending unless idle": idle.iff(own.pending_number.eq(0)),
        "no distance while idle": idle.implies(own.to_go.eq(0)),
        "no place while idle": idle.implies(all_of(kept.eq(0) for kept in (own.stop, own.before, own.after))),
    }


def _definitions(cycle: Judgement) -> dict[str, Expr]:
    return {
        "possibly beyond the window": cycle.beyond,
        "possibly before the window": cycle.short,
        "standing": cycle.standing,
        "braking distance has come": cycle.brake_now,
        "backwards too fast": cycle.backwards_too_fast,
        "forwards too fast": cycle.forwards_too_fast,
    }
