"""Bounds of the front by the record and the top speed alone, and the time for which they can be used (FVA-1, FVA-2)."""

from __future__ import annotations

from collections.abc import Iterator
from functools import partial

from safeloc.language.expr import Bool, Lit, Num, before, exact_to, ite, maximum, minimum, with_unit
from safeloc.language.spec import Property, always
from safeloc.language.units import UM
from safeloc.models.verification import Verification
from safeloc.models.verification.variables import Parts

REQUIREMENTS = ("FVA-1", "FVA-10", "FVA-2", "FVA-11")
for_all_inputs = partial(always, requirements=REQUIREMENTS, unconditional=True)


def _fastest_um(own: Parts) -> int:
    """Return the run of a cycle at top speed, um, rounded up to a millimetre."""
    return (own.config.max_speed_mm_s * own.config.period_ms + 999) // 1_000 * 1_000


def _reached_um(own: Parts) -> tuple[Num, Num]:
    """Return bounds of the front, um, from the inputs of a cycle and the state before it."""
    farther = with_unit(own.record_age * _fastest_um(own), UM)
    told = exact_to(own.record_place_low, UM) - farther, exact_to(own.record_place_high, UM) + farther
    last = exact_to(before(own.possible_low), UM), exact_to(before(own.possible_high), UM)
    served = last[1] <= last[0] + own.config.place_doubt_limit_mm * 1_000
    more = ite(served, Lit(_fastest_um(own), UM), 0)
    return ite(own.due, told[0], last[0] - more), ite(own.due, told[1], last[1] + more)


def _in_doubt(own: Parts) -> Bool:
    """Return the condition that the bounds are farther apart than permitted."""
    low, high = _reached_um(own)
    return high > low + own.config.place_doubt_limit_mm * 1_000


def beyond_reach(own: Parts) -> Bool:
    """Return the condition that the fibre's interval lies beyond the bounds by more than the tolerance, while these can be used."""
    (low, high), place, tolerance = _reached_um(own), own.fibre_position, own.config.place_tolerance_mm * 1_000
    there = own.associated & own.located & place.present & ~_in_doubt(own)
    above = exact_to(place.value - own.fibre_margin_below, UM) > high + tolerance
    return there & (above | (exact_to(place.value + own.fibre_margin_above, UM) < low - tolerance))


def properties(model: Verification) -> Iterator[Property]:
    """Yield the properties: the bounds come from the record, widen by the fastest run, and can be used up to their limit."""
    yield from _bounds(model)
    yield from _reported(model)


def _bounds(model: Verification) -> Iterator[Property]:
    """Claim the bounds of the front, and their limit."""
    machine, own = model.machine, model.own
    _, withheld, trusted, _ = machine.modes
    known, (low, high) = machine.mode.one_of(withheld, trusted), _reached_um(own)
    yield for_all_inputs(
        "bounds of the front widen by the fastest run",
        known.implies(exact_to(own.possible_low, UM).eq(low) & exact_to(own.possible_high, UM).eq(high)),
        statement="the bounds of the front are the record's place, wider by the run at top speed in either direction for "
        "each cycle of its age and for each cycle since, until they are wider than permitted",
    )
    yield for_all_inputs(
        "a doubtful place is withheld",
        _in_doubt(own).implies(~machine.flag("trusted")),
        statement="if the record and the top speed leave more open than permitted, the train is not trusted",
    )


def _reported(model: Verification) -> Iterator[Property]:
    """Claim the outputs for the bounds."""
    machine, own = model.machine, model.own
    handed_over = machine.output("handover_place_low_mm"), machine.output("handover_place_high_mm")
    limit = own.config.position_limit_mm
    yield for_all_inputs(
        "bounds of the front are handed over",
        machine.flag("handover_trusted").implies(
            handed_over[0].eq(maximum(own.possible_low, -limit)) & handed_over[1].eq(minimum(own.possible_high, limit))
        ),
        statement="the bounds of the front are handed over to the neighbour, within the line",
        requirements=("FVA-D1", "FVA-2", "FVA-11"),
    )
    doubt = own.possible_high + own.config.place_tolerance_mm - own.possible_low
    told = machine.output("place_doubt_mm")
    yield for_all_inputs(
        "the doubt of a place is reported",
        ite(machine.flag("trusted"), told.eq(doubt), told.eq(0)),
        statement="with a trusted place the machine reports how far from the front it can be if the fibre is wrong; "
        "without one it reports zero",
    )
