"""Properties of position from satellites (SAT-1, SAT-4, SAT-5, SAT-6)."""

from __future__ import annotations

from collections.abc import Iterator
from functools import partial

from safeloc.language.expr import all_of, as_num, between, exact_to, ite
from safeloc.language.spec import Property, always, earlier_bool, earlier_num, reachable
from safeloc.language.units import NM, UM_S
from safeloc.models.satellite import Satellite
from safeloc.models.satellite.variables import (
    LOCATED,
)
from safeloc.properties.satellite.prediction import prediction, prediction_error, threshold_rule
from safeloc.properties.satellite.solutions import exact, narrowed, outcomes, solutions, used
from safeloc.properties.satellite.state import (
    FALSE_SIGNALS,
    LAW,
    kept_before,
    most_change,
    most_way,
    now_kept,
    run_at,
)

for_all_inputs = partial(always, requirements=("SAT-1", "SAT-5"), unconditional=True)


def properties(model: Satellite) -> list[Property]:
    """Return all properties of selection and position together, for solutions of usable satellites that can be trusted."""
    makers = (
        _safety, _restart, _references, solutions, used, exact, narrowed, outcomes, prediction, prediction_error, _coasting,
        threshold_rule, _anchor,
    )  # fmt: skip
    return [prop for maker in makers for prop in maker(model)]


def drift_properties(model: Satellite) -> list[Property]:
    """Return the properties that hold although every signal may be false: model with `trusted="odometry"`."""
    of, machine, own = model.composition.of(model.machine), model.machine, model.own
    position, bound = (exact_to(of.num(machine.output(name)), NM) for name in ("position_mm", "drift_bound_mm"))
    bounded = always(
        "common drift is bounded",
        of.bool(own.anchored).implies(between(position - bound, of.num(own.truth), position + bound)),
        statement="however false the signals are, the position is no farther from the true one than the reported "
        "bound: its distance from the last reference as odometry has carried it on, and the greatest "
        "error of odometry",
        requirements=("SAT-1", "SAT-5"),
        assumption=FALSE_SIGNALS,
    )
    return [bounded, *_anchor(model)]


# ------------------------------------------------------------------ safety


def _safety(model: Satellite) -> Iterator[Property]:
    machine, own = model.machine, model.own
    of = model.composition.of(machine)
    valid = of.bool(machine.flag("valid"))
    position, below, above = (
        exact_to(of.num(machine.output(f"{name}_mm")), NM) for name in ("position", "margin_below", "margin_above")
    )
    yield always(
        "containment",
        valid.implies(between(position - below, of.num(own.truth), position + above)),
        statement="the reported interval along the track contains the true position",
        requirements=("SAT-1", "SAT-5", "SAT-6"),
        assumption=LAW,
    )
    tolerance = own.config.tolerance_mm
    yield for_all_inputs(
        "tolerance",
        valid.implies(
            (of.num(machine.output("margin_above_mm")) <= tolerance)
            & (of.num(machine.output("margin_below_mm")) <= tolerance)
        ),
        statement="a reported interval is never wider than the tolerable error, on either side",
        requirements=("SAT-5",),
    )
    yield for_all_inputs(
        "no resurrection",
        (valid & ~earlier_bool(valid)).implies(of.bool(machine.fired("trusted reference"))),
        statement="a position is reported again only through a trusted reference: no solution starts it",
    )
    yield for_all_inputs(
        "reason stated",
        of.num(own.reason).eq(LOCATED).iff(valid),
        statement="the machine gives a reason exactly while it reports no position",
        requirements=("SAT-5",),
    )


# ------------------------------------------------------------------ references


def _restart(model: Satellite) -> Iterator[Property]:
    """A position begins, and begins anew, with a reference and with nothing of what was before."""
    machine, own, now = model.machine, model.own, now_kept(model)
    of = model.composition.of(machine)
    valid, referenced = of.bool(machine.flag("valid")), of.bool(own.reference.present)
    good = of.num(own.accuracy) <= own.config.tolerance_mm - 2
    knows = of.bool(own.reference_speed.present)
    yield for_all_inputs(
        "a good reference begins a position",
        (referenced & good & ~earlier_bool(valid)).implies(valid),
        statement="without a position, a reference that is accurate enough to be reported begins one",
        requirements=("SAT-1",),
    )
    place = exact_to(of.num(own.reference.value), NM)
    speed = ite(knows, of.num(own.reference_speed.value), as_num(0, UM_S))
    fresh = [now.position.eq(place), now.speed.eq(speed), now.change.eq(0), of.num(own.coasted).eq(0)]
    anchored = [of.bool(own.anchored), of.num(own.anchor_offset).eq(0)]
    yield for_all_inputs(
        "a position begins with no earlier data",
        (valid & ~earlier_bool(valid)).implies(referenced & all_of([*fresh, *anchored])),
        statement="a position begins at the reference, with its speed or none, no change of speed, no cycle coasted, and odometry counts from there",
        requirements=("SAT-1", "SAT-D1"),
    )


def _references(model: Satellite) -> Iterator[Property]:
    """A reference while a position is reported."""
    machine, own, now, was = model.machine, model.own, now_kept(model), kept_before(model)
    of = model.composition.of(machine)
    valid, referenced = of.bool(machine.flag("valid")), of.bool(own.reference.present)
    place, accuracy = (exact_to(of.num(one), NM) for one in (own.reference.value, own.accuracy))
    behind = was.low - place > accuracy + most_way(model) - run_at(model, was.slowest)
    ahead = place - was.high > accuracy + most_way(model) + run_at(model, was.fastest)
    yield for_all_inputs(
        "a reference that contradicts ends the position",
        (earlier_bool(valid) & referenced & (behind | ahead)).implies(~valid),
        statement="a reference that lies where the vehicle cannot have come to ends the position in the same cycle",
    )
    taken = of.bool(machine.fired("trusted reference", "reference while located"))
    yield for_all_inputs(
        "a reference bounds the position",
        taken.implies((now.high - place <= accuracy) & (place - now.low <= accuracy) & of.num(own.coasted).eq(0)),
        statement="with a reference the interval lies within its accuracy, and coasting is counted anew",
    )


# ------------------------------------------------------------------ coasting


def _coasting(model: Satellite) -> Iterator[Property]:
    machine, own = model.machine, model.own
    of = model.composition.of(machine)
    coasting, valid = of.bool(machine.flag("coasting")), of.bool(machine.flag("valid"))
    now, was, coasted = now_kept(model), kept_before(model), of.num(own.coasted)
    fast, gained = own.config.max_speed_mm_s * 1_000, most_change(model)
    wider = [
        now.position - now.low >= was.position - was.low,
        now.high - now.position >= was.high - was.position,
        now.high - now.low > was.high - was.low,
    ]
    faster = [
        now.fastest.eq(ite(was.fastest > fast - gained, as_num(fast, UM_S), was.fastest + gained)),
        now.slowest.eq(ite(was.slowest < gained - fast, as_num(-fast, UM_S), was.slowest - gained)),
    ]
    yield for_all_inputs(
        "coasting only grows",
        (coasting & earlier_bool(valid)).implies(all_of([*wider, *faster])),
        statement="without a solution that counts the interval grows in every cycle and shrinks on neither side; that of the "
        "speed grows by the greatest acceleration, until it holds every speed there is",
        requirements=("SAT-1",),
    )
    yield for_all_inputs(
        "coasting ends",
        coasting.implies(coasted.eq(earlier_num(coasted) + 1)) & (coasted <= own.config.coast_limit_cycles),
        statement="cycles of coasting are counted one by one, and never more than the limit",
        requirements=("SAT-1",),
    )


# ------------------------------------------------------------------ drift


def _anchor(model: Satellite) -> Iterator[Property]:
    machine, own = model.machine, model.own
    of = model.composition.of(machine)
    now, margin, offset = now_kept(model), of.num(own.anchor_margin), of.num(own.anchor_offset)
    yield for_all_inputs(
        "position and odometry meet",
        of.bool(own.anchored).implies(
            (offset - (now.position - now.low) <= margin) & (offset + (now.high - now.position) >= -margin)
        ),
        statement="a reported position is no farther from the last reference, as odometry has carried it on, than the greatest errors of both",
    )
    yield from _carried(model)
    if own.config.drift_check == "required":
        yield for_all_inputs(
            "nothing without odometry",
            of.bool(machine.flag("valid")).implies(of.bool(own.anchored)),
            statement="nothing is reported that is not held against odometry since a reference",
        )
    yield reachable(
        "a drift is found",
        of.bool(machine.fired("common drift")),
        statement="a position that has drifted away from odometry ends",
        requirements=("SAT-1", "SAT-5"),
    )


def _carried(model: Satellite) -> Iterator[Property]:
    """Claim how the place that odometry gives goes on from cycle to cycle."""
    machine, own, now, was = model.machine, model.own, now_kept(model), kept_before(model)
    of, config = model.composition.of(model.machine), model.own.config
    margin, offset, known = of.num(own.anchor_margin), of.num(own.anchor_offset), of.bool(own.odometry.present)
    moved = (now.position - offset) - (was.position - earlier_num(offset))
    looser = margin - earlier_num(margin)
    by_odometry = moved.eq(exact_to(of.num(own.odometry.value), NM)) & looser.eq(
        exact_to(of.num(own.odometry_error), NM)
    )
    at_most = as_num(config.max_speed_mm_s * config.period_ms * 1_000 + most_way(model), NM)
    goes_on = of.bool(own.anchored & machine.fired("solution counts", "coast"))
    yield for_all_inputs(
        "odometry counts from the last reference",
        (goes_on & known).implies(by_odometry) & (goes_on & ~known).implies(moved.eq(0) & looser.eq(at_most)),
        statement="the place with which a position is compared is the last reference, moved by odometry in each cycle, and its error "
        "bound grows by that of odometry; in a cycle without odometry it stays, and its error bound grows by the run at the top speed and the greatest acceleration",
    )
