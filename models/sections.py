"""A virtual section: clear or not, from where the trains of its line area may be (FVA-9, FVA-18).

Sections are cut freely along the line. A section is FREE only on positive evidence: no train's interval reaches it,
and nothing that was never counted can be in it. Everything that is not FREE is occupied for the interlocking.

    UNKNOWN     something may be here, and nothing tells what (also the start)
    FREE        nothing is here
    OCCUPIED    trains that are followed and known to be whole, and nothing else
    AMBIGUOUS   a train that is followed, and perhaps something else, or a part that it lost

The transitions carry the numbers of the published rules for virtual sub-sections (figures, section 7).
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from safeloc.composition import Composition, compose
from safeloc.config import Config, quantity
from safeloc.expr import (
    Bool,
    BoolVar,
    Expr,
    Lit,
    Num,
    NumVar,
    Var,
    all_of,
    any_of,
    as_num,
    boolean,
    ite,
    minimum,
    number,
)
from safeloc.machine import ANY, Machine, Transition, current_mode, modes
from safeloc.models.area import Area, AreaConfig
from safeloc.models.area import build as build_area
from safeloc.models.area import parts as area_parts
from safeloc.units import COUNT, MM

TRACE = ("FVA-9", "FVA-18")
RULES = {
    ("FREE", "UNKNOWN"): 1,
    ("FREE", "OCCUPIED"): 2,
    ("FREE", "AMBIGUOUS"): 3,
    ("UNKNOWN", "FREE"): 4,
    ("UNKNOWN", "AMBIGUOUS"): 5,
    ("OCCUPIED", "FREE"): 6,
    ("OCCUPIED", "UNKNOWN"): 7,
    ("OCCUPIED", "AMBIGUOUS"): 8,
    ("AMBIGUOUS", "FREE"): 9,
    ("AMBIGUOUS", "UNKNOWN"): 10,
    ("AMBIGUOUS", "OCCUPIED"): 11,
    ("UNKNOWN", "OCCUPIED"): 12,
}


class SectionsConfig(Config):
    """Line area, and how long a train without news still counts as followed."""

    area: AreaConfig = AreaConfig()
    sections: int = quantity(1, "count", 1, 64, "[D] sections of one composition; each is independent of the others")
    mute_limit_cycles: int = quantity(5, "cycles", 0, 100_000, "[M] mute timer: 5 s without a trusted report")
    integrity_limit_cycles: int = quantity(30, "cycles", 0, 100_000, "[M] wait-integrity timer: 30 s")


@dataclass(frozen=True, eq=False)
class TrainHere:
    """What a section is told of one train of the area: inputs."""

    present: BoolVar
    low: NumVar
    high: NumVar
    silent: NumVar
    unconfirmed: NumVar


@dataclass(frozen=True, eq=False)
class Section:
    """One section's machine and variables: bounds (any two places in the area), and what it is told of the area."""

    machine: Machine
    start: NumVar
    end: NumVar
    trains: tuple[TrainHere, ...]
    unswept: BoolVar
    loose_low: NumVar
    loose_high: NumVar


@dataclass(frozen=True, eq=False)
class Sections:
    """A line area with its sections in one step."""

    area: Area
    sections: tuple[Section, ...]
    composition: Composition


def compose_machines(config: SectionsConfig | None = None) -> Sections:
    """Area and sections: each section sees the trains as they are after the area's step (FVA-9)."""
    config = config or SectionsConfig()
    area = build_area(area_parts(config.area))
    return joined(area, tuple(section(config, f"section_{n}") for n in range(1, config.sections + 1)))


def joined(area: Area, sections: tuple[Section, ...]) -> Sections:
    """The given machines, wired."""
    wires: dict[Var, Expr] = {}
    for one in sections:
        wires |= section_wires(area, one)
    whole = compose("sections", [area.machine, *(one.machine for one in sections)], wires)
    return Sections(area, sections, whole)


def section_wires(area: Area, one: Section) -> dict[Var, Expr]:
    """What a section is told of the area in a step."""
    own = area.own
    wires: dict[Var, Expr] = {
        one.unswept: area.machine.mode.eq(area.machine.modes[0]),
        one.loose_low: own.loose_low,
        one.loose_high: own.loose_high,
    }
    for told, train in zip(one.trains, own.slots, strict=True):
        wires |= {told.present: train.present, told.low: train.low, told.high: train.high}
        wires |= {told.silent: train.silent, told.unconfirmed: train.unconfirmed}
    return wires


def section(config: SectionsConfig, name: str) -> Section:
    """One section with fresh variables."""
    limit, count = config.area.limit_mm, config.area.count_limit
    start, end = number("from_mm", MM, -limit, limit), number("to_mm", MM, -limit, limit)
    unswept = boolean("area_unswept")
    loose_low, loose_high = (number(f"area_loose_{side}_mm", MM, -limit, limit) for side in ("low", "high"))
    trains = tuple(_train(n, limit, count) for n in range(1, config.area.trains + 1))
    rule, since, here = number("rule", COUNT, 0, 12), number("since_cycles", COUNT, 0, count), _counts(config)
    told = [var for t in trains for var in (t.present, t.low, t.high, t.silent, t.unconfirmed)]
    judged = _Judged(config, start, end, trains, unswept & (loose_low <= end) & (loose_high >= start))
    table = modes("UNKNOWN", "FREE", "OCCUPIED", "AMBIGUOUS")
    current = current_mode(table)
    kept: dict[Var, Expr] = {here[0]: judged.count, here[1]: judged.first, here[2]: judged.followed_count}
    machine = Machine(
        name=name,
        modes=table,
        inputs=[*told, unswept, loose_low, loose_high],
        state={start: ANY, end: ANY, rule: 0, since: 0, here[0]: 0, here[1]: 0, here[2]: 0},
        outputs={
            "clear": current.eq(table[1]),
            "trains": here[0],
            "first_train": here[1],
            "trains_followed": here[2],
            "rule": rule,
            "since_cycles": since,
        },
        transitions=list(_table(judged, table, rule, since, kept)),
        initially=start < end,
        lemmas={"bounds in order": start < end},
        mode_variable=current,
        doc="One virtual section: clear only where no train of the area may be, and nothing that was never counted.",
    )
    return Section(machine, start, end, trains, unswept, loose_low, loose_high)


def _counts(config: SectionsConfig) -> tuple[NumVar, NumVar, NumVar]:
    names = ("trains_here", "first_train_here", "trains_followed_here")
    first, second, third = (number(name, COUNT, 0, config.area.trains) for name in names)
    return first, second, third


def _train(number_: int, limit: int, count: int) -> TrainHere:
    name = f"area_train_{number_}"
    return TrainHere(
        boolean(f"{name}_present"),
        number(f"{name}_low_mm", MM, -limit, limit),
        number(f"{name}_high_mm", MM, -limit, limit),
        number(f"{name}_silent_cycles", COUNT, 0, count),
        number(f"{name}_unconfirmed_cycles", COUNT, 0, count),
    )


@dataclass(frozen=True, eq=False)
class _Judged:
    """What a cycle tells of a section."""

    config: SectionsConfig
    start: NumVar
    end: NumVar
    trains: tuple[TrainHere, ...]
    loose: Bool

    def reaches(self, train: TrainHere) -> Bool:
        """The train may be in the section."""
        return train.present & (train.low <= self.end) & (train.high >= self.start)

    def followed(self, train: TrainHere) -> Bool:
        """It may be here, and was heard of lately."""
        return self.reaches(train) & (train.silent <= self.config.mute_limit_cycles)

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
        limit = self.config.integrity_limit_cycles
        whole = [(~self.reaches(t)) | (self.followed(t) & (t.unconfirmed <= limit)) for t in self.trains]
        return ~self.loose & all_of(whole)

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


def _sum(terms: Iterator[Bool]) -> Num:
    total = as_num(0, COUNT)
    for term in terms:
        total = total + ite(term, as_num(1, COUNT), 0)
    return total


def _table(
    judged: _Judged, table: tuple[Lit, ...], rule: NumVar, since: NumVar, kept: dict[Var, Expr]
) -> Iterator[Transition]:
    by_label = {mode.label: mode for mode in table}
    for (source, target), number_ in sorted(RULES.items(), key=lambda item: item[1]):
        yield Transition(
            f"#{number_} {source.lower()} to {target.lower()}",
            by_label[source],
            by_label[target],
            judged.status(target),
            {**kept, rule: as_num(number_, COUNT), since: as_num(0, COUNT)},
            TRACE,
            0,
        )
    for mode in table:
        longer = minimum(since + 1, since.high)
        yield Transition(f"stay {mode.label.lower()}", mode, mode, set={**kept, since: longer}, trace=TRACE, rank=1)
