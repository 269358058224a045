"""One step of the guard as properties see it: computed from the state before the step and its inputs.

It is written independently of the machine's own terms, so that a wrong term does not confirm itself.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

from safeloc.language.expr import (
    Bool,
    Lit,
    Num,
    all_of,
    any_of,
    as_num,
    before,
    ceil_div,
    exact_to,
    floor_div,
    ite,
    maximum,
    minimum,
    with_unit,
)
from safeloc.language.units import COUNT, MS, NM, NM_PER_MM, UM, UM_S
from safeloc.models.guard import Guard
from safeloc.models.guard.variables import (
    ACROSS,
    AGAINST,
    AMBIGUOUS,
    DOUBTFUL,
    FAULT,
    JUDGED,
    JUMP,
    NO_FAULT,
    NOTHING,
    OFF_TRACK,
    OUT_OF_REACH,
    PASSED,
    SPEED_DISAGREES,
    TOO_COARSE,
)

HALF_TURN_MRAD = 3_142
QUARTER_TURN_MRAD = 1_571


@dataclass(frozen=True, eq=False)
class Step:
    """One step of a guard."""

    model: Guard

    # ------------------------------------------------------------------ figures

    @property
    def _top(self) -> int:
        """Top speed, um/s."""
        return self.model.own.config.max_speed_mm_s * 1_000

    @property
    def _change(self) -> int:
        """The greatest change of speed in a period, um/s: the stronger of traction and brake."""
        config = self.model.own.config
        return config.period_ms * max(config.brake_mm_s2, config.acceleration_mm_s2)

    @property
    def _way(self) -> int:
        """The greatest distance that a change of speed adds in a period, nm."""
        return self._change * self.model.own.config.period_ms // 2

    @property
    def _steps(self) -> int:
        """Number of periods over which the speed is computed from the distance."""
        config = self.model.own.config
        return config.speed_window_ms // config.period_ms

    def lag_nm(self, steps: int) -> int:
        """Return the greatest difference between the distance of so many periods and the speed at their end times their duration, nm.

        At the end of the period that ends i periods before the last, the speed may differ from the last one by i changes. In each
        period the distance may differ from the speed at its beginning times the period by half a change.
        """
        return sum(self._way + self._change * self.model.own.config.period_ms * (n + 1) for n in range(steps))

    # ------------------------------------------------------------------ the stored intervals without a fix

    @cached_property
    def low(self) -> Num:
        """The lowest place that the vehicle can have reached, nm."""
        own = self.model.own
        back = exact_to(before(own.slow) * Lit(own.config.period_ms, MS), NM) - self._way
        return ite(~own.advance, before(own.low), back + before(own.low))

    @cached_property
    def high(self) -> Num:
        """The highest place that the vehicle can have reached, nm."""
        own = self.model.own
        forth = exact_to(before(own.fast) * Lit(own.config.period_ms, MS), NM) + self._way
        return ite(~own.advance, before(own.high), forth + before(own.high))

    @cached_property
    def slowest(self) -> Num:
        """The lowest possible speed, um/s: lowered by the stronger rate if the vehicle may run forwards, else by traction."""
        own = self.model.own
        rise = own.config.acceleration_mm_s2 * own.config.period_ms
        least = before(own.slow) - ite(before(own.fast) > 0, as_num(self._change, UM_S), rise)
        return ite(~own.advance, before(own.slow), maximum(as_num(-self._top, UM_S), least))

    @cached_property
    def fastest(self) -> Num:
        """The highest possible speed, um/s: raised by the stronger rate if the vehicle may run backwards, else by traction."""
        own = self.model.own
        rise = own.config.acceleration_mm_s2 * own.config.period_ms
        most = before(own.fast) + ite(before(own.slow) < 0, as_num(self._change, UM_S), rise)
        return ite(~own.advance, before(own.fast), minimum(as_num(self._top, UM_S), most))

    @cached_property
    def near(self) -> tuple[Num, Num]:
        """Lowest and highest place by now if the last fix near the way was true, at the highest speed either way and on the line; nm."""
        own, config = self.model.own, self.model.own.config
        ran = config.period_ms * self._top + self._way
        line = (config.position_limit_mm + 2 * config.window_limit_mm) * NM_PER_MM
        least, most = before(own.near_low) - ran, before(own.near_high) + ran
        return (
            ite(~own.advance, before(own.near_low), ite(least < -line, as_num(-line, NM), least)),
            ite(~own.advance, before(own.near_high), ite(most > line, as_num(line, NM), most)),
        )

    @property
    def line_nm(self) -> int:
        """Extent of the line either way, with a window beyond its end, nm."""
        config = self.model.own.config
        return (config.position_limit_mm + 2 * config.window_limit_mm) * NM_PER_MM

    @cached_property
    def known(self) -> tuple[Num, Num]:
        """Lowest and highest place by now, from the last known place at the highest speed, backwards only where permitted; nm."""
        own, line = self.model.own, self.line_nm
        ran = own.config.period_ms * self._top + self._way
        back = ite(own.forwards_only, as_num(0, NM), as_num(ran, NM))
        return (
            ite(~own.advance, before(own.known_low), maximum(before(own.known_low) - back, as_num(-line, NM))),
            ite(~own.advance, before(own.known_high), minimum(as_num(line, NM), ran + before(own.known_high))),
        )

    @cached_property
    def due(self) -> Bool:
        """This step completes the window over which the speed is computed."""
        return self.model.own.advance & (before(self.model.own.anchor_steps) + 1).eq(self._steps)

    def slowest_by_distance(self, low: Num) -> Num:
        """Return the lowest speed by the distance since the anchor, rounded up, um/s."""
        short = with_unit(low - self.lag_nm(self._steps) - before(self.model.own.anchor_high), UM_S)
        return ceil_div(short, self._steps * self.model.own.config.period_ms)

    def fastest_by_distance(self, high: Num) -> Num:
        """Return the highest speed by the distance since the anchor, rounded down, um/s."""
        far = with_unit(high + self.lag_nm(self._steps) - before(self.model.own.anchor_low), UM_S)
        return floor_div(far, self._steps * self.model.own.config.period_ms)

    @cached_property
    def speeds(self) -> tuple[Num, Num]:
        """Lowest and highest speed without a fix, um/s."""
        slow, fast = self.slowest_by_distance(self.low), self.fastest_by_distance(self.high)
        return (
            ite(self.due & (slow > self.slowest), slow, self.slowest),
            ite(self.due & (fast < self.fastest), fast, self.fastest),
        )

    @cached_property
    def can_be_held(self) -> Bool:
        """The intervals without a fix can be stored: neither is empty, and the places are on the line and no wider than the limit."""
        config, (slow, fast) = self.model.own.config, self.speeds
        reach = (2 * config.window_limit_mm + config.position_limit_mm) * NM_PER_MM
        wide = self.high - self.low > 2 * NM_PER_MM * config.window_limit_mm
        return ~any_of([wide, self.low > self.high, self.high > reach, self.low < -reach, slow > fast])

    # ------------------------------------------------------------------ the fix

    @cached_property
    def place(self) -> Num:
        """Place of the fix, nm."""
        return exact_to(self.model.own.fix.value, NM)

    @cached_property
    def added_error(self) -> Num:
        """Error bound of the fix, nm: its own error, a share of its distance off the track, and its age times the highest speed."""
        own, config = self.model.own, self.model.own.config
        off = exact_to(with_unit(own.offset * config.offset_charge_permille, UM), NM)
        aged = exact_to(with_unit(own.age * config.max_speed_mm_s, UM), NM)
        return off + config.fix_error_mm * NM_PER_MM + aged

    @cached_property
    def _least_reported(self) -> Num:
        """The receiver's speed less its error, without direction, um/s."""
        return exact_to(self.model.own.speed.value - self.model.own.config.speed_error_mm_s, UM_S)

    @cached_property
    def alone(self) -> Num:
        """Verdict on the delivery by map and vehicle alone."""
        own, config, reported = self.model.own, self.model.own.config, self._named_fault
        reach = (2 * config.window_limit_mm + config.position_limit_mm) * NM_PER_MM
        beside = (self.place + self.added_error > reach) | (self.place - self.added_error < -reach)
        coarse = self.added_error >= (config.tolerance_mm - 2) * NM_PER_MM + 1
        rows = (
            (own.fault.ne(NO_FAULT), reported),
            (~own.fix.present, NOTHING),
            (own.offset >= config.offset_limit_mm + 1, OFF_TRACK),
            (own.ambiguous, AMBIGUOUS),
            (coarse, TOO_COARSE),
            (own.speed.present & (self._least_reported >= self._top + 1), SPEED_DISAGREES),
            (beside, TOO_COARSE),
        )
        return _first(rows, PASSED)

    @cached_property
    def crosses(self) -> Bool:
        """The course differs from both directions of the way by more than the limit."""
        course, limit = self.model.own.course, self.model.own.config.course_limit_mrad
        return course.present & (course.value > limit) & (course.value < HALF_TURN_MRAD - limit)

    @cached_property
    def runs_back(self) -> Bool:
        """The course differs from the way's direction by more than a quarter of a turn."""
        return self.model.own.course.present & (self.model.own.course.value >= QUARTER_TURN_MRAD + 1)

    @cached_property
    def out_of_reach(self) -> Bool:
        """No place within the fix's error is one that the vehicle can have reached from its last known place."""
        least, most = self.known
        rolled = self.model.own.config.rollback_mm * NM_PER_MM
        return (least - self.place > self.added_error + rolled) | (self.place - most > self.added_error)

    @cached_property
    def fair(self) -> Num:
        """Verdict on the delivery by map, vehicle, course and the last known place."""
        only = self.model.own.forwards_only
        rows = (
            (self.alone.ne(PASSED), self.alone),
            (only & self.runs_back, AGAINST),
            (self.crosses, ACROSS),
            (self.out_of_reach, OUT_OF_REACH),
        )
        return _first(rows, PASSED)

    @cached_property
    def fair_row(self) -> Num:
        """Number of fair fixes in a row with this one."""
        own, most = self.model.own, self.model.own.config.confirmations
        goes_on = self.follows & ~own.elsewhere
        longer = ite(before(own.fair_fixes) >= most - 1, as_num(most, COUNT), before(own.fair_fixes) + 1)
        ended = self.fair.one_of(OFF_TRACK, ACROSS, AGAINST, OUT_OF_REACH)
        held = ite(ended, as_num(0, COUNT), before(own.fair_fixes))
        return ite(self.fair.ne(PASSED), held, ite(goes_on, longer, as_num(1, COUNT)))

    @cached_property
    def _named_fault(self) -> Num:
        reasons = {reason.label: reason for reason in JUDGED}
        own = self.model.own
        return _first([(own.fault.eq(fault), reasons[fault.label]) for fault in FAULT[1:]], NOTHING)

    @cached_property
    def verdict(self) -> Num:
        """Verdict on the fix: a fault, the map, the vehicle's limits, or the places and speeds that it can have by now."""
        own = self.model.own
        beside = (self.place > self.high) | (self.place < self.low)
        rows = (
            (self.fair.ne(PASSED) & self.fair.ne(OUT_OF_REACH), self.fair),
            (own.elsewhere | self._apart, JUMP),
            (self.fair.eq(OUT_OF_REACH), OUT_OF_REACH),
            (self._too_fast | self._no_speed_left, SPEED_DISAGREES),
            (beside, DOUBTFUL),
        )
        return _first(rows, PASSED)

    @property
    def _against(self) -> list[Bool]:
        """Reasons why the vehicle cannot be at the fix by now."""
        return [self.model.own.elsewhere, self._apart, self._too_fast, self._no_speed_left]

    @cached_property
    def _apart(self) -> Bool:
        """No place within the fix's error is one where the vehicle can be by now."""
        return (self.place - self.high > self.added_error) | (self.low - self.place > self.added_error)

    @cached_property
    def _too_fast(self) -> Bool:
        """The receiver reports a speed that the vehicle cannot have, whichever way it runs."""
        least = self._least_reported
        return self.model.own.speed.present & ~((least <= self.fastest) | (least <= -self.slowest))

    @cached_property
    def _no_speed_left(self) -> Bool:
        """No possible speed of the vehicle agrees with place and speed of the fix."""
        slow, fast = self._with_fix
        return any_of(least > most for least in slow for most in fast)

    @cached_property
    def _with_fix(self) -> tuple[list[Num], list[Num]]:
        """All lower bounds of the speed with the fix, and all upper bounds, um/s."""
        own, error = self.model.own, self.model.own.config.speed_error_mm_s * 1_000
        top, reported = as_num(self._top, UM_S), self._least_reported + error
        most = ite(~own.speed.present, top, minimum(reported + error, top))
        least = ite(~own.speed.present, as_num(-error, UM_S), self._least_reported)
        low, high = maximum(self.place - self.added_error, self.low), minimum(self.place + self.added_error, self.high)
        forth, back = self.slowest >= 0, self.fastest <= 0
        slow = [self.slowest, -most, ite(~forth, -top, least), ite(~self.due, -top, self.slowest_by_distance(low))]
        fast = [self.fastest, most, ite(~back, top, -least), ite(~self.due, top, self.fastest_by_distance(high))]
        return slow, fast

    # ------------------------------------------------------------------ trust

    @cached_property
    def agrees(self) -> Bool:
        """The fix passes every check: map, vehicle limits, course, last known place, and the possible places and speeds by now."""
        beside = (self.place > self.high) | (self.place < self.low)
        return self.fair.eq(PASSED) & ~any_of([*self._against, beside])

    @cached_property
    def follows(self) -> Bool:
        """The last fix near the way and this one can both be true."""
        least, most = self.near
        return ~((self.place - most > self.added_error) | (least - self.place > self.added_error))

    @cached_property
    def implausible(self) -> Bool:
        """The fix contradicts the map, the vehicle's limits, or the vehicle's possible motion since the last step."""
        by_now = self.fair.eq(PASSED) & any_of(self._against)
        return self.fair.one_of(OFF_TRACK, SPEED_DISAGREES, ACROSS, AGAINST, OUT_OF_REACH) | by_now

    @cached_property
    def fills(self) -> Bool:
        """The fix agrees, follows from the one before, and fills the row of agreeing fixes."""
        return all_of(
            [self.agrees, self.follows, before(self.model.own.agreed_fixes) > self.model.own.config.confirmations - 2]
        )


def _first(rows: Sequence[tuple[Bool, Num]], otherwise: Num) -> Num:
    result = otherwise
    for when, value in reversed(rows):
        result = ite(when, value, result)
    return result
