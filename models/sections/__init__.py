"""A virtual section: clear or not, from the intervals of the trains of its line area (FVA-9, FVA-18).

Sections are cut freely along the line. A section is FREE only on positive evidence: no train's interval reaches it,
and no vehicle that was never counted can be in it. Every other state means occupied for the interlocking.

    UNKNOWN     vehicles may be here, and no recent report tells which (also the start)
    FREE        no vehicle is here
    OCCUPIED    only trains with recent reports that are known to be whole
    AMBIGUOUS   a train with recent reports, and perhaps other vehicles, or a part that it lost

Beside the state a section reports the rule that led to it, its evidence, the age of the oldest report in the evidence, and
its trust. The transitions carry the numbers of the published rules for virtual sub-sections (figures, section 7).
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from pydantic import model_validator

from safeloc.config import Config, derived, quantity
from safeloc.language.composition import Composition, compose
from safeloc.language.declared import Declared
from safeloc.language.expr import (
    TRUE,
    BoolVar,
    Expr,
    Lit,
    NumVar,
    Var,
    boolean,
    choice,
    enumeration,
    minimum,
    number,
)
from safeloc.language.machine import ANY, Machine, Transition, current_mode, modes
from safeloc.language.rows import Updates, together
from safeloc.language.units import COUNT, MM
from safeloc.models.area import Area, AreaConfig
from safeloc.models.area import build as build_area
from safeloc.models.area import parts as area_parts
from safeloc.models.area.inner import Inner, covered
from safeloc.models.area.judgement import EVIDENCE, NO_TRUST, NOTHING_YET, TRUST, Judgement, TrainHere
from safeloc.models.area.separation import Following, headway_ms, separation_mm

REQUIREMENTS = ("FVA-9", "FVA-18")
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
    """Line area, timers, and the figures of the achieved separation."""

    area: AreaConfig = AreaConfig()
    sections: int = quantity(1, "count", 1, 64, "[D] sections of one composition; each is independent of the others")
    mute_ms: int = quantity(5_000, "ms", 0, 3_600_000, "[M] mute timer: without a trusted report")
    integrity_wait_ms: int = quantity(
        30_000, "ms", 0, 3_600_000, "[M] wait-integrity timer: without confirmed integrity"
    )
    following: Following = Following()

    @model_validator(mode="after")
    def _timers_end(self) -> SectionsConfig:
        longest = max(self.mute_limit_cycles, self.integrity_limit_cycles)
        if longest >= self.area.count_limit:
            raise ValueError(
                f"the timers run for {longest} cycles, and area.count_limit counts waiting times up to "
                f"{self.area.count_limit} only: they would never end. Raise count_limit or shorten the timers."
            )
        return self

    @property
    def mute_limit_cycles(self) -> int:
        """Whole cycles of the mute timer."""
        return self.mute_ms // self.area.period_ms

    @property
    def integrity_limit_cycles(self) -> int:
        """Whole cycles of the wait-integrity timer."""
        return self.integrity_wait_ms // self.area.period_ms

    @derived("mm", "[D] achieved: front of a train to the rear of the one ahead (area/separation.py)")
    def separation_mm(self) -> int:
        """Achieved separation of two trains, mm."""
        return separation_mm(self.area, self.following)

    @derived("mm", "[D] the same with sections of no length: moving block with this area and these trains")
    def moving_block_separation_mm(self) -> int:
        """Separation in the limit of small sections, mm."""
        return separation_mm(self.area, self.following.model_copy(update={"section_mm": 0}))

    @derived("ms", "[D] from one train's front to the next one's at one place")
    def headway_ms(self) -> int:
        """Achieved headway, ms."""
        return headway_ms(self.area, self.following)


@dataclass(frozen=True, eq=False)
class Section:
    """One section's machine and variables: bounds (any two places in the area), and inputs from the area.

    followers  how far in vehicles can be that came in uncounted, from the low end and from the high end; empty if all are counted
    inner      detection sections inside the area: places and whether they are clear
    """

    config: SectionsConfig
    machine: Machine
    start: NumVar
    end: NumVar
    trains: tuple[TrainHere, ...]
    unswept: BoolVar
    loose_low: NumVar
    loose_high: NumVar
    followers: tuple[NumVar, ...]
    inner: tuple[Inner, ...]


@dataclass(frozen=True, eq=False)
class Sections:
    """A line area with its sections in one step."""

    area: Area
    sections: tuple[Section, ...]
    composition: Composition


def compose_machines(config: SectionsConfig | None = None) -> Sections:
    """Return area and sections: each section reads the trains as they are after the area's step (FVA-9)."""
    config = config or SectionsConfig()
    area = build_area(area_parts(config.area))
    return joined(area, tuple(section(config, f"section_{n}") for n in range(1, config.sections + 1)))


def joined(area: Area, sections: tuple[Section, ...]) -> Sections:
    """Return the given machines, wired."""
    wires: dict[Var, Expr] = {}
    for one in sections:
        wires |= section_wires(area, one)
    composition = compose("sections", [area.machine, *(one.machine for one in sections)], wires)
    return Sections(area, sections, composition)


def section_wires(area: Area, one: Section) -> dict[Var, Expr]:
    """Return the wires from the area to a section."""
    own = area.own
    wires: dict[Var, Expr] = {
        one.unswept: area.machine.mode.eq(area.machine.modes[0]),
        one.loose_low: own.loose_low,
        one.loose_high: own.loose_high,
    }
    if own.followers is not None:
        wires |= dict(zip(one.followers, (side.bound for side in own.followers.sides), strict=True))
    for here, inner in zip(one.inner, own.inner, strict=True):
        wires |= {here.start: inner.start, here.end: inner.end, here.clear: inner.clear}
    for reported, train in zip(one.trains, own.slots, strict=True):
        wires |= {reported.present: train.present, reported.low: train.low, reported.high: train.high}
        wires |= {reported.silent: train.silent, reported.unconfirmed: train.unconfirmed}
    return wires


@dataclass(frozen=True, eq=False)
class _Reported:
    """State that a section reports beside its mode: the rule that led to it, its duration, and the evidence for it."""

    rule: NumVar
    since: NumVar
    trains_here: NumVar
    first_train_here: NumVar
    trains_followed_here: NumVar
    evidence: NumVar
    age: NumVar
    trust: NumVar


def section(config: SectionsConfig, name: str) -> Section:
    """Return one section with fresh variables."""
    declared, limit, count = Declared(), config.area.limit_mm, config.area.count_limit
    trains = tuple(_train(declared, n, limit, count) for n in range(1, config.area.trains + 1))
    unswept = declared.sensor(boolean("area_unswept"))
    loose_low, loose_high = (
        declared.sensor(number(f"area_loose_{side}_mm", MM, -limit, limit)) for side in ("low", "high")
    )
    counted = config.area.borders == "counted"
    sides = () if counted else ("low", "high")
    followers = tuple(declared.sensor(number(f"area_followers_{side}_mm", MM, -limit, limit)) for side in sides)
    inner = tuple(_inner(declared, n, limit) for n in range(1, config.area.inner_detection + 1))
    start = declared.state(number("from_mm", MM, -limit, limit), first=ANY)
    end = declared.state(number("to_mm", MM, -limit, limit), first=ANY)
    reported = _reported(declared, config)
    clear = covered(start, end, inner) if inner else None
    loose = unswept & (loose_low <= end) & (loose_high >= start)
    if followers:
        from_low, from_high = followers
        loose = loose | (from_low >= start) | (from_high <= end)
    if clear is not None:
        loose = loose & ~clear
    judgement = Judgement(config.mute_limit_cycles, config.integrity_limit_cycles, start, end, trains, loose, clear)
    table = modes("UNKNOWN", "FREE", "OCCUPIED", "AMBIGUOUS")
    machine = declared.machine(
        name=name,
        modes=table,
        outputs={
            "from_mm": start,
            "to_mm": end,
            "clear": current_mode(table).eq(table[1]),
            "trains": reported.trains_here,
            "first_train": reported.first_train_here,
            "trains_followed": reported.trains_followed_here,
            "rule": reported.rule,
            "since_cycles": reported.since,
            "evidence": reported.evidence,
            "evidence_age_cycles": reported.age,
            "trust": reported.trust,
        },
        transitions=list(_table(judgement, table, reported)),
        initially=start < end,
        lemmas={"bounds in order": start < end},
        doc="One virtual section: clear only if no train of the area, and no vehicle that was never counted, can be "
        "in it.",
    )
    return Section(config, machine, start, end, trains, unswept, loose_low, loose_high, followers, inner)


def _reported(declared: Declared, config: SectionsConfig) -> _Reported:
    count, trains = config.area.count_limit, config.area.trains
    return _Reported(
        rule=declared.state(number("rule", COUNT, 0, 12), first=0),
        since=declared.state(number("since_cycles", COUNT, 0, count), first=0),
        trains_here=declared.state(number("trains_here", COUNT, 0, trains), first=0),
        first_train_here=declared.state(number("first_train_here", COUNT, 0, trains), first=0),
        trains_followed_here=declared.state(number("trains_followed_here", COUNT, 0, trains), first=0),
        evidence=declared.state(choice("evidence", enumeration(EVIDENCE)), first=NOTHING_YET),
        age=declared.state(number("evidence_age_cycles", COUNT, 0, count), first=0),
        trust=declared.state(choice("trust", enumeration(TRUST)), first=NO_TRUST),
    )


def _inner(declared: Declared, number_: int, limit: int) -> Inner:
    name = f"area_inner_{number_}"
    return Inner(
        declared.sensor(number(f"{name}_from_mm", MM, -limit, limit)),
        declared.sensor(number(f"{name}_to_mm", MM, -limit, limit)),
        declared.sensor(boolean(f"{name}_clear")),
    )


def _train(declared: Declared, number_: int, limit: int, count: int) -> TrainHere:
    name = f"area_train_{number_}"
    return TrainHere(
        declared.sensor(boolean(f"{name}_present")),
        declared.sensor(number(f"{name}_low_mm", MM, -limit, limit)),
        declared.sensor(number(f"{name}_high_mm", MM, -limit, limit)),
        declared.sensor(number(f"{name}_silent_cycles", COUNT, 0, count)),
        declared.sensor(number(f"{name}_unconfirmed_cycles", COUNT, 0, count)),
    )


def _table(judgement: Judgement, table: tuple[Lit, ...], reported: _Reported) -> Iterator[Transition]:
    evidence: Updates = {
        reported.trains_here: judgement.count,
        reported.first_train_here: judgement.first,
        reported.trains_followed_here: judgement.followed_count,
        reported.evidence: judgement.evidence,
        reported.age: judgement.age,
        reported.trust: judgement.trust,
    }
    longer: Updates = {reported.since: minimum(reported.since + 1, reported.since.high)}
    by_label = {mode.label: mode for mode in table}
    for (source, target), rule in sorted(RULES.items(), key=lambda item: item[1]):
        name, before, after = f"#{rule} {source.lower()} to {target.lower()}", by_label[source], by_label[target]
        changed: Updates = {reported.rule: rule, reported.since: 0}
        yield Transition(name, before, after, judgement.status(target), together(evidence, changed), REQUIREMENTS, 0)
    for mode in table:
        yield Transition(f"stay {mode.label.lower()}", mode, mode, TRUE, together(evidence, longer), REQUIREMENTS, 1)
