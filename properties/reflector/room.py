"""The layout leaves room for measurements, and no reflector of the map is skipped (RFL-8, RFL-10, RFL-D3)."""

from __future__ import annotations

from collections.abc import Iterator

from safeloc.language.expr import Bool, Num, all_of, any_of, as_num, before, exact_to, ite
from safeloc.language.spec import Property, always, reachable
from safeloc.language.units import MM, NM
from safeloc.models.layout_rules import LayoutConfig, separable_by_distance
from safeloc.models.reflector import ReflectorMachine
from safeloc.models.reflector.echo import AMBIGUOUS
from safeloc.models.reflector.variables import Parts, ReflectorConfig
from safeloc.models.vocabulary.reflectors import NO_MODEL
from safeloc.properties.reflector.figures import (
    begun,
    foremost,
    found_by,
    further_error,
    in_test,
    looked_for,
    ran_late,
    rearmost,
    seen_from,
    was,
    width,
)


def room(model: ReflectorMachine) -> Iterator[Property]:
    """Yield the properties of a line that keeps the layout rules."""
    yield from _room(model)
    yield from _skipped(model)
    for label, text in (("VIEW", "a reflector can be measured"), ("PASSING", "a reflector can be passed")):
        yield reachable(
            f"{label.lower()} happens", model.in_mode(label), statement=text, requirements=("RFL-1", "RFL-3")
        )


def _room(model: ReflectorMachine) -> Iterator[Property]:
    own, layout = model.own, layout_of(model.own.config)
    clear = ite(begun(own), own.ahead.clear, before(own.target.clear))
    kept = model.machine.flag("valid") & ~model.machine.flag("precise")
    ambiguous = [slot.last_verdict.eq(AMBIGUOUS) for slot in own.slots]
    fine, exact = LayoutConfig().radar_error_mm, further_error(own).eq(0)
    yield always(
        "the layout leaves room",
        (kept & exact & ~in_test(model) & separable_by_distance(clear, layout)).implies(
            all_of((slot.error <= fine).implies(~one) for slot, one in zip(own.slots, ambiguous, strict=True))
        ),
        statement="if the spacing of equal models keeps the layout rule, the machine refuses no measurement within the radar's error "
        "as ambiguous, in a cycle in which a checking unit reports no error beyond the odometer's law",
        requirements=("RFL-8", "RFL-10"),
        unconditional=own.odometer.more is None,
    )
    yield always(
        "a self-test is ambiguous only if another reflector is in range",
        (kept & in_test(model) & any_of(ambiguous)).implies(_other_in_range(own, clear)),
        statement="in a self-test the machine refuses an echo as ambiguous only if the radar could receive another reflector of the "
        "model with the minimum intensity, from somewhere in the interval",
        requirements=("RFL-6", "RFL-10"),
        unconditional=True,
    )


def _other_in_range(own: Parts, clear: Num) -> Bool:
    """Return whether a reflector at the clearance before the reference reflector may be ahead, or one behind it in strong range."""
    forward, backward = ran_late(own, own.config.frame_latency_ms)
    stands = exact_to(looked_for(own) + own.config.radar_offset_mm, NM)
    away = exact_to(clear - own.config.map_accuracy_mm, NM)
    strong_range = exact_to(as_num(own.config.strong_range_mm, MM), NM)
    return (stands - away >= rearmost(own) - forward) | (stands + away <= foremost(own) + backward + strong_range)


def _skipped(model: ReflectorMachine) -> Iterator[Property]:
    own = model.own
    known = own.ahead.model.ne(NO_MODEL) & own.ahead.position.present
    yield always(
        "nothing is skipped",
        (was(model, "ODOMETRY") & model.in_mode("ODOMETRY") & known).implies(_ahead_or_found(own)),
        statement="in the odometry zone the map's next reflector is either ahead or was found before; the vehicle passes none unnoticed",
        requirements=("RFL-D3",),
        unconditional=True,
    )


def _ahead_or_found(own: Parts) -> Bool:
    """Return whether the next reflector is not in view yet, or another one is too near, or its search is over and it was found."""
    ahead = own.ahead
    by = found_by(own, ahead.position.value, ahead.view_from)
    ahead_of_view = foremost(own) < seen_from(own, ahead.position.value, ahead.view_from)
    crowded = exact_to(ahead.clear, NM) <= width(own)
    behind = rearmost(own) > by
    return (ahead_of_view | crowded | behind) & (behind.implies(ahead.position.value <= before(own.found)))


def layout_of(config: ReflectorConfig) -> LayoutConfig:
    """Return the layout figures for the machine: the error of a measured reflector includes the travel in the frame's latency,
    the radar's scale error, and the systematic error that a self-test may not exclude."""
    share = -(-config.frame_latency_ms * 1_000_000 // config.period_ms)
    lag_mm = -(-config.max_cycle_distance_mm * share // 1_000_000) + 1
    scale_mm = -(-config.range_limit_mm * config.radar_scale_ppm // 1_000_000)
    return LayoutConfig(
        tolerance_mm=config.tolerance_mm,
        odometry_constant_mm=config.odometer.constant_mm,
        odometry_rate_ppm=config.odometer.rate_ppm,
        radar_error_mm=LayoutConfig().radar_error_mm + lag_mm + scale_mm + config.reference_tolerance_mm,
        map_accuracy_mm=config.map_accuracy_mm,
    )
