"""One cycle of the balise machine: the verdict on the telegram, the supervision of linking, and the interval after it.

Every term is built once and shared by all transitions.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

from safeloc.language.expr import (
    FALSE,
    Bool,
    Num,
    abs_,
    all_of,
    any_of,
    as_num,
    exact_to,
    ite,
    maximum,
    minimum,
)
from safeloc.language.units import COUNT, NM
from safeloc.models.balise import variables as v
from safeloc.models.balise.linking import NO_REACTION, SERVICE_BRAKE, TRAIN_TRIP, Record
from safeloc.models.balise.telegram import UNKNOWN, UNLINKED
from safeloc.models.vocabulary.first_of import first_of
from safeloc.models.vocabulary.interval import Interval


@dataclass(frozen=True, eq=False)
class Sighting:
    """One announced group compared with this cycle's telegram.

    seen      the telegram comes from this group
    accuracy  the group's location accuracy, mm: from linking, else the national value or its default
    opened    the expectation window is open: the max safe front end has reached the first place where the group can be read
    closed    the window was closed before the cycle: the min safe front end had passed the last such place
    over      the window is closed after the cycle
    """

    record: Record
    seen: Bool
    accuracy: Num
    opened: Bool
    closed: Bool
    over: Bool


@dataclass(frozen=True, eq=False)
class Judgement:
    """One cycle with all verdicts. `located`: the mode reports a position; `candidate`: the mode stores an unconfirmed first group."""

    own: v.Parts
    located: Bool
    candidate: Bool

    # ------------------------------------------------------------------ the odometer alone

    @cached_property
    def before(self) -> Interval:
        """The interval before the cycle."""
        return self.own.held.interval

    @cached_property
    def run_on(self) -> Interval:
        """The interval after the cycle by the odometer alone."""
        return self.own.odometer.run_on(self.before)

    @cached_property
    def backwards(self) -> Bool:
        """The vehicle runs backwards after the cycle."""
        return self.own.heading.after(self.own.odometer.distance)[0]

    def usable(self, interval: Interval) -> Bool:
        """Return whether an interval may be reported: both margins are tolerable, and the position is on the line."""
        return interval.usable(self.own.config.tolerance_mm, self.own.config.position_limit_mm)

    # ------------------------------------------------------------------ the telegram and the announced groups

    @cached_property
    def credible(self) -> Bool:
        """The telegram is undamaged and recent, and was read while running forwards."""
        read = self.own.read
        return all_of([read.well_formed, ~read.corrupted, ~read.stale, ~self.backwards])

    @cached_property
    def sightings(self) -> tuple[Sighting, ...]:
        """The comparison of every announced group with the telegram, nearest first; at most one of them is seen."""
        found: list[Sighting] = []
        for record in self.own.linking.slots:
            matches = self.credible & self.located & record.held & record.group.eq(self.own.read.group.value)
            accuracy = record.accuracy_or(self.own.national.accuracy)
            first, last = self.own.config.reader.window(record.place, accuracy)
            found.append(
                Sighting(
                    record,
                    matches & ~any_of(one.seen for one in found),
                    accuracy,
                    maximum(self.before.high, self.run_on.high) >= first,
                    self.before.low > last,
                    maximum(self.before.low, self.run_on.low) > last,
                )
            )
        return tuple(found)

    @cached_property
    def announced(self) -> Bool:
        """The telegram is credible and comes from an announced group."""
        return any_of(one.seen for one in self.sightings)

    def _of_seen(self, *terms: Num, default: Num) -> Num:
        seen = (one.seen for one in self.sightings)
        return first_of(*zip(seen, terms, strict=True), default=default)

    @cached_property
    def place(self) -> Num:
        """Place of the group on the map, mm: from linking, else from the telegram's own map data."""
        return self._of_seen(*(one.record.place for one in self.sightings), default=self.own.read.place.value)

    @cached_property
    def accuracy(self) -> Num:
        """The location accuracy of the group, mm: from linking, else the national value, else the default."""
        return self._of_seen(*(one.accuracy for one in self.sightings), default=self.own.national.accuracy)

    @cached_property
    def orientation(self) -> Num:
        """The orientation in which the group must be passed: from linking, else the one that came with the telegram."""
        expected = (one.record.orientation for one in self.sightings)
        return self._of_seen(*expected, default=self.own.read.expected_along)

    @cached_property
    def fix(self) -> Interval:
        """Interval of the front end at the end of the cycle by the telegram alone."""
        return self.own.config.reader.fix(self.own.read, self.place, self.accuracy, self.own.odometer)

    @cached_property
    def agrees(self) -> Bool:
        """The fix and the interval can both be true: they overlap by at least the odometer's one-off constant."""
        return self.run_on.overlap(self.fix) >= self.own.config.reader.constant_nm

    @cached_property
    def inside(self) -> Bool:
        """The announced group of the telegram was read inside its expectation window."""
        return any_of(one.seen & one.opened & ~one.closed for one in self.sightings)

    @cached_property
    def matches(self) -> Bool:
        """The telegram came without a place, or with the announced one within the location accuracy."""
        apart = abs_(self.own.read.place.value - self.place)
        return ~self.own.read.place.present | (apart <= self.accuracy)

    @cached_property
    def free(self) -> Bool:
        """The group may serve as a reference without linking: it is unlinked, or no group is expected; only with `free_references`."""
        if not self.own.config.free_references:
            return FALSE
        unlinked = self.own.read.link.value.eq(UNLINKED)
        unsupervised = ~self.own.linking.slots[0].held
        return self.located & ~self.announced & (unlinked | unsupervised)

    # ------------------------------------------------------------------ the verdict on the telegram

    @cached_property
    def verdict(self) -> Num:
        """Verdict on the telegram."""
        read, memory = self.own.read, self.own.memory
        return first_of(
            (read.silent, v.NONE),
            (~read.well_formed, v.MALFORMED),
            (read.corrupted, v.CORRUPTED),
            (read.stale, v.STALE),
            (self.backwards, v.REVERSING),
            (self.announced, self._of_announced),
            (read.group.value.eq(memory.group), v.REPEATED),
            (self.located & read.group.value.eq(memory.given_up_group), v.TOO_LATE),
            (self.free, self._of_free),
            (self.located & read.link.value.eq(UNLINKED), v.UNLINKED),
            (self.located, v.NOT_ANNOUNCED),
            default=self._of_first,
        )

    @cached_property
    def _of_announced(self) -> Num:
        read = self.own.read
        return first_of(
            (~read.complete, v.INCOMPLETE),
            (read.against(self.orientation), v.WRONG_DIRECTION),
            (~self.matches, v.MISMATCH),
            (any_of(one.seen & ~one.opened for one in self.sightings), v.TOO_EARLY),
            (any_of(one.seen & one.closed for one in self.sightings), v.TOO_LATE),
            (~self.agrees, v.CONTRADICTED),
            default=v.ACCEPTED,
        )

    @cached_property
    def _unfit(self) -> list[tuple[Bool, Num]]:
        """Reasons to refuse a group without linking, wherever the vehicle is."""
        read = self.own.read
        return [
            (~read.complete, v.INCOMPLETE),
            (~read.place.present, v.NO_PLACE),
            (read.link.value.eq(UNLINKED) & read.total.value.eq(1), v.SINGLE),
            (read.against(self.orientation), v.WRONG_DIRECTION),
        ]

    @cached_property
    def _of_free(self) -> Num:
        return first_of(*self._unfit, (~self.agrees, v.OUT_OF_PLACE), default=v.ACCEPTED)

    @cached_property
    def _of_first(self) -> Num:
        """The verdict while no position is reported: a first group is a candidate, a second one that agrees with it is accepted."""
        confirmed = self.candidate & self.usable(self.run_on) & self.agrees
        trusted = v.ACCEPTED if self.own.config.trust_first_group else v.CANDIDATE
        return first_of(*self._unfit, (~self.usable(self.fix), v.TOO_COARSE), (confirmed, v.ACCEPTED), default=trusted)

    @cached_property
    def accepted(self) -> Bool:
        """The telegram passed every check."""
        return self.verdict.eq(v.ACCEPTED)

    @cached_property
    def disagrees(self) -> Bool:
        """An announced group was read whole, and not where or not as it was announced: the group or the position is false."""
        return self.announced & self.verdict.one_of(v.WRONG_DIRECTION, v.MISMATCH, v.TOO_EARLY, v.TOO_LATE)

    @cached_property
    def refused_after(self) -> Num:
        """Number of announced groups in a row that disagree, at most the limit; an accepted group resets it."""
        in_row = minimum(self.own.memory.refused_in_row + 1, self.own.config.refusal_limit_groups)
        return ite(self.accepted, as_num(0, COUNT), ite(self.disagrees, in_row, self.own.memory.refused_in_row))

    @cached_property
    def refuted(self) -> Bool:
        """As many announced groups in a row disagree as speak against the position."""
        return self.disagrees & (self.refused_after >= self.own.config.refusal_limit_groups)

    # ------------------------------------------------------------------ linking supervision

    @cached_property
    def missed(self) -> Bool:
        """The expected group's window is closed after the cycle, and the telegram comes from no announced group."""
        expected = self.sightings[0]
        return self.located & ~self.announced & expected.record.held & expected.over

    @cached_property
    def done(self) -> list[Bool]:
        """For every announced group: it and all nearer ones leave linking in this cycle, because it was read or missed."""
        return [one.seen | (self.missed if index == 0 else FALSE) for index, one in enumerate(self.sightings)]

    @cached_property
    def given_up(self) -> list[Bool]:
        """For every announced group: its expectation ends in this cycle without it being accepted."""
        result = []
        for index, one in enumerate(self.sightings):
            skipped = any_of(later.seen for later in self.sightings[index + 1 :])
            missed = self.missed if index == 0 else FALSE
            result.append(skipped | missed | (one.seen & ~self.accepted))
        return result

    @cached_property
    def ended(self) -> Num:
        """Number of announced groups that are given up in this cycle."""
        total: Num = as_num(0, COUNT)
        for gone in self.given_up:
            total = total + ite(gone, as_num(1, COUNT), as_num(0, COUNT))
        return total

    @cached_property
    def reaction(self) -> Num:
        """The strongest reaction of the groups given up in this cycle.

        TRAIN_TRIP if an announced group is passed in the wrong direction (SUBSET-026 3.16.2.3.2); at least SERVICE_BRAKE after
        two given-up groups in a row (3.16.2.7.1.1).
        """
        both = list(zip(self.given_up, self.sightings, strict=True))
        trips = [gone & one.record.reaction.eq(TRAIN_TRIP) for gone, one in both]
        brakes = [gone & one.record.reaction.eq(SERVICE_BRAKE) for gone, one in both]
        wrong_way = self.announced & self.verdict.eq(v.WRONG_DIRECTION)
        twice = (self.ended > 0) & (self.own.memory.missed_in_row + self.ended >= 2)
        return ite(any_of([*trips, wrong_way]), TRAIN_TRIP, ite(any_of([*brakes, twice]), SERVICE_BRAKE, NO_REACTION))

    @cached_property
    def left(self) -> list[Record]:
        """The announced groups that stay in linking after the telegram, nearest first."""
        return self.own.linking.advanced(self.done)

    @cached_property
    def announcement(self) -> Num:
        """Verdict on this cycle's announcement, in a mode that reports a position."""
        record = self.own.linking.offered.record
        _, last = self.own.config.reader.window(record.place, record.accuracy_or(self.own.national.accuracy))
        return self.own.linking.verdict(self.left, self.run_on.low > last)

    # ------------------------------------------------------------------ values after the cycle

    @cached_property
    def narrowed(self) -> Interval:
        """The interval after an accepted telegram: the intersection of the odometer's interval and the fix."""
        return self.run_on.narrowed(self.fix)

    @cached_property
    def given_up_after(self) -> Num:
        """Identity of the last announced group that was given up; of several in one cycle, the farthest."""
        nearest_last = reversed(list(zip(self.given_up, self.sightings, strict=True)))
        return first_of(
            *((gone, one.record.group) for gone, one in nearest_last), default=self.own.memory.given_up_group
        )

    @cached_property
    def missed_after(self) -> Num:
        """Number of announced groups given up in a row, at most 2; an accepted announced group resets it."""
        in_row = minimum(self.own.memory.missed_in_row + self.ended, 2)
        return ite(self.announced & self.accepted, as_num(0, COUNT), in_row)

    @cached_property
    def direction(self) -> Num:
        """Direction of travel: ALONG once a group with a known orientation was passed, or a second one lies surely beyond the first."""
        read, memory = self.own.read, self.own.memory
        oriented = read.passed.ne(UNKNOWN) & self.orientation.ne(UNKNOWN)
        beyond = memory.group.ne(0) & (
            self.fix.low > exact_to(memory.last_group_position + self.own.config.antenna_mm, NM) + self.run_on.above
        )
        return ite(oriented | beyond, v.ALONG, memory.direction)
