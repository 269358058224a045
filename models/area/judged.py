"""What a cycle tells of a virtual section: its state, what that rests on, how old that is, and how far to trust it."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

from safeloc.language.expr import Bool, BoolVar, Num, NumVar, all_of, any_of, as_num, ite, maximum, members
from safeloc.language.units import COUNT

EVIDENCE = members(
    "evidence",
    "NOTHING_YET",
    "NO_TRAIN",
    "TRAINS_ELSEWHERE",
    "TRAIN_FOLLOWED",
    "PART_LEFT_BEHIND",
    "TRAIN_SILENT",
    "UNCOUNTED",
)
NOTHING_YET, NO_TRAIN, TRAINS_ELSEWHERE, TRAIN_FOLLOWED, PART_LEFT_BEHIND, TRAIN_SILENT, UNCOUNTED = EVIDENCE
TRUST = members("trust", "NONE", "RUN_ON", "VERIFIED")
NO_TRUST, RUN_ON, VERIFIED = TRUST


@dataclass(frozen=True, eq=False)
class TrainHere:
    """What a section is told of one train of the area: inputs."""

    present: BoolVar
    low: NumVar
    high: NumVar
    silent: NumVar
    unconfirmed: NumVar


@dataclass(frozen=True, eq=False)
class Judged:
    """What a cycle tells of a section.

    mute, integrity  cycles without a trusted report, without confirmed integrity, that are still borne
    loose            something that was never counted may be here
    """

    mute: int
    integrity: int
    start: NumVar
    end: NumVar
    trains: tuple[TrainHere, ...]
    loose: Bool

    def reaches(self, train: TrainHere) -> Bool:
        """The train may be in the section."""
        return train.present & (train.low <= self.end) & (train.high >= self.start)

    def silent(self, train: TrainHere) -> Bool:
        """It was not heard of for longer than the mute timer."""
        return train.silent > self.mute

    def followed(self, train: TrainHere) -> Bool:
        """It may be here, and was heard of lately."""
        return self.reaches(train) & ~self.silent(train)

    @property
    def free(self) -> Bool:
        """Nothing can be here."""
        return ~self.loose & all_of(~self.reaches(train) for train in self.trains)

    @property
    def any_followed(self) -> Bool:
        """Some train that was heard of lately may be here."""
        return any_of(self.followed(train) for train in self.trains)

    @property
    def only_whole(self) -> Bool:
        """Whatever may be here was heard of lately and is whole."""
        whole = [(~self.reaches(t)) | (self.followed(t) & (t.unconfirmed <= self.integrity)) for t in self.trains]
        return ~self.loose & all_of(whole)

    def status(self, label: str) -> Bool:
        """Whether that is what the cycle tells; exactly one of the four holds."""
        match label:
            case "FREE":
                return self.free
            case "OCCUPIED":
                return ~self.free & self.any_followed & self.only_whole
            case "AMBIGUOUS":
                return ~self.free & self.any_followed & ~self.only_whole
            case _:
                return ~self.free & ~self.any_followed

    # -------------------------------------------------------------- what it rests on

    @property
    def count(self) -> Num:
        """How many trains may be here."""
        return _sum(self.reaches(train) for train in self.trains)

    @property
    def followed_count(self) -> Num:
        """How many of them were heard of lately."""
        return _sum(self.followed(train) for train in self.trains)

    @property
    def first(self) -> Num:
        """The first slot whose train may be here; 0 for none."""
        found = as_num(0, COUNT)
        for index in range(len(self.trains), 0, -1):
            found = ite(self.reaches(self.trains[index - 1]), as_num(index, COUNT), found)
        return found

    @property
    def evidence(self) -> Num:
        """What the state rests on; of several things the one that is worst."""
        silent = any_of(self.reaches(train) & self.silent(train) for train in self.trains)
        part = any_of(self.reaches(train) & (train.unconfirmed > self.integrity) for train in self.trains)
        here = ite(silent, TRAIN_SILENT, ite(part, PART_LEFT_BEHIND, TRAIN_FOLLOWED))
        nobody = ite(any_of(train.present for train in self.trains), TRAINS_ELSEWHERE, NO_TRAIN)
        return ite(self.free, nobody, ite(self.loose, UNCOUNTED, here))

    def rests_on(self, train: TrainHere) -> Bool:
        """Of a clear section, that every train is elsewhere; of another one, what may be here."""
        return train.present & (self.free | self.reaches(train))

    @property
    def age(self) -> Num:
        """Cycles since the oldest report that the state rests on; 0 where it rests on none."""
        oldest: Num = as_num(0, COUNT)
        for train in self.trains:
            oldest = maximum(oldest, ite(self.rests_on(train), train.silent, 0))
        return oldest

    @property
    def trust(self) -> Num:
        """Verified reports not older than the mute timer; or such that were run on since, at top speed; or none."""
        old = any_of(self.rests_on(train) & self.silent(train) for train in self.trains)
        return ite(self.loose, NO_TRUST, ite(old, RUN_ON, VERIFIED))


def _sum(terms: Iterable[Bool]) -> Num:
    total = as_num(0, COUNT)
    for term in terms:
        total = total + ite(term, as_num(1, COUNT), 0)
    return total
