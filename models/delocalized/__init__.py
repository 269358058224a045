"""The delocalized state: what a vehicle does with a position it may no longer use (MRK-D1, MRK-D2).

It stands behind any way of locating. When the source reports no position, or one wider than the tolerance, the vehicle is
delocalized in the same step: the machine latches the first reason, tells the host to be restrictive, and passes no position
on. The vehicle leaves this state only when the source is valid AND an absolute reference passed its checks.
"""

from __future__ import annotations

from safeloc.config import Config, quantity
from safeloc.language.declared import Declared
from safeloc.language.expr import (
    TRUE,
    Bool,
    Expr,
    Lit,
    NumVar,
    Var,
    between,
    boolean,
    choice,
    enumeration,
    exact_to,
    ite,
    number,
)
from safeloc.language.machine import ANY, Machine, Transition, current_mode, modes
from safeloc.language.rows import Updates, together
from safeloc.language.units import MM, NM, NM_PER_MM
from safeloc.language.world import Law
from safeloc.models.vocabulary.absent import margin_if, position_if, wired_interval
from safeloc.models.vocabulary.reasons import LOCATED, NO_REFERENCE, REASON, TOLERANCE


class DelocalizedConfig(Config):
    """Limits of the delocalized machine."""

    tolerance_mm: int = quantity(30_000, "mm", 1, 500_000, "[S] OCORA 7239: 30 m on main line")
    position_limit_mm: int = quantity(1_000_000_000, "mm", 1_000, 10_000_000_000, "[D] 1 000 km of line")


class Parts:
    """The variables of the machine and its world.

    valid, reference_accepted, source_reason, position, above, below   inputs: outputs of the source
    passed_position, passed_margin_above, passed_margin_below                state: the position that is passed on, and its margins
    reason                                            state: the latched reason
    truth, next_truth                                 ghosts: the true place before the step and after it, nm
    """

    def __init__(self, config: DelocalizedConfig) -> None:
        self.declared = declared = Declared()
        limit, tolerance = config.position_limit_mm, config.tolerance_mm
        reasons, reach = enumeration(REASON), (limit + 20 * tolerance) * NM_PER_MM
        self.tolerance_mm = tolerance
        self.valid = declared.sensor(boolean("source_valid"))
        self.reference_accepted = declared.sensor(boolean("reference_accepted"))
        self.source_reason = declared.sensor(choice("source_reason", reasons))
        self.position = declared.sensor(number("source_position_mm", MM, -limit, limit))
        self.above = declared.sensor(number("source_margin_above_mm", MM, 0, 10 * tolerance))
        self.below = declared.sensor(number("source_margin_below_mm", MM, 0, 10 * tolerance))
        self.passed_position = declared.state(number("passed_position_mm", MM, -limit, limit), first=0)
        self.passed_margin_above = declared.state(number("passed_margin_above_mm", MM, 0, tolerance), first=0)
        self.passed_margin_below = declared.state(number("passed_margin_below_mm", MM, 0, tolerance), first=0)
        self.reason = declared.state(choice("latched_reason", reasons), first=NO_REFERENCE)
        self.truth = declared.ghost(number("truth_nm", NM, -reach, reach), first=ANY)
        self.next_truth = declared.choice(number("next_truth_nm", NM, -reach, reach))

    def reads(self, source: Machine) -> dict[Var, Expr]:
        """Return the wires of these inputs to the outputs of a source."""
        position, below, above = wired_interval(source)
        return {
            self.valid: source.flag("valid"),
            self.reference_accepted: source.flag("reference_accepted"),
            self.source_reason: source.output("reason"),
            self.position: position,
            self.above: above,
            self.below: below,
        }


def parts(config: DelocalizedConfig) -> Parts:
    """Declare the variables of one machine."""
    return Parts(config)


def machine(config: DelocalizedConfig | None = None) -> Machine:
    """Return the delocalized machine (MRK-D1, MRK-D2)."""
    return build(parts(config or DelocalizedConfig()))


def build(own: Parts) -> Machine:
    """Build the machine over the given variables."""
    table = modes("DELOCALIZED", "LOCALIZED")
    current = current_mode(table)
    localized = current.eq(table[1])
    return own.declared.machine(
        name="delocalized",
        modes=table,
        outputs={
            "restrictive": current.eq(table[0]),
            "position_mm": position_if(localized, own.passed_position),
            "margin_above_mm": margin_if(localized, own.passed_margin_above),
            "margin_below_mm": margin_if(localized, own.passed_margin_below),
            "reason": own.reason,
        },
        transitions=_table(own, table),
        world=own.declared.world(
            moves={own.truth: own.next_truth},
            clauses={
                "a valid position holds the truth": Law(
                    own.valid.implies(_holds(own.position, own.below, own.above, own.next_truth)),
                    "While the way of locating behind it reports a valid position, its interval holds the true position.",
                    source="[D] containment of that machine, whose own proof it is",
                    owner="supplier",
                    check="replayed recordings with a known true position",
                )
            },
        ),
        lemmas={
            "a passed position holds the truth": localized.implies(
                _holds(own.passed_position, own.passed_margin_below, own.passed_margin_above, own.truth)
            )
        },
        doc=(
            "Stands behind a way of locating. Passes its position on while it is valid and within tolerance; otherwise "
            "the vehicle is delocalized in the same step, with the first reason latched and the host told to be "
            "restrictive, until an absolute reference passed its checks. Assumed: a valid source interval holds the "
            "truth (the source's own proof discharges this)."
        ),
    )


def _table(own: Parts, table: tuple[Lit, ...]) -> list[Transition]:
    delocalized, localized = table
    tolerable = (own.above <= own.tolerance_mm) & (own.below <= own.tolerance_mm)
    usable = own.valid & tolerable
    stated = ite(own.valid, TOLERANCE, ite(own.source_reason.eq(LOCATED), NO_REFERENCE, own.source_reason))
    nothing: Updates = {own.passed_position: 0, own.passed_margin_above: 0, own.passed_margin_below: 0}
    lost = together(nothing, {own.reason: stated})
    passed: Updates = {
        own.passed_position: own.position, own.passed_margin_above: own.above, own.passed_margin_below: own.below, own.reason: LOCATED,
    }  # fmt: skip
    return [
        Transition("position lost", localized, delocalized, ~usable, lost, ("MRK-D1", "MRK-D2"), 0),
        Transition("position passed on", localized, localized, TRUE, passed, ("MRK-D1",), 1),
        Transition(
            "reference accepted", delocalized, localized, usable & own.reference_accepted, passed, ("MRK-D1",), 1
        ),
        Transition("stay restrictive", delocalized, delocalized, TRUE, nothing, ("MRK-D2",), 2),
    ]


def _holds(position: NumVar, below: NumVar, above: NumVar, truth: NumVar) -> Bool:
    centre = exact_to(position, NM)
    return between(centre - exact_to(below, NM), truth, centre + exact_to(above, NM))
