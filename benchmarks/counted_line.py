"""A line of counted sections, of any length: the family of machines whose size `bench_growth` makes grow.

    UNSURE    of a section, or of more, the number of axles is not known within the tolerance
    OCCUPIED  all are known, and some section may hold an axle
    FREE      every section holds none

Between two counting heads lies a section; neighbours share a head. A head tells how many axles ran over it in a step, or
nothing, and then both its sections are known less well; a section that is swept holds none. Of each section the machine
keeps the least and the most number of axles, and what counts is the line as a whole.

What grows with the sections: state variables (three each: least, most, and the true number), inputs, clauses of the assumption
and lemmas (one each), and the width of each guard, update and property, which speak of all sections. What stays: modes,
transitions and properties. So what is measured is the cost of a property in a larger machine, not of more properties.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from functools import reduce
from operator import add
from typing import Protocol

from safeloc.language.expr import (
    TRUE,
    Bool,
    BoolVar,
    Expr,
    Lit,
    Num,
    NumVar,
    Optional,
    Var,
    all_of,
    any_of,
    between,
    boolean,
    ite,
    maximum,
    minimum,
    number,
    optional,
)
from safeloc.language.machine import ANY, Machine, Transition, modes
from safeloc.language.nodes import Value
from safeloc.language.spec import Property, always, earlier_bool, reachable
from safeloc.language.system import lower
from safeloc.language.units import COUNT
from safeloc.language.world import World
from safeloc.target import Target

MOST_AXLES = 400
"""Axles that a section has room for."""
MOST_IN_STEP = 4
"""Axles that run over a head in one step, in either direction."""
TOLERANCE = 24
"""Axles by which the number in a section may be uncertain, before the line is."""
KEPT_FOR_SECTION = 3
LAW = "a head that tells, tells what ran over it; no axle comes or goes elsewhere; a swept section holds none"

UNSURE, OCCUPIED, FREE = modes("UNSURE", "OCCUPIED", "FREE")


class Heard(Protocol):
    """What a section hears of one of its ends: between which numbers of axles ran in there, and the true number."""

    @property
    def least(self) -> Num: ...

    @property
    def most(self) -> Num: ...

    @property
    def true(self) -> NumVar: ...


@dataclass(frozen=True, eq=False)
class Head:
    """What a counting head tells, and what truly runs over it, positive into the section behind it."""

    told: Optional
    true: NumVar

    @property
    def least(self) -> Num:
        """The least number that may have run over it."""
        return ite(self.told.present, self.told.value, -MOST_IN_STEP)

    @property
    def most(self) -> Num:
        """The largest number that may have run over it."""
        return ite(self.told.present, self.told.value, MOST_IN_STEP)


@dataclass(frozen=True, eq=False)
class Section:
    """What is known of the axles between two heads, and how many there are."""

    entry: Heard
    exit: Heard
    swept: BoolVar
    least: NumVar
    most: NumVar
    true: NumVar
    next_true: NumVar

    @property
    def next_least(self) -> Num:
        """The least number after the step."""
        return self._reckoned(self.least + self.entry.least - self.exit.most)

    @property
    def next_most(self) -> Num:
        """The largest number after the step."""
        return self._reckoned(self.most + self.entry.most - self.exit.least)

    def _reckoned(self, axles: Num) -> Num:
        return ite(self.swept, 0, maximum(minimum(axles, MOST_AXLES), 0))

    @property
    def law(self) -> Bool:
        """Axles come and go over the heads only; a swept section holds none."""
        moved = self.next_true.eq(self.true + self.entry.true - self.exit.true)
        return moved & self.swept.implies(self.next_true.eq(0))

    @property
    def next_wide(self) -> Bool:
        """After the step the number is not known within the tolerance."""
        return self.next_most - self.next_least > TOLERANCE

    @property
    def known(self) -> Bool:
        """The true number lies within what is kept."""
        return between(self.least, self.true, self.most)


def sections(variables: int) -> int:
    """How many sections make a machine of so many state variables, as near as can be."""
    return max(1, round((variables - 1) / KEPT_FOR_SECTION))


def line_target(variables: int) -> Target:
    """The machine of about so many state variables, with what is to be shown of it."""
    line = _line(sections(variables))
    machine = _machine(line)
    return Target(machine.name, (machine,), lower(machine), tuple(_properties(machine, line)))


def _line(count: int) -> list[Section]:
    heads = [
        Head(
            optional(f"head_{place}", COUNT, -MOST_IN_STEP, MOST_IN_STEP),
            number(f"over_{place}", COUNT, -MOST_IN_STEP, MOST_IN_STEP),
        )
        for place in range(count + 1)
    ]
    return [_section(place, heads[place], heads[place + 1]) for place in range(count)]


def _section(place: int, entry: Head, exit_: Head) -> Section:
    def axles(name: str) -> NumVar:
        return number(f"{name}_{place}", COUNT, 0, MOST_AXLES)

    names = ("least", "most", "true", "next_true")
    return Section(entry, exit_, boolean(f"swept_{place}"), *map(axles, names))


def _machine(line: Sequence[Section]) -> Machine:
    return Machine(
        name="counted_line",
        modes=(UNSURE, OCCUPIED, FREE),
        inputs=[*(head.told for head in _heads(line)), *(one.swept for one in line)],
        state={**{one.least: 0 for one in line}, **{one.most: MOST_AXLES for one in line}},
        outputs={"least_axles": _sum(line, lambda one: one.least), "most_axles": _sum(line, lambda one: one.most)},
        transitions=list(_table(line)),
        world=World(
            ghosts={one.true: ANY for one in line},
            choices=[*(head.true for head in _heads(line)), *(one.next_true for one in line)],
            moves={one.true: one.next_true for one in line},
            clauses={"assumption": all_of([*(_truly(head) for head in _heads(line)), *(one.law for one in line)])},
            reads_machine="the test asks it",
        ),
        lemmas={f"section {place} is known": one.known for place, one in enumerate(line)},
    )


def _heads(line: Sequence[Section]) -> list[Head]:
    return [*(one.entry for one in line), line[-1].exit]


def _truly(head: Head) -> Bool:
    return head.told.present.implies(head.told.value.eq(head.true))


def _sum(line: Sequence[Section], what: Callable[[Section], Num]) -> Num:
    return reduce(add, map(what, line))


def _table(line: Sequence[Section]) -> Iterator[Transition]:
    reckoned: dict[Var, Expr | Value] = {
        **{one.least: one.next_least for one in line},
        **{one.most: one.next_most for one in line},
    }
    wide = any_of(one.next_wide for one in line)
    empty = all_of(one.next_most.eq(0) for one in line)

    def row(name: str, source: Lit | tuple[Lit, ...], target: Lit, when: Bool, rank: int) -> Transition:
        return Transition(name, source, target, when, reckoned, rank=rank)

    yield row("still unsure", UNSURE, UNSURE, wide, 0)
    yield row("a section is lost", (OCCUPIED, FREE), UNSURE, wide, 0)
    yield row("every section is empty", (UNSURE, OCCUPIED), FREE, ~wide & empty, 0)
    yield row("stays free", FREE, FREE, ~wide & empty, 0)
    yield row("known again", UNSURE, OCCUPIED, TRUE, 1)
    yield row("an axle on the line", FREE, OCCUPIED, TRUE, 1)
    yield row("counts on", OCCUPIED, OCCUPIED, TRUE, 1)


def _properties(machine: Machine, line: Sequence[Section]) -> Iterator[Property]:
    """A fixed number of properties, each of all sections."""
    unsure, free = machine.mode.eq(UNSURE), machine.mode.eq(FREE)
    yield always(
        "free holds no axle",
        free.implies(all_of(one.true.eq(0) for one in line)),
        statement="a line that is said to be free holds no axle",
        assumption=LAW,
    )
    yield always(
        "unsure in the same step",
        any_of(one.most - one.least > TOLERANCE for one in line).implies(unsure),
        statement="a section that is known too badly makes the line unsure in the same step",
        unconditional=True,
    )
    silent = all_of(~head.told.present for head in _heads(line)) & all_of(~one.swept for one in line)
    yield always(
        "no resurrection",
        (earlier_bool(unsure) & ~unsure).implies(~silent),
        statement="a line that nothing is heard of does not become sure",
        unconditional=True,
    )
    yield reachable("free again", free & earlier_bool(machine.mode.eq(OCCUPIED)), statement="an occupied line is freed")
