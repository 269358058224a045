"""Lemmas for the proofs of the section between axle counters."""

from __future__ import annotations

from safeloc.language.expr import Bool, Lit, NumVar, all_of
from safeloc.models.axle_section.variables import (
    FROM_HIGH,
    FROM_LOW,
    NOBODY,
    TURNED_HIGH,
    TURNED_LOW,
    Parts,
)


def lemmas(own: Parts, current: NumVar, table: tuple[Lit, ...]) -> dict[str, Bool]:
    """Return the lemmas: a believed count is true; a sweep's count differs from it by the axles that stood in the way."""
    _, clear, occupied, _, sweeping = table
    sweeps = current.eq(sweeping)
    found_none = own.sweep.ne(NOBODY) & own.true_axles_before_sweep.eq(0)
    return {
        "a count that is believed is true": current.one_of(clear, occupied).implies(own.axles.eq(own.counted_axles)),
        "clear is zero": current.eq(clear).implies(own.counted_axles.eq(0)),
        "no fewer axles than are counted": sweeps.implies(own.axles >= own.counted_axles),
        "a sweep that met nothing counts truly": (sweeps & found_none).implies(own.axles.eq(own.counted_axles)),
        "the ways of the sweep are known": sweeps.implies(_ways_known(own)),
    }


def _ways_known(own: Parts) -> Bool:
    (in_low, in_high), (out_low, out_high) = own.swept_from, own.swept_to
    known = {
        FROM_LOW: in_low,
        FROM_HIGH: in_high,
        TURNED_LOW: in_low & out_low,
        TURNED_HIGH: in_high & out_high,
    }
    return all_of(own.sweep.eq(where).implies(latches) for where, latches in known.items())
