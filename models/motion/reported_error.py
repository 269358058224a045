"""The error of the distance that motion reports: a figure for the machines that use it, beside the world and not part of it.

The reported distance lies between those of both units, and the difference that the machine has not yet added to its error
bound (`apart`) is part of its one-off error, as is the place between two pulses of a vehicle that stands. So this error follows the machine. It is _DEFINED here from the true error of the
lawful unit: the clause excludes no course of the world, and the law that the users assume of the distance is proved from it.
"""

from __future__ import annotations

from dataclasses import replace

from safeloc.language.expr import Bool, Num, as_num, ite
from safeloc.language.units import NM
from safeloc.language.world import Law, World
from safeloc.models.motion.unit_check import UnitCheck
from safeloc.models.motion.world import ODOMETER_LAWFUL, CheckGhosts, Surroundings

_DEFINED = "the one-off error of the reported run"


def with_reported_error(world: World, own: Surroundings, check: UnitCheck) -> World:
    """Return the world with the error of the reported distance."""
    seen = own.ghosts.units
    assert seen is not None
    law = Law(
        seen.next_reported.eq(own.wander_after + _not_yet_added(seen, check.apart_after, own.between_pulses_after)),
        "The one-off error of the reported run is that of the lawful unit. If the check unit is the lawful one, the difference "
        "of both units that the machine has not yet added to its error bound counts as well, and the place between two pulses "
        "at which the vehicle stands or last stood. A definition: it excludes nothing.",
        source="[D] a definition",
        owner="nobody",
        shares="it defines the error of what the machine tells, and so says what the machine has not added to the error yet",
    )
    return replace(
        world,
        moves={**world.moves, seen.reported: seen.next_reported},
        clauses={**world.clauses, _DEFINED: law},
        reads_machine="the error of what a machine tells is defined by what it tells; no sensor's law reads the machine",
    )


def lemmas(own: Surroundings, check: UnitCheck) -> dict[str, Bool]:
    """Return the lemmas: the reported distance errs as defined, and the machine checks distances as the world does."""
    seen = own.ghosts.units
    assert seen is not None
    found = {_DEFINED: seen.reported.eq(seen.wander + _not_yet_added(seen, check.apart, own.between_pulses))}
    for unit, ghosts in ((check.odometer, seen.odometer), (check.unit, seen.check)):
        found[f"machine and world agree on the last distance of {unit.measured.value.name}"] = unit.gap.eq(
            ghosts.silent
        ) & unit.last.eq(ghosts.last_delivered)
    return found


def _not_yet_added(seen: CheckGhosts, apart: Num, between_pulses: Num) -> Num:
    return ite(seen.lawful_unit.eq(ODOMETER_LAWFUL), as_num(0, NM), apart + between_pulses)
