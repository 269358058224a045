"""The additional localization: which place by time of flight is compared with the place by sections (FWG-4, FWG-6, FWG-7).

    COMPARED      the place of this cycle is handed on for comparison
    NOT_COMPARED  there is none, or a difference would say nothing: the reason is reported

The threshold of F is fixed. So a place is compared only if a true one cannot be farther off than it: if its margins are narrow enough
for what is left of the threshold, and if the amplitude came in the cycle before. After a cycle without an amplitude a position signal may
belong to an edge that was passed long ago; the first cycle with one before it is compared again.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from safeloc.language.declared import Declared
from safeloc.language.expr import (
    TRUE,
    Bool,
    Lit,
    Num,
    NumVar,
    Optional,
    between,
    boolean,
    choice,
    enumeration,
    exact_to,
    members,
    number,
    optional,
)
from safeloc.language.machine import ANY, Model, Transition, current_mode, modes
from safeloc.language.rows import Updates
from safeloc.language.units import MM, NM, NM_PER_MM
from safeloc.language.world import Law
from safeloc.models.fibre.variables import Parts as FibreParts
from safeloc.models.fibre_timed.configuration import FibreTimedConfig
from safeloc.models.time_of_flight.variables import Parts as FlightParts
from safeloc.models.vocabulary.absent import position_if
from safeloc.models.vocabulary.first_of import first_of

NAME = "additional"
REQUIREMENTS = ("FWG-4", "FWG-6", "FWG-7")
TRUE_PLACE = "the place by time of flight holds the end"
WHY = members("additional_reason", "COMPARED", "NO_PLACE", "AMPLITUDE_MISSED", "TOO_WIDE", "OFF_THE_LINE")
COMPARED, NO_PLACE, AMPLITUDE_MISSED, TOO_WIDE, OFF_THE_LINE = WHY


class Parts:
    """The variables of the machine.

    amplitude            shared with the fibre machine: the pattern's amplitude
    position, below, above  the place by time of flight of this cycle, and its margins
    place                the place that is compared; amplitude_came: the amplitude came in this cycle
    why                  why a place is compared, or not
    truth, next_truth    ghosts: the true place of the end, nm
    """

    def __init__(self, config: FibreTimedConfig, fibre: FibreParts, flight: FlightParts) -> None:
        self.declared = declared = Declared()
        limit, wide, line = config.fibre.position_limit_mm, flight.track_high.high, fibre.ghosts.truth.high
        self.limit_mm, self.margin_mm = limit, config.comparable_margin_mm
        self.amplitude = declared.sensor(fibre.amplitude)
        self.position: Optional = declared.sensor(optional("place_mm", MM, -wide, wide))
        self.below = declared.sensor(number("margin_below_mm", MM, 0, 2 * wide))
        self.above = declared.sensor(number("margin_above_mm", MM, 0, 2 * wide))
        self.place: NumVar = declared.state(number("compared_place_mm", MM, -limit, limit), first=0)
        self.amplitude_came = declared.state(boolean("amplitude_came"), first=False)
        self.why = declared.state(choice("why", enumeration(WHY)), first=NO_PLACE)
        self.truth = declared.ghost(number("truth_nm", NM, -line, line), first=ANY)
        self.next_truth = declared.choice(number("next_truth_nm", NM, -line, line))


@dataclass(frozen=True, eq=False)
class Additional(Model[Parts]):
    """The machine and its variables."""


def additional(own: Parts) -> Additional:
    """Return the machine over the given variables."""
    table = modes("NOT_COMPARED", "COMPARED")
    current = current_mode(table)
    compared = current.eq(table[1])
    made = own.declared.machine(
        name=NAME,
        modes=table,
        outputs={"compared": compared, "compared_mm": position_if(compared, own.place), "reason": own.why},
        transitions=list(_table(own, table)),
        world=own.declared.world(
            moves={own.truth: own.next_truth},
            clauses={
                TRUE_PLACE: Law(
                    own.position.present.implies(_holds(own, own.next_truth)),
                    "While the time of flight gives a place, its bounds contain the end of the train after the cycle.",
                    source="[D] containment of that machine, whose own proof it is",
                    owner="supplier",
                    check="the place by the sections passed next",
                )
            },
        ),
        lemmas={
            "a compared place is the end's, within the comparable margin": compared.implies(
                between(-own.margin_mm * NM_PER_MM, exact_to(own.place, NM) - own.truth, own.margin_mm * NM_PER_MM)
            )
        },
        doc=(
            "Which place by time of flight is compared with the place by sections. Assumed: its bounds contain the end of the train."
        ),
    )
    return Additional(made, own)


def _holds(own: Parts, truth: Num) -> Bool:
    low, high = own.position.value - own.below, own.position.value + own.above
    return between(exact_to(low, NM), truth, exact_to(high, NM))


def _table(own: Parts, table: tuple[Lit, ...]) -> Iterator[Transition]:
    not_compared, compared = table
    came: Updates = {own.amplitude_came: own.amplitude.present}
    flaws = [
        (~own.position.present, NO_PLACE),
        (~own.amplitude_came, AMPLITUDE_MISSED),
        ((own.below > own.margin_mm) | (own.above > own.margin_mm), TOO_WIDE),
        (~between(-own.limit_mm, own.position.value, own.limit_mm), OFF_THE_LINE),
    ]
    why = first_of(*flaws, default=COMPARED)
    yield Transition(
        "place compared", table, compared, why.eq(COMPARED),
        {**came, own.place: own.position.value, own.why: COMPARED}, REQUIREMENTS, 0)  # fmt: skip
    yield Transition(
        "place not compared", table, not_compared, TRUE, {**came, own.place: 0, own.why: why}, REQUIREMENTS, 1)  # fmt: skip
