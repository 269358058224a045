"""What one cycle means to the stop-point machine: where the vehicle is to the stop, and how fast."""

from __future__ import annotations

from dataclasses import dataclass

from safeloc.language.expr import Bool, Lit, Num, abs_, any_of, as_num, ceil_to, ite, maximum, minimum, product
from safeloc.language.units import COUNT, MM, MM_S2, MS
from safeloc.models.stop_point.variables import Parts


@dataclass(frozen=True, eq=False)
class Window:
    """A stop point's place and window, mm."""

    stop: Num
    before: Num
    after: Num

    @property
    def begins(self) -> Num:
        """Near end."""
        return self.stop - self.before

    @property
    def ends(self) -> Num:
        """Far end, towards the platform's end."""
        return self.stop + self.after


@dataclass(frozen=True, eq=False)
class Judged:
    """One cycle, judged.

    low, high   the interval of end A, mm
    pending     the window of the pending stop
    chosen      the window of the selected stop; only while `selectable`
    """

    own: Parts
    low: Num
    high: Num
    pending: Window
    chosen: Window
    known: Bool

    @property
    def selectable(self) -> Bool:
        """A stop is selected that is on the map, lies ahead, and was not served just before."""
        new = self.own.selected.value.ne(self.own.served)
        return self.own.valid & self.named & self.known & new & (self.high <= self.chosen.ends)

    @property
    def named(self) -> Bool:
        """A stop is selected."""
        return self.own.selected.present

    @property
    def changed(self) -> Bool:
        """Another stop than the pending one is selected."""
        return self.selectable & self.own.selected.value.ne(self.own.pending)

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
        """Distance to the stop: from the measured position, or, without a measurement, from the interval's far end."""
        return self.pending.stop - ite(self.own.precise, self.own.position, self.high)

    @property
    def to_brake_in(self) -> Num:
        """What is left for braking: to the stop, and from the interval's far end to the window's far end, the shorter."""
        return minimum(self.to_go, self.pending.ends - self.high)

    @property
    def brake_now(self) -> Bool:
        """The braking distance from the greatest possible speed, reaction included, is not shorter than what is left."""
        config = self.own.config
        speed = maximum(self.own.speed + config.speed_error_mm_s, 0)
        reaction = ceil_to(speed * Lit(config.reaction_ms, MS), MM)
        twice = Lit(2 * config.brake_mm_s2, MM_S2)
        return product(speed, speed) >= (self.to_brake_in - reaction) * twice

    @property
    def forwards_too_fast(self) -> Bool:
        """Possibly faster forwards than the reduced speed."""
        return self.own.speed + self.own.config.speed_error_mm_s > self.own.config.reduced_speed_mm_s

    @property
    def backwards_too_fast(self) -> Bool:
        """Possibly faster backwards than the reduced speed."""
        return self.own.config.speed_error_mm_s - self.own.speed > self.own.config.reduced_speed_mm_s

    @property
    def too_far(self) -> Bool:
        """Farther beyond the window than may be repositioned."""
        return self.high > self.pending.ends + self.own.config.reposition_limit_mm


def judge(own: Parts) -> Judged:
    """Judge one cycle."""
    first = own.stops[0]
    chosen = Window(first.position.value, first.before, first.after)
    known = [own.selected.value.eq(as_num(1, COUNT)) & first.position.present]
    for number, stop in enumerate(own.stops[1:], 2):
        meant = own.selected.value.eq(as_num(number, COUNT))
        known.append(meant & stop.position.present)
        chosen = Window(
            ite(meant, stop.position.value, chosen.stop),
            ite(meant, stop.before, chosen.before),
            ite(meant, stop.after, chosen.after),
        )
    return Judged(
        own,
        own.position - own.below,
        own.position + own.above,
        Window(own.stop, own.before, own.after),
        chosen,
        any_of(known),
    )
