"""One train of a line area: its interval, from its reports and from its possible run since.

The interval [low, high] contains the whole train, from its min safe rear end to its max safe front end. A trusted report
narrows it; a cycle without one widens it by the run at top speed. Without confirmed integrity a report narrows the leading
end only: the fibre does not see a part that was left behind. The configuration may also distrust reports of integrity.
"""

from __future__ import annotations

from dataclasses import dataclass

from safeloc.language.declared import Declared
from safeloc.language.expr import (
    FALSE,
    Bool,
    BoolVar,
    Num,
    NumVar,
    Optional,
    as_num,
    boolean,
    choice,
    enumeration,
    floor_div,
    ite,
    maximum,
    members,
    minimum,
    number,
    optional,
    with_unit,
)
from safeloc.language.machine import ANY
from safeloc.language.units import COUNT, MM, MS, UM
from safeloc.models.area.inner import Inner, lowered, raised

_EVENT = members("event", "NONE", "ENTERS_LOW", "ENTERS_HIGH", "LEAVES_LOW", "LEAVES_HIGH")
NO_EVENT, ENTERS_LOW, ENTERS_HIGH, LEAVES_LOW, LEAVES_HIGH = _EVENT
VERDICT = members("report", "NONE", "ACCEPTED", "UNTRUSTED", "INCOMPLETE", "STALE", "CONTRADICTED", "NOBODY")
NO_REPORT, ACCEPTED, UNTRUSTED, INCOMPLETE, STALE, CONTRADICTED, NOBODY = VERDICT


@dataclass(frozen=True, eq=False)
class Reach:
    """Limits of all motion: run of a cycle (mm), top speed (mm/s), age of reports (ms), and the ends of the world (mm).

    entry_mm  how far in a train can be when it comes in
    """

    cycle_mm: int
    max_speed_mm_s: int
    report_age_limit_ms: int
    limit_mm: int
    entry_mm: int

    def added_error_mm(self, age_ms: Num) -> Num:
        """Return the greatest run since a report, mm rounded up."""
        return with_unit(floor_div(with_unit(age_ms, MM) * self.max_speed_mm_s + 999, 1_000), MM)


@dataclass(frozen=True, eq=False)
class Slot:
    """A train that an axle counter has counted into the area. Names are `train_k_...`; positions in mm along the line.

    event               the axle counters: it enters or has left completely, at the low or at the high end
    rear, front         the report: bounds of the whole train when it was measured, `age` ms ago
    trusted, integer    the report was verified; the train is known to be whole
    downwards           since it was last known to be whole it ran towards the low end: that end leads, not the high one
    below_loose, above_loose        every vehicle that was never counted in is above (below) this train, since it came in at the
                        low (high) end and no vehicle passes another
    there, true_rear, true_front  ghosts: the train itself, um
    from_low, from_high  ghosts: it came in at that end, and since then the counters were undisturbed
    next_all_out        ghost: neither its axles nor those of a part that it lost are in the area; if an earlier machine counts them
    """

    number: int
    reach: Reach
    integrity_is_trusted: bool
    event: NumVar
    rear: Optional
    front: Optional
    age: NumVar
    trusted: BoolVar
    integer: BoolVar
    downwards: BoolVar
    present: BoolVar
    low: NumVar
    high: NumVar
    silent: NumVar
    unconfirmed: NumVar
    below_loose: BoolVar
    above_loose: BoolVar
    last_verdict: NumVar
    there: BoolVar
    true_rear: NumVar
    true_front: NumVar
    next_rear: NumVar
    next_front: NumVar
    from_low: BoolVar
    from_high: BoolVar
    next_all_out: BoolVar
    part_rear: NumVar
    part_front: NumVar
    next_part_rear: NumVar
    next_part_front: NumVar
    inner: tuple[Inner, ...]

    @property
    def enters(self) -> Bool:
        """The train is counted in."""
        return self.event.one_of(ENTERS_LOW, ENTERS_HIGH)

    @property
    def leaves(self) -> Bool:
        """The train is counted out."""
        return self.event.one_of(LEAVES_LOW, LEAVES_HIGH)

    @property
    def holds_low(self) -> Bool:
        """A trusted report bounds the train's low end."""
        return self.integer | self.downwards if self.integrity_is_trusted else self.downwards

    @property
    def holds_high(self) -> Bool:
        """A trusted report bounds the train's high end."""
        return self.integer | ~self.downwards if self.integrity_is_trusted else ~self.downwards

    @property
    def confirmed(self) -> Bool:
        """An accepted report confirms that the train is whole."""
        return self.accepted & self.integer if self.integrity_is_trusted else FALSE

    @property
    def added_error(self) -> Num:
        """Greatest run since the measurement, mm."""
        return self.reach.added_error_mm(self.age)

    @property
    def lowest(self) -> Num:
        """Lower bound from the report, now, mm."""
        return self.rear.value - self.added_error

    @property
    def highest(self) -> Num:
        """Upper bound from the report, now, mm."""
        return self.front.value + self.added_error

    @property
    def run_on(self) -> tuple[Num, Num]:
        """Bounds after a cycle without a report, within the ends of the world, mm."""
        cycle, limit = self.reach.cycle_mm, self.reach.limit_mm
        return maximum(self.low - cycle, -limit), minimum(self.high + cycle, limit)

    @property
    def verdict(self) -> Num:
        """Verdict on the report: accepted, or the reason against it."""
        low, high = self.run_on
        both_ends = self.rear.present & self.front.present & (self.rear.value <= self.front.value)
        meets = (self.lowest <= high) & (low <= self.highest)
        reported = self.rear.present | self.front.present
        verdict = ite(meets, ACCEPTED, CONTRADICTED)
        verdict = ite(self.age > self.reach.report_age_limit_ms, STALE, verdict)
        verdict = ite(self.trusted, ite(both_ends, verdict, INCOMPLETE), UNTRUSTED)
        return ite(reported, ite(self.present, verdict, NOBODY), NO_REPORT)

    @property
    def accepted(self) -> Bool:
        """The report narrows the interval."""
        return self.verdict.eq(ACCEPTED)

    def bounds(self, area_low: Num, area_high: Num) -> tuple[Num, Num]:
        """Return the interval after the cycle. A train that enters is just inside one end; its other end is unknown, outside."""
        low, high = self.run_on
        limit, entry = self.reach.limit_mm, self.reach.entry_mm
        seen_low = ite(self.accepted & self.holds_low, maximum(low, self.lowest), low)
        seen_high = ite(self.accepted & self.holds_high, minimum(high, self.highest), high)
        new_low = ite(self.event.eq(ENTERS_LOW), as_num(-limit, MM), area_high - entry)
        new_high = ite(self.event.eq(ENTERS_LOW), area_low + entry, as_num(limit, MM))
        low_end, high_end = ite(self.enters, new_low, seen_low), ite(self.enters, new_high, seen_high)
        return raised(low_end, self.inner), lowered(high_end, self.inner)


def slot(
    declared: Declared,
    number_: int,
    reach: Reach,
    count_limit: int,
    *,
    integrity_is_trusted: bool,
    inner: tuple[Inner, ...] = (),
) -> Slot:
    """Return a slot with fresh variables; the vehicle of the train that stands for all is declared only if there is inner detection."""
    name, limit = f"train_{number_}", reach.limit_mm
    far, step = limit * 1_000, reach.cycle_mm * 1_000

    def part(which: str) -> NumVar:
        return number(f"{name}_{which}_um", UM, -far, far)

    def ghost(which: str) -> NumVar:
        return declared.ghost(part(which), first=ANY) if inner else part(which)

    def choice_(which: str) -> NumVar:
        return declared.choice(part(which)) if inner else part(which)

    return Slot(
        number_,
        reach,
        integrity_is_trusted,
        declared.sensor(choice(f"{name}_event", enumeration(_EVENT))),
        declared.sensor(optional(f"{name}_rear_mm", MM, -limit, limit)),
        declared.sensor(optional(f"{name}_front_mm", MM, -limit, limit)),
        declared.sensor(number(f"{name}_report_age_ms", MS, 0, 2 * reach.report_age_limit_ms)),
        declared.sensor(boolean(f"{name}_trusted")),
        declared.sensor(boolean(f"{name}_integer")),
        declared.sensor(boolean(f"{name}_downwards")),
        declared.state(boolean(f"{name}_present"), first=False),
        declared.state(number(f"{name}_low_mm", MM, -limit, limit), first=0),
        declared.state(number(f"{name}_high_mm", MM, -limit, limit), first=0),
        declared.state(number(f"{name}_silent_cycles", COUNT, 0, count_limit), first=0),
        declared.state(number(f"{name}_unconfirmed_cycles", COUNT, 0, count_limit), first=0),
        declared.state(boolean(f"{name}_below_loose"), first=False),
        declared.state(boolean(f"{name}_above_loose"), first=False),
        declared.state(choice(f"{name}_last_verdict", enumeration(VERDICT)), first=NO_REPORT),
        declared.ghost(boolean(f"{name}_there"), first=False),
        declared.ghost(number(f"{name}_true_rear_um", UM, -far, far), first=ANY),
        declared.ghost(number(f"{name}_true_front_um", UM, -far, far), first=ANY),
        declared.choice(number(f"{name}_next_rear_um", UM, -far - step, far + step)),
        declared.choice(number(f"{name}_next_front_um", UM, -far - step, far + step)),
        declared.ghost(boolean(f"{name}_from_low"), first=False),
        declared.ghost(boolean(f"{name}_from_high"), first=False),
        boolean(f"{name}_next_all_out"),
        ghost("part_rear"),
        ghost("part_front"),
        choice_("next_part_rear"),
        choice_("next_part_front"),
        inner,
    )
