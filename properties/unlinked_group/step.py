"""One step of the machine of the unlinked group as properties see it: from what is read and measured, and the state before.

It is written independently of the machine's own terms, so that a wrong term does not confirm itself.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property

from safeloc.language.expr import Bool, Lit, Num, all_of, any_of, as_num, between, exact_to, ite, maximum, with_unit
from safeloc.language.spec import earlier_bool, earlier_num
from safeloc.language.units import MM, NM, UM
from safeloc.models.balise.telegram import PASSED, UNLINKED
from safeloc.models.unlinked_group import UnlinkedGroup
from safeloc.models.vocabulary.measured import ADMITTED

LAW = (
    "distances that can be run obey the odometer's law; the antenna stood over a group that is read whole and undamaged, as long "
    "ago as counter or age say"
)


@dataclass(frozen=True, eq=False)
class Step:
    """One step of a machine."""

    model: UnlinkedGroup

    @cached_property
    def valid(self) -> Bool:
        """A reference is reported after the step."""
        return self.model.machine.flag("valid")

    @cached_property
    def was_valid(self) -> Bool:
        """A reference was reported before the step."""
        return earlier_bool(self.valid)

    # ------------------------------------------------------------------ what was read

    @cached_property
    def given(self) -> Bool:
        """Every value of a reading is present, and its numbers can be those of one group."""
        read = self.model.own.read
        numbers = (read.total, read.read, read.first, read.last)
        present = (one.present for one in (read.group, read.link, read.check, read.age, *numbers))
        fits = (one.value <= read.total.value for one in numbers[1:])
        lone = read.first.value.eq(read.last.value).iff(read.read.value < 2)
        return all_of([*present, *fits, lone])

    @cached_property
    def any_given(self) -> Bool:
        """Some value of a reading is present."""
        read = self.model.own.read
        named = (read.since, read.age, read.last, read.first, read.read, read.total, read.check, read.link, read.group)
        return any_of(one.present for one in named)

    @cached_property
    def serves(self) -> Bool:
        """An unlinked group of several balises was read whole and undamaged, recently, while running forwards."""
        own = self.model.own
        read = own.read
        complete = (read.read.value >= read.total.value) & read.check.value.eq(PASSED)
        recent = read.age.value <= own.config.telegram_age_limit_ms
        marked = read.link.value.eq(UNLINKED) & (read.total.value >= 2)
        return all_of([self.given, complete, recent, marked, ~own.heading.backwards])

    # ------------------------------------------------------------------ what was measured

    @cached_property
    def admitted(self) -> Bool:
        """The odometer's distance was admitted."""
        return self.model.own.odometer.last_verdict.eq(ADMITTED)

    @cached_property
    def distance(self) -> Num:
        """The admitted distance, mm; 0 without one."""
        return ite(self.admitted, self.model.own.odometer.measured.value, as_num(0, MM))

    @cached_property
    def not_too_fast(self) -> Bool:
        """The odometer delivers a distance that is possible at the highest speed."""
        config, measured = self.model.own.config, self.model.own.odometer.measured
        farthest = math.ceil(config.max_speed_mm_s * config.period_ms / 1_000) + config.measuring_step_mm
        return measured.present & between(-farthest, measured.value, farthest)

    @cached_property
    def can_be_run(self) -> Bool:
        """A vehicle can have run the distance: by its speed, and by the change since the last one, while that is remembered."""
        config, odometer = self.model.own.config, self.model.own.odometer
        gap, change = earlier_num(odometer.gap), odometer.measured.value - earlier_num(odometer.last)
        most = math.ceil(config.max_acceleration_mm_s2 * config.period_ms**2 / 10**6) + config.measuring_step_mm * 2
        allowed = with_unit(gap * most, MM) + most
        forgotten = gap > config.gap_limit_cycles
        return self.not_too_fast & (forgotten | between(-allowed, change, allowed))

    @cached_property
    def silent_too_long(self) -> Bool:
        """No distance was admitted for more cycles than permitted."""
        odometer, limit = self.model.own.odometer, self.model.own.config.gap_limit_cycles
        return ~self.admitted & (earlier_num(odometer.gap) >= limit)

    def reach(self, age_ms: Num | int) -> Num:
        """Return the farthest travel of the vehicle in that time, nm."""
        top = self.model.own.config.max_speed_mm_s
        way = Lit(top * age_ms, UM) if isinstance(age_ms, int) else with_unit(age_ms * top, UM)
        return exact_to(way, NM)

    @cached_property
    def added_error(self) -> Num:
        """The error that the cycle adds to either margin, nm: that of an admitted distance, or the farthest travel
        without one.
        """
        config = self.model.own.config
        law, step = config.odometer, self.model.own.odometer.measured.value
        far = ite(step < 0, -step, step)
        above = maximum(far - law.knee_mm_s * config.period_ms // 1_000, 0) if law.knee_mm_s else far
        lawful = exact_to(Lit(law.floor_mm_s * config.period_ms, UM), NM) + with_unit(above * law.rate_ppm, NM)
        return ite(self.admitted, lawful, self.reach(config.period_ms))

    # ------------------------------------------------------------------ the interval right after a reading, and after a run

    @cached_property
    def since(self) -> Num:
        """Distance counted since the reading, mm; 0 without a counter."""
        since = self.model.own.read.since
        return ite(~since.present, as_num(0, MM), since.value)

    def first_margin(self, unmeasured: Num) -> Num:
        """Return a margin right after a reading, nm; `unmeasured`: the run since the reading, where no counter gives it."""
        config = self.model.own.config
        counted = with_unit(maximum(self.since, -self.since) * config.odometer.rate_ppm, NM)
        fixed = exact_to(as_num(config.detection_mm + config.odometer.constant_mm, MM), NM)
        return fixed + ite(~self.model.own.read.since.present, unmeasured, counted)

    def unmeasured(self, other_way: Bool) -> Num:
        """Return the run since a reading without a counter, nm, beside the odometer's one-off error; `other_way`: the cycle's
        distance points the other way.
        """
        config, age = self.model.own.config, self.model.own.read.age.value
        least, reach = exact_to(as_num(config.measuring_step_mm, MM), NM), self.reach(age)
        floor = exact_to(Lit(config.odometer.floor_mm_s * config.period_ms, UM), NM)
        sure = all_of([self.admitted, age < config.period_ms + 1, other_way, floor < reach])
        return least + ite(sure, floor, reach)

    @cached_property
    def run_on(self) -> tuple[Num, Num, Num]:
        """The distance before the step, moved by the measured one, mm, and both margins grown, nm: under-reading, over-reading."""
        held = self.model.own.held
        place = earlier_num(held.position) + self.distance
        return place, earlier_num(held.above) + self.added_error, earlier_num(held.below) + self.added_error

    @cached_property
    def beyond(self) -> Bool:
        """After the run a margin is wider than tolerable, or the distance is longer than a packet can tell."""
        config, (place, above, below) = self.model.own.config, self.run_on
        most = exact_to(as_num(config.tolerance_mm, MM), NM)
        return any_of([above > most, below > most, ~between(-config.reach_mm, place, config.reach_mm)])

    @cached_property
    def lost(self) -> Bool:
        """The distance beyond the reference before the step is not known any more."""
        return any_of([self.silent_too_long, self.model.own.heading.backwards, self.beyond])
