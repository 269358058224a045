"""What must hold of position from satellites (SAT-1, SAT-5, SAT-6)."""

from __future__ import annotations

from collections.abc import Iterator

from safeloc.expr import all_of, any_of, as_num, between, exact_to, ite
from safeloc.models.satellite import Satellite
from safeloc.models.satellite_parts.variables import ACCEPTED, LOCATED, SPARE
from safeloc.models.satellite_selection import EXCLUDED, USABLE
from safeloc.spec import Property, always, earlier_bool, earlier_num
from safeloc.units import COUNT, NM

LAW = "greatest acceleration; a solution of usable satellites is within its protection level; a reference within its accuracy"


def properties(model: Satellite) -> list[Property]:
    """Every property of selection and position together."""
    return [*_safety(model), *_solutions(model), *_coasting(model)]


def _safety(model: Satellite) -> Iterator[Property]:
    machine, own = model.machine, model.own
    of = model.composition.of(machine)
    valid = of.bool(machine.flag("valid"))
    position, under, over = (
        exact_to(of.num(machine.output(f"{name}_mm")), NM) for name in ("position", "under", "over")
    )
    yield always(
        "containment",
        valid.implies(between(position - under, of.num(own.truth), position + over)),
        statement="the reported interval along the track holds the true position",
        trace=("SAT-1", "SAT-5"),
        assumption=LAW,
    )
    tolerance = own.config.tolerance_mm
    yield always(
        "tolerance",
        (of.num(machine.output("over_mm")) <= tolerance) & (of.num(machine.output("under_mm")) <= tolerance),
        statement="a reported interval is never wider than the tolerable error, on either side",
        trace=("SAT-5",),
        unconditional=True,
    )
    yield always(
        "no resurrection",
        (valid & ~earlier_bool(valid)).implies(of.bool(machine.fired("trusted reference"))),
        statement="a position is reported again only through a trusted reference: no solution starts it",
        trace=("SAT-1", "SAT-5"),
        unconditional=True,
    )
    yield always(
        "reason stated",
        of.num(own.reason).eq(LOCATED).iff(valid),
        statement="a reason is stated exactly while nothing is reported",
        trace=("SAT-5",),
        unconditional=True,
    )


def _solutions(model: Satellite) -> Iterator[Property]:
    own, of = model.own, model.composition.of(model.machine)
    channels = [model.composition.of(model.selection.machine).num(one.standing) for one in model.selection.own.channels]
    accepted = of.num(own.judged).eq(ACCEPTED)
    used = [of.bool(flag) for flag in own.used]
    yield always(
        "only usable satellites count",
        accepted.implies(all_of(~flag | standing.eq(USABLE) for flag, standing in zip(used, channels, strict=True))),
        statement="the state is computed only from satellites that are in the list of usable ones in the same cycle",
        trace=("SAT-5",),
        unconditional=True,
    )
    yield always(
        "an excluded one never counts",
        any_of(flag & standing.eq(EXCLUDED) for flag, standing in zip(used, channels, strict=True)).implies(~accepted),
        statement="a solution with a satellite that violates the criterion does not change the state",
        trace=("SAT-1", "SAT-5"),
        unconditional=True,
    )
    total = as_num(0, COUNT)
    for flag in used:
        total = total + ite(flag, as_num(1, COUNT), 0)
    yield always(
        "no fix below the minimum",
        accepted.implies(total >= of.num(own.unknowns) + SPARE[own.config.redundancy]),
        statement="fewer satellites than the minimum give no fix",
        trace=("SAT-5",),
        unconditional=True,
    )


def _coasting(model: Satellite) -> Iterator[Property]:
    machine, own = model.machine, model.own
    of = model.composition.of(machine)
    coasting = of.bool(machine.flag("coasting"))
    margin, coasted = of.num(own.margin), of.num(own.coasted)
    yield always(
        "coasting only grows",
        (coasting & earlier_bool(of.bool(machine.flag("valid")))).implies(margin > earlier_num(margin)),
        statement="without a solution that counts the margin grows in every cycle",
        trace=("SAT-1",),
        unconditional=True,
    )
    yield always(
        "coasting ends",
        coasting.implies(coasted >= earlier_num(coasted)) & (coasted <= own.config.coast_limit_cycles),
        statement="coasting is counted, and never longer than its limit",
        trace=("SAT-1",),
        unconditional=True,
    )
    yield always(
        "coasted out",
        (earlier_num(coasted).eq(own.config.coast_limit_cycles) & coasting).implies(as_num(1, COUNT) <= 0),
        statement="after the limit the state is not carried on",
        trace=("SAT-1",),
        unconditional=True,
    )
