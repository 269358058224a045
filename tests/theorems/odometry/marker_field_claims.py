"""The run between two resets, for every vehicle length and every marker spacing (MRK-D5)."""

from __future__ import annotations

from collections.abc import Iterator
from functools import partial

from safeloc.language.expr import Bool, Num, ite, maximum
from safeloc.language.spec import Property, always, reachable
from tests.theorems.odometry.marker_field import MarkerField

GIVEN = "forward run, exact measurement, both readers read every marker, one error law for all units"
SOURCES = ("MRK-D5", "MRK-D3", "MRK-1")
under_assumption = partial(always, requirements=SOURCES, assumption=GIVEN)


def properties(whole: MarkerField) -> list[Property]:
    """Claim the run as a function of the vehicle's place, its worst value, and that this is attained."""
    return list(_gain(whole) if whole.arrangement.pairs else _no_gain(whole))


def _gain(whole: MarkerField) -> Iterator[Property]:
    valid, run, past, spacing = _terms(whole)
    lead = whole.lead_mm
    worst = maximum(lead, spacing - lead)
    of = "L" if whole.arrangement.under == 0 else f"L - {whole.arrangement.under} D"
    yield under_assumption(
        "run between resets",
        valid.implies(run.eq(ite(past < lead, past, past - lead))),
        statement=f"with a vehicle {whole.arrangement.name}, the run is that of end A past its marker up to {of}, and that "
        "of end B past the same marker from there on",
    )
    yield under_assumption(
        "worst run", valid.implies(run < worst), statement=f"no run between two resets comes to max({of}, D - ({of}))"
    )
    yield reachable(
        "worst run attained on M1", valid & run.eq(worst - 1) & (lead > spacing - lead), requirements=SOURCES
    )
    yield reachable(
        "worst run attained on M2", valid & run.eq(worst - 1) & (lead < spacing - lead), requirements=SOURCES
    )


def _no_gain(whole: MarkerField) -> Iterator[Property]:
    valid, run, past, spacing = _terms(whole)
    yield under_assumption(
        "no gain",
        valid.implies(run.eq(past)),
        statement=f"with a vehicle {whole.arrangement.name}, the run is that of end A past its marker, as with one reader",
    )
    yield reachable("a whole spacing is run", valid & run.eq(spacing - 1), requirements=SOURCES)


def _terms(whole: MarkerField) -> tuple[Bool, Num, Num, Num]:
    """Return the flag of a reported position; the run behind it; the distance of end A past its marker; the spacing."""
    machine, own = whole.source.machine, whole.own
    valid, run = whole.says.bool(machine.flag("valid")), whole.says.num(machine.output("distance_run_mm"))
    return valid, run, own.num(whole.field.phase_a), own.num(whole.field.spacing)
