"""One step of the balise machine as properties see it: told from the state before it and its inputs.

Written apart from the terms that the machine itself is made of, so that a wrong one does not confirm itself.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

from safeloc.language.expr import Bool, Num, all_of, any_of, as_num, ite, maximum
from safeloc.language.spec import earlier_bool, earlier_num
from safeloc.language.units import MM, NM
from safeloc.models.balise import Balise
from safeloc.models.balise import variables as v
from safeloc.models.balise.linking import Record
from safeloc.models.balise.telegram import NOMINAL, PASSED, REVERSE
from safeloc.models.vocabulary.interval import Interval
from safeloc.models.vocabulary.measured import ADMITTED

LAW = (
    "admitted distances obey the odometer's law; an announced group that is read whole, undamaged, recent, in the announced "
    "orientation and inside its window lies where the map has it within its accuracies; top speed"
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
        return Interval(*(earlier_num(term) for term in (interval.position, interval.over, interval.under)))

    @cached_property
    def admitted(self) -> Bool:
        """The distance counted."""
        return self.model.own.odometer.judged.eq(ADMITTED)

    @cached_property
    def distance(self) -> Num:
        """The distance that counted, mm."""
        return ite(self.admitted, self.model.own.odometer.step.value, as_num(0, MM))

    @cached_property
    def moved(self) -> Interval:
        """The interval before the step, moved by the measured distance and grown by the odometer's law."""
        blind = as_num(self.model.own.config.limits.blind_nm, NM)
        growth = ite(self.admitted, self.model.own.odometer.most_error, blind)
        return self.old.moved(self.distance, growth)

    # ------------------------------------------------------------------ the telegram

    def read_of(self, slot: Record) -> Bool:
        """What was read has the identity of the group that was in a slot."""
        group = self.model.own.read.group
        return group.present & earlier_num(slot.group).eq(group.value)

    @cached_property
    def whole(self) -> Bool:
        """Every balise was read, with right check bits, no longer ago than permitted, while running forwards."""
        own = self.model.own
        read = own.read
        present = all_of(one.present for one in (read.group, read.read, read.total, read.age, read.check))
        complete = read.read.value.eq(read.total.value)
        recent = read.age.value <= own.config.telegram_age_limit_ms
        return all_of([present, complete, recent, read.check.value.eq(PASSED), ~own.heading.backwards])

    def against(self, slot: Record) -> Bool:
        """The group was passed in the other orientation than announced."""
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
        return ite(national.known, national.kept, as_num(self.model.own.config.default_accuracy_mm, MM))

    def accuracy_of(self, slot: Record) -> Num:
        """The location accuracy of the group that was in a slot, mm."""
        return ite(earlier_bool(slot.accurate), earlier_num(slot.accuracy), self.accuracy_in_force)

    @cached_property
    def accuracy_by_precedence(self) -> Num:
        """The location accuracy of what was read, mm."""
        result = self.accuracy_in_force
        for slot in reversed(self.model.own.linking.slots):
            result = ite(self.read_of(slot), self.accuracy_of(slot), result)
        return result

    def window(self, slot: Record) -> tuple[Num, Num]:
        """The first and the last place of the front end at which the group that was in a slot can be read, nm."""
        return self.model.own.config.reader.window(earlier_num(slot.place), self.accuracy_of(slot))

    def inside(self, slot: Record) -> Bool:
        """The max safe front end had reached the first place, and the min safe front end not passed the last one."""
        first, last = self.window(slot)
        return (maximum(self.old.high, self.moved.high) >= first) & (self.old.low <= last)

    @cached_property
    def passed(self) -> Bool:
        """The min safe front end has passed the last place where the expected group can be read."""
        _, last = self.window(self.model.own.linking.slots[0])
        return maximum(self.old.low, self.moved.low) > last

    @cached_property
    def expecting(self) -> Bool:
        """A group was expected."""
        return earlier_num(self.model.own.linking.slots[0].group).ne(0)
