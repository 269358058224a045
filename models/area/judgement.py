"""Terms of one cycle of a virtual section: its state, the evidence for it, the age of that, and its trust."""

from __future__ import annotations

from dataclasses import dataclass

from safeloc.language.expr import Bool, BoolVar, Num, NumVar, all_of, any_of, as_num, ite, maximum, members
from safeloc.language.units import COUNT
from safeloc.models.vocabulary.how_many import how_many

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
    """Inputs of a section for one train of the area."""

    present: BoolVar
    low: NumVar
    high: NumVar
    silent: NumVar
    unconfirmed: NumVar


@dataclass(frozen=True, eq=False)
class Judgement:
    """Terms of one cycle of a section.

    mute, integrity  greatest number of cycles without a trusted report, and without confirmed integrity
    loose            vehicles that were never counted may be here
    covered          detection inside the area says that nobody is here; None if there is no such detection
    """

    mute: int
    integrity: int
    start: NumVar
    end: NumVar
    trains: tuple[TrainHere, ...]
    loose: Bool
    covered: Bool | None = None

    def reaches(self, train: TrainHere) -> Bool:
        """Return the condition that the train may be in the section."""
        reaches = self._in_reach(train)
        return reaches if self.covered is None else reaches & ~self.covered

    def _in_reach(self, train: TrainHere) -> Bool:
        return train.present & (train.low <= self.end) & (train.high >= self.start)

    def silent(self, train: TrainHere) -> Bool:
        """Return the condition that the last report of the train is older than the mute timer."""
        return train.silent > self.mute

    def followed(self, train: TrainHere) -> Bool:
        """Return the condition that the train may be here, and its last report is recent."""
        return self.reaches(train) & ~self.silent(train)

    @property
    def free(self) -> Bool:
        """No vehicle can be here."""
        return ~self.loose & all_of(~self.reaches(train) for train in self.trains)

    @property
    def any_followed(self) -> Bool:
        """Some train with a recent report may be here."""
        return any_of(self.followed(train) for train in self.trains)

    @property
    def only_confirmed(self) -> Bool:
        """Every vehicle that may be here belongs to a train with a recent report that is whole."""
        confirmed = [(~self.reaches(t)) | (self.followed(t) & (t.unconfirmed <= self.integrity)) for t in self.trains]
        return ~self.loose & all_of(confirmed)

    def status(self, label: str) -> Bool:
        """Return the condition of one of the four states; exactly one of them holds."""
        match label:
            case "FREE":
                return self.free
            case "OCCUPIED":
                return ~self.free & self.any_followed & self.only_confirmed
            case "AMBIGUOUS":
                return ~self.free & self.any_followed & ~self.only_confirmed
            case _:
                return ~self.free & ~self.any_followed

    # -------------------------------------------------------------- evidence

    @property
    def count(self) -> Num:
        """Number of trains that may be here."""
        return how_many(self.reaches(train) for train in self.trains)

    @property
    def followed_count(self) -> Num:
        """Number of those with a recent report."""
        return how_many(self.followed(train) for train in self.trains)

    @property
    def first(self) -> Num:
        """First slot whose train may be here; 0 for none."""
        found = as_num(0, COUNT)
        for index in range(len(self.trains), 0, -1):
            found = ite(self.reaches(self.trains[index - 1]), as_num(index, COUNT), found)
        return found

    @property
    def evidence(self) -> Num:
        """Evidence for the state; the worst of several."""
        silent = any_of(self.reaches(train) & self.silent(train) for train in self.trains)
        part = any_of(self.reaches(train) & (train.unconfirmed > self.integrity) for train in self.trains)
        here = ite(silent, TRAIN_SILENT, ite(part, PART_LEFT_BEHIND, TRAIN_FOLLOWED))
        nobody = ite(any_of(train.present for train in self.trains), TRAINS_ELSEWHERE, NO_TRAIN)
        return ite(self.free, nobody, ite(self.loose, UNCOUNTED, here))

    def rests_on(self, train: TrainHere) -> Bool:
        """Return the condition that the state rests on this train: a clear section on all trains, another one on those in it."""
        return train.present & (self.free | self.reaches(train))

    @property
    def age(self) -> Num:
        """Cycles since the oldest report on which the state rests; 0 if it rests on none."""
        oldest: Num = as_num(0, COUNT)
        for train in self.trains:
            oldest = maximum(oldest, ite(self.rests_on(train), train.silent, 0))
        return oldest

    @property
    def trust(self) -> Num:
        """Trust in the state: reports within the mute timer; older reports extended at top speed; or none, with loose vehicles."""
        old = any_of(self.rests_on(train) & self.silent(train) for train in self.trains)
        return ite(self.loose, NO_TRUST, ite(old, RUN_ON, VERIFIED))
