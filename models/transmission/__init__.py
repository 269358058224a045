"""A position on its way from one computer to another: its interval is widened by its age (RFL-14, FVA-9).

The sender's report leaves in the cycle in which it is sent, and arrives some cycles later, or never. Meanwhile the vehicle
moves on, no faster than its highest speed, in either direction: every cycle widens the interval by that run, before arrival
and after it. One report is on its way at a time; a newer one takes its place. A revoking report (one without a position)
withdraws the last position when it arrives; while no report arrives, the last one grows older.

    NOTHING  no report, a revoking one, or one that has become too old or too wide
    HELD     a report is stored; its interval is reported, widened by its age
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace

from safeloc.config import Config, quantity
from safeloc.language.declared import Declared
from safeloc.language.expr import (
    FALSE,
    TRUE,
    Bool,
    BoolVar,
    Expr,
    Lit,
    Num,
    NumVar,
    Var,
    as_num,
    between,
    boolean,
    exact_to,
    ite,
    number,
    with_unit,
)
from safeloc.language.machine import ANY, Model, Transition, current_mode, modes
from safeloc.language.rows import together
from safeloc.language.units import COUNT, MM, MS, NM, NM_PER_MM
from safeloc.language.world import Law
from safeloc.models.vocabulary.absent import margin_if, position_if
from safeloc.models.vocabulary.vehicle_world import SPEED, speed_law, stated_interval_holds

REQUIREMENTS = ("FVA-9", "FVA-18", "RFL-14")


class TransmissionConfig(Config):
    """Limits of the link between two computers."""

    period_ms: int = quantity(100, "ms", 10, 1_000, "[S] SUBSET-041: application cycle up to 100 ms")
    max_speed_mm_s: int = quantity(44_445, "mm/s", 1, 138_889, "[D] 160 km/h")
    age_limit_ms: int = quantity(1_000, "ms", 0, 60_000, "[S] EUG 22E126: no data older than 1 s")
    margin_limit_mm: int = quantity(300_000, "mm", 1, 100_000_000, "[D] ten times the tolerable error of main line")
    position_limit_mm: int = quantity(1_000_000_000, "mm", 1_000, 10_000_000_000, "[D] 1 000 km of line")

    @property
    def age_limit_cycles(self) -> int:
        """The oldest report whose position is reported."""
        return self.age_limit_ms // self.period_ms

    @property
    def run_mm(self) -> int:
        """The farthest the vehicle gets in a cycle, rounded up."""
        return -(-self.max_speed_mm_s * self.period_ms // 1_000)


@dataclass(frozen=True, eq=False)
class Report:
    """A report: its presence, the validity of its position, the interval as it was sent, and its age in cycles."""

    there: Bool
    valid: Bool
    position: Num
    below: Num
    above: Num
    age: Num

    def older(self, config: TransmissionConfig) -> Report:
        """Return the report one cycle later; NO_REPORT if it is too old then."""
        young = self.there & (self.age + 1 <= config.age_limit_cycles)
        return choose(young, replace(self, there=young, age=self.age + 1), NO_REPORT)

    def added_error(self, config: TransmissionConfig) -> Num:
        """Return the error that its age adds to either side, mm."""
        return with_unit(self.age * config.run_mm, MM)

    def usable(self, config: TransmissionConfig) -> Bool:
        """Return whether it has a position that is narrow enough when widened by its age."""
        added_error, widest = self.added_error(config), config.margin_limit_mm
        return self.there & self.valid & (self.below + added_error <= widest) & (self.above + added_error <= widest)

    def holds(self, truth: Num, config: TransmissionConfig) -> Bool:
        """Return whether the truth lies in its interval, widened by its age, if it has a position."""
        added_error = self.added_error(config)
        low, high = self.position - self.below - added_error, self.position + self.above + added_error
        return (self.there & self.valid).implies(between(exact_to(low, NM), truth, exact_to(high, NM)))


NO_REPORT = Report(FALSE, FALSE, Lit(0, MM), Lit(0, MM), Lit(0, MM), Lit(0, COUNT))


def choose(condition: Bool, then: Report, other: Report) -> Report:
    """Return `then` where the condition holds, else `other`."""
    return Report(
        (condition & then.there) | (~condition & other.there),
        (condition & then.valid) | (~condition & other.valid),
        ite(condition, then.position, other.position),
        ite(condition, then.below, other.below),
        ite(condition, then.above, other.above),
        ite(condition, then.age, other.age),
    )


@dataclass(frozen=True, eq=False)
class Slot:
    """State variables that store a report."""

    there: BoolVar
    valid: BoolVar
    position: NumVar
    below: NumVar
    above: NumVar
    age: NumVar

    @property
    def report(self) -> Report:
        """The stored report."""
        return Report(self.there, self.valid, self.position, self.below, self.above, self.age)

    def become(self, report: Report) -> dict[Var, Expr]:
        """Return the updates that store the report."""
        return {
            self.there: report.there, self.valid: report.valid, self.position: report.position,
            self.below: report.below, self.above: report.above, self.age: report.age,
        }  # fmt: skip


class Parts:
    """The variables of the machine.

    sent, arrived    inputs: the sender sends in this cycle; what is on its way arrives in this cycle
    valid, ...       inputs: the sender's report of this cycle
    flying, held     the report on its way, and the one that arrived last
    """

    def __init__(self, config: TransmissionConfig, truth: NumVar) -> None:
        self.declared = declared = Declared()
        limit, widest, reach = config.position_limit_mm, config.margin_limit_mm, _reach_nm(config)
        self.config = config
        self.sent = declared.sensor(boolean("sent"))
        self.arrived = declared.sensor(boolean("arrived"))
        self.valid = declared.sensor(boolean("sent_valid"))
        self.position = declared.sensor(number("sent_position_mm", MM, -limit, limit))
        self.below = declared.sensor(number("sent_margin_below_mm", MM, 0, widest))
        self.above = declared.sensor(number("sent_margin_above_mm", MM, 0, widest))
        self.flying = _slot(declared, "flying", config)
        self.held = _slot(declared, "held", config)
        self.truth = declared.ghost(truth, first=ANY)
        self.next_truth = declared.choice(number("next_truth_nm", NM, -reach, reach))


def parts(config: TransmissionConfig) -> Parts:
    """Declare the variables of one link; where another machine's world moves the sender, use `Parts` with that machine's truth."""
    return Parts(config, number("truth_nm", NM, -_reach_nm(config), _reach_nm(config)))


def _reach_nm(config: TransmissionConfig) -> int:
    return (config.position_limit_mm + 2 * config.margin_limit_mm) * NM_PER_MM


class Transmission(Model[Parts]):
    """The machine with its variables: a class of its own, by which the localizer tells its machines apart."""


def _slot(declared: Declared, name: str, config: TransmissionConfig) -> Slot:
    limit, widest, ages = config.position_limit_mm, config.margin_limit_mm, config.age_limit_cycles
    return Slot(
        declared.state(boolean(f"{name}_there"), first=False),
        declared.state(boolean(f"{name}_valid"), first=False),
        declared.state(number(f"{name}_position_mm", MM, -limit, limit), first=0),
        declared.state(number(f"{name}_margin_below_mm", MM, 0, widest), first=0),
        declared.state(number(f"{name}_margin_above_mm", MM, 0, widest), first=0),
        declared.state(number(f"{name}_age_cycles", COUNT, 0, ages), first=0),
    )


def build(own: Parts, name: str = "transmission") -> Transmission:
    """Build the machine over the given variables."""
    table = modes("NOTHING", "HELD")
    current = current_mode(table)
    held = current.eq(table[1])
    added_error = own.held.report.added_error(own.config)
    made = own.declared.machine(
        name=name,
        modes=table,
        outputs={
            "valid": held,
            "position_mm": position_if(held, own.held.position),
            "margin_below_mm": margin_if(held, own.held.below + added_error),
            "margin_above_mm": margin_if(held, own.held.above + added_error),
            "age_ms": ite(held, with_unit(own.held.age * own.config.period_ms, MS), 0),
        },
        transitions=list(_table(own, table)),
        world=own.declared.world(
            moves={own.truth: own.next_truth},
            clauses={
                "a position that is sent holds the truth": Law(
                    _sent_truly(own),
                    "An interval that is sent as valid holds the true position of the cycle in which it is sent.",
                    source="[D] containment of the sender, whose own proof it is",
                    owner="supplier",
                    check="replayed recordings with a known true position",
                ),
                SPEED: speed_law(own.next_truth - own.truth, own.config.max_speed_mm_s * own.config.period_ms * 1_000),
            },
        ),
        lemmas=_lemmas(own, held),
        doc=(
            "Brings a position from one computer to another and widens its interval by its age. Assumed: a position that is sent "
            "holds the truth when it is sent (the sender's own proof discharges this), and the vehicle moves no faster than its "
            "highest speed. Nothing is assumed of arrival: a report may come late, never, or together with others."
        ),
    )
    return Transmission(made, own)


# ------------------------------------------------------------------ the transition table


def _table(own: Parts, table: tuple[Lit, ...]) -> Iterator[Transition]:
    nothing, held = table
    config, flying = own.config, own.flying.report.older(own.config)
    lands, kept = own.arrived & flying.there, own.held.report.older(own.config)
    sent = Report(TRUE, own.valid, own.position, own.below, own.above, as_num(0, COUNT))
    way = own.flying.become(choose(own.sent, sent, choose(lands, NO_REPORT, flying)))
    taken, gone = together(way, own.held.become(flying)), together(way, own.held.become(NO_REPORT))
    aged = together(way, own.held.become(kept))
    yield Transition("report arrives", table, held, lands & flying.usable(config), taken, REQUIREMENTS, 0)
    yield Transition("report revokes", table, nothing, lands & ~flying.valid, gone, REQUIREMENTS, 1)
    yield Transition("report arrives too wide", table, nothing, lands, gone, REQUIREMENTS, 2)
    yield Transition("report has become too old", held, nothing, ~kept.there, gone, REQUIREMENTS, 3)
    yield Transition("report has become too wide", held, nothing, ~kept.usable(config), gone, REQUIREMENTS, 4)
    yield Transition("report grows older", held, held, TRUE, aged, REQUIREMENTS, 5)
    yield Transition("no report", nothing, nothing, TRUE, way, REQUIREMENTS, 5)


# ------------------------------------------------------------------ the environment, and what helps to prove


def _sent_truly(own: Parts) -> Bool:
    """Return whether a valid interval that is sent contains the true position of its cycle."""
    return (own.sent & own.valid).implies(stated_interval_holds(own.position, own.below, own.above, own.next_truth))


def _lemmas(own: Parts, held: Bool) -> dict[str, Bool]:
    flying, kept = own.flying.report, own.held.report
    return {
        "a report on its way holds the truth": flying.holds(own.truth, own.config),
        "a report that arrived holds the truth": kept.holds(own.truth, own.config),
        "a report that is passed on is stored and usable": held.implies(kept.usable(own.config)),
        "every stored report is passed on": held | ~kept.there,
    }
