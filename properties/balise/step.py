"""One step of the balise machine as properties see it: computed from the state before the step and its inputs.

It is written independently of the machine's own terms, so that a wrong term does not confirm itself.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property

from safeloc.language.expr import Bool, Lit, Num, all_of, any_of, as_num, exact_to, ite, maximum, with_unit
from safeloc.language.spec import earlier_bool, earlier_num
from safeloc.language.units import MM, NM, UM
from safeloc.models.balise import Balise
from safeloc.models.balise import variables as v
from safeloc.models.balise.linking import Record
from safeloc.models.balise.telegram import NOMINAL, PASSED, REVERSE, UNKNOWN
from safeloc.models.vocabulary.interval import Interval
from safeloc.models.vocabulary.measured import ADMITTED

LAW = (
    "distances that can be run obey the odometer's law; the antenna stood over a group that is read whole and undamaged, as long "
    "ago as counter or age say; the map has it within its accuracy, or it is far off, and that rarely"
)


@dataclass(frozen=True, eq=False)
class Step:
    """One step of a machine."""

    model: Balise

    @cached_property
    def kept(self) -> Bool:
        """A position was reported before the step and still is."""
        valid = self.model.machine.flag("valid")
        return valid & earlier_bool(valid)

    # ------------------------------------------------------------------ the odometer

    @cached_property
    def old(self) -> Interval:
        """The interval before the step."""
        interval = self.model.own.held.interval
        return Interval(*(earlier_num(term) for term in (interval.position, interval.above, interval.below)))

    @cached_property
    def admitted(self) -> Bool:
        """The odometer's distance was admitted."""
        return self.model.own.odometer.last_verdict.eq(ADMITTED)

    @cached_property
    def distance(self) -> Num:
        """The admitted distance, mm; 0 without one."""
        return ite(self.admitted, self.model.own.odometer.measured.value, as_num(0, MM))

    @cached_property
    def moved(self) -> Interval:
        """The interval before the step, moved by the measured distance and grown by the odometer's law."""
        added_error = ite(self.admitted, self._lawful_nm, exact_to(self.reach(self.model.own.config.period_ms), NM))
        more = self.model.own.odometer.more
        growth = added_error if more is None else more + added_error
        place = self.old.position + exact_to(self.distance, NM)
        return Interval(place, self.old.above + growth, self.old.below + growth)

    @cached_property
    def _lawful_nm(self) -> Num:
        """Greatest error of an admitted distance, nm: the rate above the knee, and the floor over a cycle."""
        law, period = self.model.own.config.odometer, self.model.own.config.period_ms
        step = self.model.own.odometer.measured.value
        far = ite(step < 0, -step, step)
        above = maximum(far - law.knee_mm_s * period // 1_000, 0) if law.knee_mm_s else far
        return exact_to(Lit(law.floor_mm_s * period, UM), NM) + with_unit(above * law.rate_ppm, NM)

    def reach(self, age_ms: Num | int) -> Num:
        """Return the farthest travel of the vehicle in that time, um."""
        top = self.model.own.config.max_speed_mm_s
        return Lit(top * age_ms, UM) if isinstance(age_ms, int) else with_unit(age_ms * top, UM)

    # ------------------------------------------------------------------ the telegram

    def read_of(self, slot: Record) -> Bool:
        """Return whether the reading has the identity of the group that was in a slot."""
        group = self.model.own.read.group
        return group.present & earlier_num(slot.group).eq(group.value)

    @cached_property
    def well_formed(self) -> Bool:
        """Every value of a reading is present, and its numbers can be those of one group."""
        read = self.model.own.read
        group = (read.group, read.link, read.check, read.age)
        numbers = (read.total, read.read, read.first, read.last)
        total, several = read.total.value, read.first.value.ne(read.last.value)
        fits = [total >= one.value for one in numbers[1:]]
        return all_of([*(one.present for one in (*numbers, *group)), *fits, several.iff(read.read.value.ne(1))])

    @cached_property
    def complete(self) -> Bool:
        """Every balise was read, with right check bits, no longer ago than permitted, while running forwards."""
        own = self.model.own
        read = own.read
        present = all_of(one.present for one in (read.group, read.read, read.total, read.age, read.check))
        complete = read.read.value.eq(read.total.value)
        recent = read.age.value <= own.config.telegram_age_limit_ms
        return all_of([present, complete, recent, read.check.value.eq(PASSED), ~own.heading.backwards])

    def against(self, slot: Record) -> Bool:
        """Return whether the group was passed in the other orientation than announced."""
        first, last = self.model.own.read.first, self.model.own.read.last
        announced = earlier_num(slot.orientation)
        forth, back = first.value < last.value, last.value < first.value
        return first.present & last.present & ((forth & announced.eq(REVERSE)) | (back & announced.eq(NOMINAL)))

    @cached_property
    def announced(self) -> Bool:
        """An announced group was read, and not damaged, too long ago or while running backwards."""
        own = self.model.own
        unread = own.memory.verdict.one_of(v.NONE, v.MALFORMED, v.CORRUPTED, v.STALE, v.REVERSING)
        held = (self.read_of(slot) & earlier_num(slot.group).ne(0) for slot in own.linking.slots)
        return ~unread & any_of(held)

    # ------------------------------------------------------------------ accuracy and windows

    @cached_property
    def accuracy_in_force(self) -> Num:
        """The location accuracy where linking gives none, mm."""
        national = self.model.own.national
        return ite(national.known, national.stored, as_num(self.model.own.config.default_accuracy_mm, MM))

    def accuracy_of(self, slot: Record) -> Num:
        """Return the location accuracy of the group that was in a slot, mm."""
        return ite(earlier_bool(slot.accurate), earlier_num(slot.accuracy), self.accuracy_in_force)

    @cached_property
    def accuracy_by_precedence(self) -> Num:
        """The location accuracy of the group that was read, mm."""
        result = self.accuracy_in_force
        for slot in reversed(self.model.own.linking.slots):
            result = ite(self.read_of(slot), self.accuracy_of(slot), result)
        return result

    def can_read_from(self, slot: Record) -> Bool:
        """Return whether the max safe front end has reached the first place where the antenna can read the group of a slot."""
        farthest = maximum(self.old.high, self.moved.high) + self._spread(slot)
        return farthest - exact_to(as_num(self.model.own.config.antenna_mm, MM), NM) >= self._place(slot)

    def beyond(self, slot: Record, front: Num) -> Bool:
        """Return whether the antenna is beyond the last place where the group of a slot can be read, with the front end at `front`."""
        antenna = front - exact_to(as_num(self.model.own.config.antenna_mm, MM), NM)
        return antenna - self._place(slot) > self._spread(slot)

    def _place(self, slot: Record) -> Num:
        return exact_to(earlier_num(slot.place), NM)

    def _spread(self, slot: Record) -> Num:
        """Location accuracy of the group and detection accuracy of the antenna, nm."""
        return exact_to(self.model.own.config.detection_mm + self.accuracy_of(slot), NM)

    def inside(self, slot: Record) -> Bool:
        """Return whether the expectation window of a slot's group was open: the max safe front end had reached the first place
        where the group can be read, and the min safe front end had not passed the last one."""
        return self.can_read_from(slot) & ~self.beyond(slot, self.old.low)

    @cached_property
    def passed(self) -> Bool:
        """The min safe front end has passed the last place where the expected group can be read."""
        expected = self.model.own.linking.slots[0]
        return self.beyond(expected, self.old.low) | self.beyond(expected, self.moved.low)

    # ------------------------------------------------------------------ the content of an accepted telegram

    @cached_property
    def counts(self) -> Bool:
        """The telegram was accepted, or is the candidate."""
        return self.model.own.memory.verdict.one_of(v.ACCEPTED, v.CANDIDATE)

    def by_precedence(self, of_slot: Callable[[Record], Num], otherwise: Num) -> Num:
        """Return the value that linking gives for the group that was read, else the one that came with the telegram."""
        result, located = otherwise, earlier_bool(self.model.machine.flag("valid"))
        for slot in reversed(self.model.own.linking.slots):
            known = located & earlier_num(slot.group).ne(0) & self.read_of(slot)
            result = ite(known, earlier_num(of_slot(slot)), result)
        return result

    @cached_property
    def place_as_announced(self) -> Num:
        """Place of the group that was read, mm."""
        return self.by_precedence(lambda slot: slot.place, self.model.own.read.place.value)

    @cached_property
    def oriented(self) -> Bool:
        """The telegram shows the orientation in which the group was passed, and the expected one is known."""
        read = self.model.own.read
        own = ite(~read.orientation.present, UNKNOWN, read.orientation.value)
        return read.first.value.ne(read.last.value) & self.by_precedence(lambda slot: slot.orientation, own).ne(UNKNOWN)

    @cached_property
    def surely_ahead(self) -> Bool:
        """The front end, as the telegram puts it at the least, is beyond where it was at the last group, by more than over."""
        own, read, config = self.model.own, self.model.own.read, self.model.own.config
        since = ite(~read.since.present, as_num(0, MM), read.since.value)
        way = self.place_as_announced - earlier_num(own.memory.last_group_position) + since
        told = exact_to(way - self.accuracy_by_precedence - config.detection_mm - config.odometer.constant_mm, NM)
        far = maximum(since, -since) * config.odometer.rate_ppm
        unmeasured = self._run_back(read.age.value)
        less = ite(~read.since.present, unmeasured, with_unit(far, NM))
        return earlier_num(own.memory.group).ne(0) & (told - less > self.moved.above)

    def _run_back(self, age: Num) -> Num:
        """Greatest run backwards since a reading without a counter, nm, beside the odometer's one-off error."""
        config, more = self.model.own.config, self.model.own.odometer.more
        step, reach = exact_to(as_num(config.measuring_step_mm, MM), NM), exact_to(self.reach(age), NM)
        unseen = exact_to(Lit(config.odometer.floor_mm_s * config.period_ms, UM), NM)
        if more is not None:
            unseen = unseen + more
        forwards = self.admitted & (age < config.period_ms + 1) & (self.distance >= 0)
        return step + ite(forwards & (unseen < reach), unseen, reach)

    @cached_property
    def expecting(self) -> Bool:
        """A group was expected."""
        return earlier_num(self.model.own.linking.slots[0].group).ne(0)
