"""Properties of what one virtual section reports (FVA-9, FVA-18): its state, its evidence, and how long both stand.

That a clear section is empty is claimed of the composition (`properties/sections.py`). Here each state and each reported value is
claimed in both directions, from the trains and vehicles that the area reports.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import partial

from safeloc.language.expr import Bool, Num, all_of, any_of, as_num, before, ite, maximum, minimum
from safeloc.language.spec import Property, always, earlier_num
from safeloc.language.units import COUNT
from safeloc.models.area.judgement import (
    NO_TRAIN,
    NO_TRUST,
    PART_LEFT_BEHIND,
    RUN_ON,
    TRAIN_FOLLOWED,
    TRAIN_SILENT,
    TRAINS_ELSEWHERE,
    UNCOUNTED,
    VERIFIED,
    TrainHere,
)
from safeloc.models.sections import Section
from safeloc.properties.how_many import how_many

for_all_inputs = partial(always, requirements=("FVA-9", "FVA-18"), unconditional=True)


@dataclass(frozen=True, eq=False)
class _Told:
    """The inputs of a section, read as the requirement does."""

    section: Section

    @property
    def detected_clear(self) -> Bool:
        """Detection inside the area says that nobody is here."""
        start, end = self.section.start, self.section.end
        return any_of(~((one.start > start) | (one.end < end) | ~one.clear) for one in self.section.inner)

    @property
    def uncounted(self) -> Bool:
        """A vehicle that was never counted may be here."""
        one, sides = self.section, list[Bool]()
        if one.followers:
            from_low, from_high = one.followers
            sides = [one.start <= from_low, one.end >= from_high]
        elsewhere = (one.loose_low > one.end) | (one.loose_high < one.start)
        return any_of([*sides, ~(~one.unswept | elsewhere)]) & ~self.detected_clear

    def here(self, train: TrainHere) -> Bool:
        """Return whether a part of the train may be here."""
        elsewhere = [train.low > self.section.end, train.high < self.section.start, self.detected_clear]
        return ~any_of([~train.present, *elsewhere])

    def recent(self, train: TrainHere) -> Bool:
        """Its last report is within the mute timer."""
        return train.silent <= self.section.config.mute_limit_cycles

    def parted(self, train: TrainHere) -> Bool:
        """It is not known to be whole since the integrity timer ended."""
        return train.unconfirmed > self.section.config.integrity_limit_cycles

    @property
    def empty(self) -> Bool:
        """Nobody can be here."""
        return ~any_of([self.uncounted, *(self.here(train) for train in self.section.trains)])

    def counts(self, train: TrainHere) -> Bool:
        """Return whether the state rests on the report of this train: all trains show that a section is clear, and those in it that it is not."""
        return train.present & any_of([self.here(train), self.empty])


def properties(one: Section) -> list[Property]:
    """Return the properties of the machine of one section by itself."""
    told = _Told(one)
    return [*_state(one, told), *_trains(one, told), *_evidence(one, told), *_trust(one, told), *_since(one)]


def _state(one: Section, told: _Told) -> Iterator[Property]:
    unknown, free, occupied, ambiguous = one.machine.modes
    mode, trains = one.machine.mode, one.trains
    followed = any_of(told.here(train) & told.recent(train) for train in trains)
    doubtful = [told.here(train) & (told.parted(train) | ~told.recent(train)) for train in trains]
    doubt = any_of([told.uncounted, *doubtful])
    yield for_all_inputs(
        "the state follows from trains and vehicles that may be here",
        all_of(
            [
                mode.eq(free).iff(told.empty),
                mode.eq(unknown).iff(~told.empty & ~followed),
                mode.eq(occupied).iff(followed & ~doubt),
                mode.eq(ambiguous).iff(followed & doubt),
            ]
        ),
        statement="a section is FREE exactly if nobody can be in it, OCCUPIED if only whole trains with recent reports can, AMBIGUOUS if "
        "others can as well, and UNKNOWN if only others can",
    )
    yield for_all_inputs(
        "a clear section is told",
        one.machine.flag("clear").iff(mode.eq(free)),
        statement="the section is reported clear while it is FREE, and at no other time",
    )


def _trains(one: Section, told: _Told) -> Iterator[Property]:
    here = [told.here(train) for train in one.trains]
    first = as_num(0, COUNT)
    for number in reversed(range(len(here))):
        first = ite(here[number], as_num(number + 1, COUNT), first)
    output = one.machine.output
    yield for_all_inputs(
        "the trains that may be here are told",
        output("trains").eq(how_many(here))
        & output("first_train").eq(first)
        & output("trains_followed").eq(how_many(told.here(train) & told.recent(train) for train in one.trains)),
        statement="the section reports how many trains may be in it, the first of them, and how many of them have recent reports",
    )


def _evidence(one: Section, told: _Told) -> Iterator[Property]:
    evidence, trains, empty = one.machine.output("evidence"), one.trains, told.empty
    silent = any_of(told.here(train) & ~told.recent(train) for train in trains)
    parted = any_of(told.here(train) & told.parted(train) for train in trains)
    a_step = one.machine.stayed() | ~one.machine.stayed()  # at the start there is no evidence yet
    some, counted = any_of(train.present for train in trains), ~empty & ~told.uncounted
    cases = {
        NO_TRAIN: empty & ~some,
        TRAINS_ELSEWHERE: empty & some,
        UNCOUNTED: told.uncounted,
        TRAIN_SILENT: counted & silent,
        PART_LEFT_BEHIND: counted & ~silent & parted,
        TRAIN_FOLLOWED: counted & ~silent & ~parted,
    }
    yield for_all_inputs(
        "the evidence is that of the state",
        a_step.implies(all_of(evidence.eq(name).iff(case) for name, case in cases.items())),
        statement="the section reports the worst evidence of those in it, or that no train is in it or in the area",
    )


def _trust(one: Section, told: _Told) -> Iterator[Property]:
    age, trust = one.machine.output("evidence_age_cycles"), one.machine.output("trust")
    oldest: Num = as_num(0, COUNT)
    for train in reversed(one.trains):
        oldest = ite(told.counts(train), maximum(train.silent, oldest), oldest)
    old = any_of(told.counts(train) & ~told.recent(train) for train in one.trains)
    yield for_all_inputs(
        "the age of the evidence is that of the oldest report",
        age.eq(oldest),
        statement="the section reports the age of the oldest report on which its state rests",
    )
    cases = {NO_TRUST: told.uncounted, RUN_ON: ~told.uncounted & old, VERIFIED: ~told.uncounted & ~old}
    yield for_all_inputs(
        "trust follows from the evidence",
        all_of(trust.eq(name).iff(case) for name, case in cases.items()),
        statement="a state is verified if all reports on which it rests are within the mute timer, and trusted in no way while a "
        "vehicle can be here that was never counted",
    )


def _since(one: Section) -> Iterator[Property]:
    mode, since = one.machine.mode, one.machine.output("since_cycles")
    most = one.config.area.count_limit
    yield for_all_inputs(
        "the time in the state is counted",
        since.eq(ite(mode.eq(before(mode)), minimum(earlier_num(since) + 1, most), as_num(0, COUNT))),
        statement="the section reports for how many cycles it has had its state",
    )
