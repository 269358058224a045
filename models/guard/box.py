"""Intervals of the vehicle's place along the way and of its speed: possible motion widens them, a fix narrows them."""

from __future__ import annotations

from dataclasses import dataclass

from safeloc.language.expr import (
    Bool,
    Lit,
    Num,
    all_of,
    as_num,
    ceil_div,
    exact_to,
    floor_div,
    ite,
    maximum,
    minimum,
    with_unit,
)
from safeloc.language.units import COUNT, MS, NM, NM_PER_MM, UM_PER_MM, UM_S
from safeloc.models.guard.variables import GuardConfig, Parts, reach_nm


@dataclass(frozen=True, eq=False)
class Box:
    """Interval of places `low` to `high` (nm) and of speeds `slow` to `fast` (um/s, negative against the way's direction)."""

    low: Num
    high: Num
    slow: Num
    fast: Num

    @property
    def possible(self) -> Bool:
        """Neither interval is empty."""
        return (self.low <= self.high) & (self.slow <= self.fast)

    @property
    def width(self) -> Num:
        """Width of the interval of places, nm."""
        return self.high - self.low

    def holds(self, place: Num, speed: Num) -> Bool:
        """Return whether the place (nm) and the speed (um/s) lie in their intervals."""
        return (self.low <= place) & (place <= self.high) & (self.slow <= speed) & (speed <= self.fast)


@dataclass(frozen=True, eq=False)
class Anchor:
    """Interval of the vehicle's places `steps` steps ago, nm."""

    low: Num
    high: Num
    steps: Num


@dataclass(frozen=True, eq=False)
class Held:
    """A box, and the anchor from which its speed is computed."""

    box: Box
    anchor: Anchor


def held(own: Parts) -> Held:
    """Return the box and the anchor before the step."""
    return Held(Box(own.low, own.high, own.slow, own.fast), Anchor(own.anchor_low, own.anchor_high, own.anchor_steps))


def moved(own: Parts, box: Box) -> Box:
    """Return the box after a step without a delivery: every place and speed that the vehicle can have by then."""
    config = own.config
    period, way = Lit(config.period_ms, MS), as_num(config.way_nm, NM)
    gain, change, most = config.speed_rise_um_s, config.speed_change_um_s, config.max_speed_mm_s * 1_000
    faster = box.fast + ite(box.slow >= 0, as_num(gain, UM_S), change)
    slower = box.slow - ite(box.fast <= 0, as_num(gain, UM_S), change)
    return Box(
        ite(own.advance, box.low + exact_to(box.slow * period, NM) - way, box.low),
        ite(own.advance, box.high + exact_to(box.fast * period, NM) + way, box.high),
        ite(own.advance, maximum(slower, -most), box.slow),
        ite(own.advance, minimum(faster, most), box.fast),
    )


def half_nm(own: Parts) -> Num:
    """Return the error bound of a fix on either side, nm: its own error, a share of its distance off the track, and its age times the highest speed."""
    config = own.config
    aged = exact_to(Lit(config.max_speed_mm_s * 1_000, UM_S) * own.age, NM)
    off = with_unit(own.offset * (config.offset_charge_permille * NM_PER_MM // 1_000), NM)
    return as_num(config.fix_error_mm * NM_PER_MM, NM) + off + aged


def of_fix(own: Parts) -> Box:
    """Return the box of a fix alone; the receiver's speed has no direction, so the box allows both."""
    place, half, fast = exact_to(own.fix.value, NM), half_nm(own), as_num(own.config.max_speed_mm_s * 1_000, UM_S)
    most = ite(own.speed.present, minimum(_speed(own) + own.config.speed_error_mm_s * 1_000, fast), fast)
    return Box(place - half, place + half, -most, most)


def near_now(own: Parts) -> tuple[Num, Num]:
    """Return the vehicle's possible places by now if the last fix near the way is true, at any speed either way: from, to; nm."""
    config = own.config
    ran, reach = as_num(config.max_speed_mm_s * config.period_ms * UM_PER_MM + config.way_nm, NM), reach_nm(config)
    return (
        ite(own.advance, maximum(own.near_low - ran, -reach), own.near_low),
        ite(own.advance, minimum(own.near_high + ran, reach), own.near_high),
    )


def known_now(own: Parts) -> tuple[Num, Num]:
    """Return the vehicle's possible places by now, from its last known place at any speed in a permitted direction: from, to; nm."""
    config = own.config
    ran, reach = as_num(config.max_speed_mm_s * config.period_ms * UM_PER_MM + config.way_nm, NM), reach_nm(config)
    back = own.advance & ~own.forwards_only
    return (
        ite(back, maximum(own.known_low - ran, -reach), own.known_low),
        ite(own.advance, minimum(own.known_high + ran, reach), own.known_high),
    )


def narrowed(own: Parts, box: Box) -> Box:
    """Return the intersection of the box and the fix's box; if the box allows one direction only, the receiver's speed gets that one."""
    fix, error = of_fix(own), own.config.speed_error_mm_s * 1_000
    least = ite(own.speed.present, _speed(own) - error, as_num(-error, UM_S))
    slow, fast = maximum(box.slow, fix.slow), minimum(box.fast, fix.fast)
    return Box(
        maximum(box.low, fix.low),
        minimum(box.high, fix.high),
        ite(box.slow >= 0, maximum(slow, least), slow),
        ite(box.fast <= 0, minimum(fast, -least), fast),
    )


def _speed(own: Parts) -> Num:
    return exact_to(own.speed.value, UM_S)


def speed_by_distance(own: Parts, box: Box, anchor: Anchor) -> Held:
    """Return the box and its anchor; once in a window, narrow the speed by the distance since the anchor and set a new anchor."""
    config = own.config
    steps = anchor.steps + ite(own.advance, as_num(1, COUNT), 0)
    due, duration = _due_now(own), config.window_steps * config.period_ms
    lag = as_num(config.lag_nm(config.window_steps), NM)
    most = with_unit(floor_div(box.high - anchor.low + lag, duration), UM_S)
    least = with_unit(ceil_div(box.low - anchor.high - lag, duration), UM_S)
    slow, fast = maximum(box.slow, least), minimum(box.fast, most)
    return Held(
        Box(box.low, box.high, ite(due, slow, box.slow), ite(due, fast, box.fast)),
        Anchor(ite(due, box.low, anchor.low), ite(due, box.high, anchor.high), ite(due, as_num(0, COUNT), steps)),
    )


def _due_now(own: Parts) -> Bool:
    """Return whether this step completes the window since the anchor."""
    return own.advance & own.anchor_steps.eq(own.config.window_steps - 1)


def usable(config: GuardConfig, box: Box) -> Bool:
    """Return whether a box can be stored: not empty, no wider than the window's limit, and on the line."""
    reach = reach_nm(config)
    return all_of(
        [
            box.possible,
            box.width <= 2 * config.window_limit_mm * NM_PER_MM,
            box.low >= -reach,
            box.high <= reach,
        ]
    )


def tolerable(config: GuardConfig, box: Box) -> Bool:
    """Return whether both margins stay within the tolerance, also when rounded outward to whole mm."""
    return box.width <= (2 * config.tolerance_mm - 3) * NM_PER_MM


def begun(box: Box) -> Held:
    """Return the box with itself as the new anchor."""
    return Held(box, Anchor(box.low, box.high, as_num(0, COUNT)))
