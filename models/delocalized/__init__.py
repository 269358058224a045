"""The delocalized state: what a vehicle does with a position it may no longer use (MRK-D1, MRK-D2).

It stands behind any way of locating. When the source reports nothing, or less than the tolerance asks for, the
vehicle is delocalized in the same step: the first reason is latched, the host is told to be restrictive, and no
position is passed on. It is left only when the source is valid AND an absolute reference passed its checks.
"""

from __future__ import annotations

from safeloc.config import Config, quantity
from safeloc.language.declared import Declared
from safeloc.language.expr import Bool, NumVar, between, boolean, choice, enumeration, exact_to, ite, number
from safeloc.language.machine import ANY, Machine, Transition, current_mode, modes
from safeloc.language.rows import Updates, together
from safeloc.language.units import MM, NM, NM_PER_MM
from safeloc.language.world import Law, World
from safeloc.models.vocabulary.absent import margin_if, position_if
from safeloc.models.vocabulary.reasons import LOCATED, NO_REFERENCE, REASON, TOLERANCE


class DelocalizedConfig(Config):
    """What the supervising machine depends on."""

    tolerance_mm: int = quantity(30_000, "mm", 1, 500_000, "[S] OCORA 7239: 30 m on main line")
    position_limit_mm: int = quantity(1_000_000_000, "mm", 1_000, 10_000_000_000, "[D] 1 000 km of line")


def machine(config: DelocalizedConfig | None = None) -> Machine:
    """The delocalized machine (MRK-D1, MRK-D2)."""
    config = config or DelocalizedConfig()
    limit, tolerance = config.position_limit_mm, config.tolerance_mm
    reasons = enumeration(REASON)
    reach = (limit + 20 * tolerance) * NM_PER_MM
    declared = Declared()
    valid = declared.sensor(boolean("source_valid"))
    reference = declared.sensor(boolean("reference_accepted"))
    cause = declared.sensor(choice("source_reason", reasons))
    seen = declared.sensor(number("source_position_mm", MM, -limit, limit))
    seen_above = declared.sensor(number("source_margin_above_mm", MM, 0, 10 * tolerance))
    seen_below = declared.sensor(number("source_margin_below_mm", MM, 0, 10 * tolerance))
    position = declared.state(number("passed_position_mm", MM, -limit, limit), first=0)
    above = declared.state(number("passed_margin_above_mm", MM, 0, tolerance), first=0)
    below = declared.state(number("passed_margin_below_mm", MM, 0, tolerance), first=0)
    reason = declared.state(choice("latched_reason", reasons), first=NO_REFERENCE)
    truth = declared.ghost(number("truth_nm", NM, -reach, reach), first=ANY)
    next_truth = declared.choice(number("next_truth_nm", NM, -reach, reach))

    table = modes("DELOCALIZED", "LOCALIZED")
    delocalized, localized = table
    current = current_mode(table)
    tolerable = (seen_above <= tolerance) & (seen_below <= tolerance)
    usable = valid & tolerable
    stated = ite(valid, TOLERANCE, ite(cause.eq(LOCATED), NO_REFERENCE, cause))
    nothing: Updates = {position: 0, above: 0, below: 0}
    lost = together(nothing, {reason: stated})
    passed: Updates = {position: seen, above: seen_above, below: seen_below, reason: LOCATED}
    return Machine(
        name="delocalized",
        modes=table,
        inputs=declared.inputs,
        state=declared.states,
        outputs={
            "restrictive": current.eq(delocalized),
            "position_mm": position_if(current.eq(localized), position),
            "margin_above_mm": margin_if(current.eq(localized), above),
            "margin_below_mm": margin_if(current.eq(localized), below),
            "reason": reason,
        },
        transitions=[
            Transition("position lost", localized, delocalized, ~usable, lost, ("MRK-D1", "MRK-D2"), 0),
            Transition("position passed on", localized, localized, set=passed, requirements=("MRK-D1",), rank=1),
            Transition("reference accepted", delocalized, localized, usable & reference, passed, ("MRK-D1",), 1),
            Transition("stay restrictive", delocalized, delocalized, set=nothing, requirements=("MRK-D2",), rank=2),
        ],
        world=World(
            ghosts=declared.ghosts,
            choices=declared.choices,
            moves={truth: next_truth},
            clauses={
                "a valid position holds the truth": Law(
                    valid.implies(_holds(seen, seen_below, seen_above, next_truth)),
                    "While the way of locating behind it reports a valid position, its interval holds the true position.",
                    source="[D] containment of that machine, whose own proof it is",
                    owner="supplier",
                    check="replayed recordings with a known true position",
                )
            },
        ),
        lemmas={
            "a passed position holds the truth": current.eq(localized).implies(_holds(position, below, above, truth))
        },
        doc=(
            "Stands behind a way of locating. Passes its position on while it is valid and within tolerance; otherwise "
            "the vehicle is delocalized in the same step, with the first reason latched and the host told to be "
            "restrictive, until an absolute reference passed its checks. Assumed: a valid source interval holds the "
            "truth (the source's own proof discharges this)."
        ),
    )


def _holds(position: NumVar, below: NumVar, above: NumVar, truth: NumVar) -> Bool:
    centre = exact_to(position, NM)
    return between(centre - exact_to(below, NM), truth, centre + exact_to(above, NM))
