"""A line of counted sections as a composition, one small machine a section: the second family that `bench_growth` makes grow.

    head_0   section_1   head_1   section_2   head_2   ...

A head tells how many axles ran over it in a step, or is silent; neighbours share a head. Each section keeps the least and the
most number of axles in it, from what its two heads tell, and is UNSURE, OCCUPIED or FREE by itself. All heads are one
declaration, and all sections another.

What grows with the sections: machines (a head and a section each), wires, lemmas, contracts (what the heads tell a section
holds what ran over them: discharged, so proved of the two heads) and properties (one of each section, inherited from its machine).
What stays: the size of each machine, and the four properties of the whole line, which speak of all sections.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import NamedTuple

from benchmarks.counted_line import LAW, MOST_AXLES, MOST_IN_STEP, TOLERANCE, Section
from safeloc.language.composition import Clause, Composition, compose
from safeloc.language.expr import (
    TRUE,
    Bool,
    Expr,
    Lit,
    NumVar,
    Optional,
    Var,
    all_of,
    any_of,
    between,
    boolean,
    ite,
    number,
    optional,
)
from safeloc.language.machine import ANY, Machine, Transition, current_mode, modes
from safeloc.language.nodes import Value
from safeloc.language.spec import Property, always, earlier_bool, reachable
from safeloc.language.units import COUNT
from safeloc.language.world import World
from safeloc.target import Target

KEPT_FOR_HEAD, KEPT_FOR_SECTION = 3, 4
TOLD = "what the heads tell holds what ran over them"


@dataclass(frozen=True, eq=False)
class _Head:
    """A counting head: its machine, what it hears in a step, and what truly ran over it in the step before."""

    machine: Machine
    told: Optional
    over: NumVar


class _Heard(NamedTuple):
    """What a section hears of one of its heads, and what truly runs over it: inputs, which are wired."""

    least: NumVar
    most: NumVar
    true: NumVar

    def wires(self, head: _Head) -> dict[Var, Expr]:
        """The wires from the head."""
        machine = head.machine
        return {self.least: machine.output("least"), self.most: machine.output("most"), self.true: head.over}


@dataclass(frozen=True, eq=False)
class _Counted:
    """A section: its machine and its variables."""

    machine: Machine
    own: Section
    entry: _Heard
    exit: _Heard

    def is_(self, label: str) -> Bool:
        """The section is in the mode of that name."""
        return self.machine.mode.eq(next(mode for mode in self.machine.modes if mode.label == label))

    @property
    def holds_none(self) -> Property:
        """The property of the machine by itself."""
        return always(
            "free holds no axle",
            self.is_("FREE").implies(self.own.true.eq(0)),
            statement="a section that is said to be free holds no axle",
            assumption=LAW,
        )


def machines_of(variables: int) -> int:
    """How many sections make a composition of so many state variables, as near as can be."""
    return max(1, round((variables - KEPT_FOR_HEAD) / (KEPT_FOR_HEAD + KEPT_FOR_SECTION)))


def composed_target(variables: int) -> Target:
    """The composition of about so many state variables, with what is to be shown of it."""
    count = machines_of(variables)
    heads = [_head(f"head_{place}") for place in range(count + 1)]
    line = [_counted(f"section_{place}") for place in range(1, count + 1)]
    composition = _composed(heads, line)
    machines = composition.system.machines
    properties = tuple(_properties(composition, heads, line))
    return Target("composed_line", machines, composition.system, properties)


def _composed(heads: Sequence[_Head], line: Sequence[_Counted]) -> Composition:
    machines, wires = [heads[0].machine], dict[Var, Expr]()
    for before, section, behind in zip(heads, line, heads[1:], strict=False):
        machines += [behind.machine, section.machine]
        wires |= {**section.entry.wires(before), **section.exit.wires(behind)}
    discharged = [Clause(section.machine, TOLD) for section in line]
    return compose("composed_line", machines, wires, discharge=discharged)


# ------------------------------------------------------------------ a head


def _head(name: str) -> _Head:
    silent, telling = table = modes("SILENT", "TELLING")
    told = optional("told", COUNT, -MOST_IN_STEP, MOST_IN_STEP)
    kept, over, next_over = (
        number(one, COUNT, -MOST_IN_STEP, MOST_IN_STEP) for one in ("last_told", "over", "next_over")
    )
    heard: Mapping[Var, Expr | Value] = {kept: told.value}
    tells = current_mode(table).eq(telling)
    machine = Machine(
        name=name,
        modes=table,
        inputs=[told],
        state={kept: 0},
        outputs={"least": ite(tells, kept, -MOST_IN_STEP), "most": ite(tells, kept, MOST_IN_STEP)},
        transitions=[
            Transition("tells again", silent, telling, told.present, heard),
            Transition("tells", telling, telling, told.present, heard),
            Transition("falls silent", telling, silent, ~told.present, {}),
        ],
        world=World(
            ghosts={over: 0},
            choices=[next_over],
            moves={over: next_over},
            clauses={"a head that tells is right": told.present.implies(told.value.eq(next_over))},
        ),
        lemmas={"what is told is true": tells.implies(kept.eq(over))},
    )
    return _Head(machine, told, over)


# ------------------------------------------------------------------ a section


def _counted(name: str) -> _Counted:
    entry, exit_ = _heard("entry"), _heard("exit")
    axles = (number(one, COUNT, 0, MOST_AXLES) for one in ("least", "most", "true", "next_true"))
    own = Section(entry, exit_, boolean("swept"), *axles)
    told = all_of(between(one.least, one.true, one.most) for one in (entry, exit_))
    table = modes("UNSURE", "OCCUPIED", "FREE")
    machine = Machine(
        name=name,
        modes=table,
        inputs=[entry.least, entry.most, exit_.least, exit_.most, own.swept],
        state={own.least: 0, own.most: MOST_AXLES},
        outputs={"least_axles": own.least, "most_axles": own.most},
        transitions=list(_table(own, *table)),
        world=World(
            ghosts={own.true: ANY},
            choices=[entry.true, exit_.true, own.next_true],
            moves={own.true: own.next_true},
            clauses={TOLD: told, "axles come and go over the heads": own.law},
        ),
        lemmas={"the number is known": own.known},
    )
    return _Counted(machine, own, entry, exit_)


def _heard(end: str) -> _Heard:
    least, most, true = (
        number(f"{end}_{one}", COUNT, -MOST_IN_STEP, MOST_IN_STEP) for one in ("least", "most", "true")
    )
    return _Heard(least, most, true)


def _table(own: Section, unsure: Lit, occupied: Lit, free: Lit) -> Iterator[Transition]:
    reckoned: dict[Var, Expr | Value] = {own.least: own.next_least, own.most: own.next_most}
    empty = own.next_most.eq(0)

    def row(name: str, source: Lit | tuple[Lit, ...], target: Lit, when: Bool, rank: int) -> Transition:
        return Transition(name, source, target, when, reckoned, rank=rank)

    yield row("still unsure", unsure, unsure, own.next_wide, 0)
    yield row("lost", (occupied, free), unsure, own.next_wide, 0)
    yield row("is empty", (unsure, occupied), free, ~own.next_wide & empty, 0)
    yield row("stays empty", free, free, ~own.next_wide & empty, 0)
    yield row("known again", unsure, occupied, TRUE, 1)
    yield row("an axle comes", free, occupied, TRUE, 1)
    yield row("counts on", occupied, occupied, TRUE, 1)


# ------------------------------------------------------------------ the line


def _properties(composition: Composition, heads: Sequence[_Head], line: Sequence[_Counted]) -> Iterator[Property]:
    """A property of each section, kept by its machine, and a fixed number of properties of the whole line."""
    for one in line:
        yield composition.inherited(one.machine, one.holds_none)

    def of(one: _Counted, term: Bool) -> Bool:
        return composition.of(one.machine).bool(term)

    unsure = any_of(of(one, one.is_("UNSURE")) for one in line)
    free = all_of(of(one, one.is_("FREE")) for one in line)
    yield always(
        "free line holds no axle",
        free.implies(all_of(of(one, one.own.true.eq(0)) for one in line)),
        statement="a line of which every section is said to be free holds no axle",
        assumption=LAW,
    )
    yield always(
        "unsure in the same step",
        any_of(of(one, one.own.most - one.own.least > TOLERANCE) for one in line).implies(unsure),
        statement="a section that is known too badly makes the line unsure in the same step",
        unconditional=True,
    )
    silent = all_of(~composition.of(head.machine).bool(head.told.present) for head in heads)
    unswept = all_of(~of(one, one.own.swept) for one in line)
    yield always(
        "no resurrection",
        (earlier_bool(unsure) & ~unsure).implies(~(silent & unswept)),
        statement="a line that nothing is heard of does not become sure",
        unconditional=True,
    )
    yield reachable(
        "free again",
        free & earlier_bool(any_of(of(one, one.is_("OCCUPIED")) for one in line)),
        statement="an occupied line is freed",
    )
