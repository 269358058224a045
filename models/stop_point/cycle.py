"""One cycle of the stop-point machine: the vehicle's place relative to the stop, and its speed."""

from __future__ import annotations

from dataclasses import dataclass

from safeloc.language.expr import Bool, Lit, Num, abs_, any_of, as_num, ceil_to, ite, maximum, minimum, product
from safeloc.language.units import COUNT, MM, MM_S2, MS
from safeloc.models.stop_point.variables import Parts
from safeloc.models.vocabulary.choose import choose


@dataclass(frozen=True, eq=False)
class Window:
    """Place of a stop point, and its window, mm."""

    stop: Num
    before: Num
    after: Num

    @property
    def begins(self) -> Num:
        """Near end of the window."""
        return self.stop - self.before

    @property
    def ends(self) -> Num:
        """Far end of the window, towards the platform's end."""
        return self.stop + self.after


@dataclass(frozen=True, eq=False)
class Judgement:
    """The terms of one cycle.

    low, high   ends of the interval of end A, mm
    pending     window of the pending stop
    chosen      window of the selected stop; only while `known`
    known       the selected stop is on the map
    """

    own: Parts
    low: Num
    high: Num
    pending: Window
    chosen: Window
    known: Bool

    @property
    def selectable(self) -> Bool:
        """The selected stop is on the map, lies ahead, and is not the one served last."""
        new = self.own.selected_stop.value.ne(self.own.served_number)
        return self.own.valid & self.named & self.known & new & (self.high <= self.chosen.ends)

    @property
    def named(self) -> Bool:
        """The mission selects a stop."""
        return self.own.selected_stop.present

    @property
    def changed(self) -> Bool:
        """The mission selects another stop than the pending one."""
        return self.selectable & self.own.selected_stop.value.ne(self.own.pending_number)

    @property
    def beyond(self) -> Bool:
        """The vehicle is possibly beyond the window."""
        return self.high > self.pending.ends

    @property
    def short(self) -> Bool:
        """The vehicle is possibly before the window."""
        return self.low < self.pending.begins

    @property
    def inside(self) -> Bool:
        """The vehicle is surely within the window."""
        return ~self.beyond & ~self.short

    @property
    def standing(self) -> Bool:
        """No movement is measured."""
        return abs_(self.own.speed) <= self.own.config.standstill_mm_s

    @property
    def to_go(self) -> Num:
        """Distance to the stop, mm: from the measured position, or, without a measurement, from the interval's far end."""
        return self.pending.stop - ite(self.own.precise, self.own.position, self.high)

    @property
    def to_brake_in(self) -> Num:
        """Distance left for braking, mm: to the stop, or from the interval's far end to the window's far end if that is shorter."""
        return minimum(self.to_go, self.pending.ends - self.high)

    @property
    def brake_now(self) -> Bool:
        """Reaction and braking from the greatest possible speed take at least the distance left."""
        config = self.own.config
        speed = maximum(self.own.speed + config.speed_error_mm_s, 0)
        reaction = ceil_to(speed * Lit(config.reaction_ms, MS), MM)
        twice = Lit(2 * config.brake_mm_s2, MM_S2)
        return product(speed, speed) >= (self.to_brake_in - reaction) * twice

    @property
    def forwards_too_fast(self) -> Bool:
        """The vehicle possibly runs forwards faster than the reduced speed."""
        return self.own.speed + self.own.config.speed_error_mm_s > self.own.config.reduced_speed_mm_s

    @property
    def backwards_too_fast(self) -> Bool:
        """The vehicle possibly runs backwards faster than the reduced speed."""
        return self.own.config.speed_error_mm_s - self.own.speed > self.own.config.reduced_speed_mm_s

    @property
    def too_far(self) -> Bool:
        """The vehicle is possibly farther beyond the window than it may reposition."""
        return self.high > self.pending.ends + self.own.config.reposition_limit_mm


def judge(own: Parts) -> Judgement:
    """Build the terms of one cycle."""
    first = own.stops[0]
    chosen = Window(first.position.value, first.before, first.after)
    known = [own.selected_stop.value.eq(as_num(1, COUNT)) & first.position.present]
    for number, stop in enumerate(own.stops[1:], 2):
        meant = own.selected_stop.value.eq(as_num(number, COUNT))
        known.append(meant & stop.position.present)
        chosen = choose(meant, Window(stop.position.value, stop.before, stop.after), chosen)
    return Judgement(
        own,
        own.position - own.below,
        own.position + own.above,
        Window(own.stop, own.before, own.after),
        chosen,
        any_of(known),
    )
