"""The report of a train to the line area: bounds of both ends, and the ends that are believed (FVA-9).

The fibre follows a pattern. A part that a train lost stands silent and is not seen, and the detector's count is that of some
moment within the last run of the train: right after the loss of a wagon the count still contains all its axles.

    NEITHER   no end of the pattern is known to be the train's
    WHOLE     the count of this cycle is the counter's: the train was whole within the count's run
    HIGH_END  it has run towards the high end ever since: a lost part is below, the high end is the train's
    LOW_END   it has run towards the low end ever since: a lost part is above, the low end is the train's

In WHOLE an end is reported as far out as that of a train that was whole a count's run ago: from the other end of the
pattern, the reference's length, that run, and the roll-back of a lost part. Only an end that has led for longer than that run
is reported at its measured place. Count is identity; an equal length does not show that the train is whole: its tolerance is
wider than a wagon. A train that stands, or turns, can lose a part on either side, and its run in one direction begins anew.
Nothing is reported of a train that is not trusted.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property

from safeloc.language.expr import (
    FALSE,
    TRUE,
    Bool,
    Lit,
    Num,
    exact_to,
    floor_to,
    ite,
    maximum,
    minimum,
    with_unit,
)
from safeloc.language.machine import Model, Transition, current_mode, modes
from safeloc.language.rows import Updates
from safeloc.language.units import MM, NM, NM_PER_MM, PPM_PER_ONE, UM, UM_PER_MM
from safeloc.models.fibre_area.parting import PartingConfig, Parts, parts
from safeloc.models.fibre_area.report_world import world

__all__ = ["Believed", "PartingConfig", "Parts", "Report", "build", "parts"]
REQUIREMENTS = ("FVA-9", "FVA-18", "FVA-2", "FVA-11")


@dataclass(frozen=True, eq=False)
class Believed:
    """Terms of one cycle: the ends of the pattern, and those of the train."""

    own: Parts

    @cached_property
    def up(self) -> Bool:
        """The train runs towards the high end."""
        return self.own.upwards & ~self.own.downwards & ~self.own.gone

    @cached_property
    def down(self) -> Bool:
        """The train runs towards the low end."""
        return self.own.downwards & ~self.own.upwards & ~self.own.gone

    @cached_property
    def run(self) -> Num:
        """Least run of the train in the cycle: the measured run less its greatest error, mm rounded down."""
        bounds, size = self.own.reported_run, ite(self.down, -self.own.run, self.own.run)
        sure = with_unit(size * (PPM_PER_ONE - bounds.rate_ppm), NM) - bounds.floor_mm * NM_PER_MM
        return maximum(floor_to(sure, MM), 0)

    @cached_property
    def straight(self) -> Num:
        """Run in one direction after the cycle, mm."""
        was, most = self.own.run_one_way, self.own.config.straight_limit_mm
        up, down = maximum(was, 0) + self.run, minimum(was, 0) - self.run
        return ite(self.up, minimum(up, most), ite(self.down, maximum(down, -most), 0))

    def led_high(self, straight: Num) -> Bool:
        """Return the condition that the high end has led for longer than a count's run."""
        return straight > self.own.config.count_run_mm

    def led_low(self, straight: Num) -> Bool:
        """Return the condition that the low end has led for longer than a count's run."""
        return -straight > self.own.config.count_run_mm

    @cached_property
    def farthest(self) -> Num:
        """Greatest distance from one end of the pattern to the other end of a train that was whole a count's run ago, mm."""
        return self.own.longest + self.own.config.count_run_mm + self.own.config.roll_back_mm

    @cached_property
    def low(self) -> Num:
        """Lower bound of the low end of a train that was counted, mm."""
        return ite(self.led_low(self.straight), self.own.low, self.own.front_low - self.farthest)

    @cached_property
    def high(self) -> Num:
        """Upper bound of the high end of a train that was counted, mm."""
        return ite(self.led_high(self.straight), self.own.high, self.own.rear_high + self.farthest)

    @cached_property
    def good(self) -> Bool:
        """Both ends can be reported."""
        return self.own.trusted & self.own.usable & (self.own.low <= self.own.high)

    @cached_property
    def good_complete(self) -> Bool:
        """Both ends of a train that was counted can be reported: they lie on the line."""
        limit = self.own.reach.limit_mm
        return (
            self.own.trusted & self.own.usable & (self.low <= self.high) & (self.low >= -limit) & (self.high <= limit)
        )


Report = Model[Parts]


def build(own: Parts) -> Report:
    """Return the machine over the given variables."""
    table = modes("NEITHER", "WHOLE", "HIGH_END", "LOW_END")
    current = current_mode(table)
    neither, whole, _, low = table
    machine = own.declared.machine(
        name="report",
        modes=table,
        outputs={
            "reported": own.trusted_now & current.ne(neither),
            "low_mm": own.reported_low,
            "high_mm": own.reported_high,
            "integer": current.eq(whole),
            "downwards": current.eq(low),
        },
        transitions=list(_table(own, table)),
        world=world(own),
        lemmas=_lemmas(own, current, table),
        doc=(
            "Ends of a pattern that are the train's, which may part. Assumed: a count with all axles is that of "
            "the whole train within the count's run; a train is no longer than its reference; it loses vehicles "
            "at the trailing end, and the measured direction of running is true; a lost part stays, or rolls "
            "back a little; in the age of a reading nothing runs faster than the line's top speed."
        ),
    )
    return Report(machine, own)


def _lemmas(own: Parts, current: Num, table: tuple[Lit, ...]) -> dict[str, Bool]:
    _, whole, high, low = table
    straight, counts = exact_to(own.run_one_way, UM), own.run_since_complete <= own.config.count_run_mm * UM_PER_MM
    body = (own.body_rear - own.run_since_complete <= own.lowest) & (
        own.highest <= own.body_front + own.run_since_complete
    )
    return {
        "an end that leads since the train was complete is the train's": (own.run_since_complete < straight).implies(
            own.front_is_the_trains
        )
        & (own.run_since_complete < -straight).implies(own.rear_is_the_trains),
        "a train reported complete was so within the count's run": current.eq(whole).implies(counts),
        "a believed high end is the train's": current.eq(high).implies(own.front_is_the_trains),
        "a believed low end is the train's": current.eq(low).implies(own.rear_is_the_trains),
        "its body moved no farther than the train ran": counts.implies(body),
    }


def _table(own: Parts, table: tuple[Lit, ...]) -> Iterator[Transition]:
    neither, whole, high, low = table
    now = Believed(own)
    withhold: Updates = {
        own.run_one_way: now.straight,
        own.trusted_now: FALSE,
        own.reported_low: 0,
        own.reported_high: 0,
    }
    follow: Updates = {
        own.run_one_way: now.straight,
        own.trusted_now: TRUE,
        own.reported_low: own.low,
        own.reported_high: own.high,
    }
    complete: Updates = {
        own.run_one_way: now.straight,
        own.trusted_now: TRUE,
        own.reported_low: now.low,
        own.reported_high: now.high,
    }

    def row(
        name: str, source: Lit | tuple[Lit, ...], target: Lit, when: Bool, good: Bool, says: Updates, rank: int
    ) -> Iterator[Transition]:
        yield Transition(name, source, target, when & good, says, REQUIREMENTS, rank)
        yield Transition(f"{name}, not reported", source, target, when & ~good, withhold, REQUIREMENTS, rank)

    yield from row("count matches", table, whole, own.count_matches_now, now.good_complete, complete, 0)
    led_up, led_down = now.up & now.led_high(own.run_one_way), now.down & now.led_low(own.run_one_way)
    yield from row("runs up since it was complete", whole, high, led_up, now.good, follow, 1)
    yield from row("runs down since it was complete", whole, low, led_down, now.good, follow, 1)
    yield from row("runs up still", high, high, now.up, now.good, follow, 1)
    yield from row("runs down still", low, low, now.down, now.good, follow, 1)
    yield Transition("may be in parts", table, neither, TRUE, withhold, REQUIREMENTS, 2)
