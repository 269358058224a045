"""The satellites' position before and after a step, in the words of the requirements, and the vehicle's movement between."""

from __future__ import annotations

from dataclasses import dataclass, fields

from safeloc.language.expr import Bool, Lit, Num, all_of, exact_to
from safeloc.language.spec import earlier_num
from safeloc.language.units import MM, MM_S, MS, NM, UM_S
from safeloc.models.satellite import Satellite
from safeloc.models.satellite_selection.variables import Channel

LAW = (
    "greatest acceleration; a solution of satellites that keep their bounds is off by no more than dilution times bound and the "
    "rest given with it; signals compared with a prediction and a clock as good as configured; a reference within its accuracy"
)
MOVES = "greatest acceleration"
FALSE_SIGNALS = (
    "greatest acceleration and speed; a reference within its accuracy; odometry within its error; nothing of signals"
)


@dataclass(frozen=True)
class Kept:
    """The machine's declared state at one time, in nm and um/s."""

    position: Num
    low: Num
    high: Num
    speed: Num
    slowest: Num
    fastest: Num
    change: Num


def now_kept(model: Satellite) -> Kept:
    own, of = model.own, model.composition.of(model.machine)
    kept = (own.position, own.low, own.high, own.speed, own.slowest, own.fastest, own.change)
    return Kept(*(of.num(one) for one in kept))


def kept_before(model: Satellite) -> Kept:
    now = now_kept(model)
    return Kept(*(earlier_num(getattr(now, field.name)) for field in fields(now)))


def run_at(model: Satellite, speed: Num) -> Num:
    """Return the distance of a cycle at a speed."""
    return exact_to(speed * Lit(model.own.config.period_ms, MS), NM)


def most_way(model: Satellite) -> int:
    """Return the most that an acceleration adds to the distance of a cycle: A T2 / 2, in nm."""
    config = model.own.config
    return config.max_acceleration_mm_s2 * config.period_ms**2 // 2


def most_change(model: Satellite) -> int:
    """Return the most by which the speed changes in a cycle: A T, in um/s."""
    return model.own.config.period_ms * model.own.config.max_acceleration_mm_s2


def most_off(model: Satellite) -> Num:
    """Return the error bound of a solution's place, in nm: dilution times the greatest error of a usable range, and the
    further error.
    """
    own, of, chosen = model.own, model.composition.of(model.machine), model.own.config.selection
    wrong = Lit(chosen.range_clock_mm + chosen.range_prediction_mm + chosen.range_threshold_mm, MM)
    return exact_to(wrong * of.num(own.dilution), NM) + exact_to(of.num(own.further), NM)


def most_speed_off(model: Satellite) -> Num:
    """Return the error bound of its speed, in um/s."""
    own, of, chosen = model.own, model.composition.of(model.machine), model.own.config.selection
    wrong = Lit(chosen.speed_clock_mm_s + chosen.speed_prediction_mm_s + chosen.speed_threshold_mm_s, MM_S)
    return exact_to(wrong * of.num(own.speed_dilution), UM_S) + of.num(own.speed_further)


def channels(model: Satellite) -> list[tuple[Channel, Num]]:
    """Return the channels, each with its standing after the step."""
    of = model.composition.of(model.selection.machine)
    return [(one, of.num(one.standing)) for one in model.selection.own.channels]


def meets(model: Satellite) -> Bool:
    """Return whether a place and a speed that the vehicle can have reached agree with the solution."""
    own, of, was = model.own, model.composition.of(model.machine), kept_before(model)
    place, level = exact_to(of.num(own.fix.value), NM), most_off(model)
    speed, speed_level = of.num(own.fix_speed), most_speed_off(model)
    fast, gained, way = own.config.max_speed_mm_s * 1_000, most_change(model), most_way(model)
    before_it = place - was.high <= level + run_at(model, was.fastest) + way
    behind_it = was.low - place <= level + way - run_at(model, was.slowest)
    not_faster = (speed - was.fastest <= speed_level + gained) & (speed - speed_level <= fast)
    not_slower = (was.slowest - speed <= speed_level + gained) & (speed + speed_level >= -fast)
    return all_of([before_it, behind_it, not_faster, not_slower])
