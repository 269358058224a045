"""The inputs that each cycle of a tube allows, as nodes: variables with bounds, and conditions on them.

It follows the definition of the tube (docs/around.md) and not the terms by which provers run it: a message of a channel has its
number as a variable, and each input of it is a variable that the number ties to what was sent.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field

from safeloc.checker.around.folding import Folding
from safeloc.checker.around.question import Channel, Given, bounds_of
from safeloc.checker.dag import BOOL, INT
from safeloc.checker.terms import Translation
from safeloc.language.expr import NumVar, Optional, Var
from safeloc.language.system import TransitionSystem, canonical

Bounds = tuple[int, int]


@dataclass(frozen=True)
class Counter:
    """A variable of a channel: how many of its messages were taken so far, or lost; it begins at 0."""

    name: str
    high: int


@dataclass
class Cycle:
    """The inputs of a cycle by their node, the conditions on them, and the counters after it by name."""

    inputs: dict[int, int] = field(default_factory=dict)
    conditions: list[int] = field(default_factory=list)
    counters: dict[str, int] = field(default_factory=dict)


@dataclass(frozen=True, eq=False)
class Tube:
    """All streams near a given one, for one system: inputs that it does not have are left out."""

    system: TransitionSystem
    given: Given
    widths: Mapping[str, int]
    channels: Sequence[Channel]
    write: Translation

    @property
    def counters(self) -> list[Counter]:
        """The variables of all channels."""
        return [counter for lane in self._lanes() for counter in lane.counters]

    def cycle(self, number: int, folding: Folding, counters: Mapping[str, int]) -> Cycle:
        """Return what the tube allows in a cycle, from the values of the counters before it."""
        made = Cycle()
        lanes = self._lanes()
        on_lanes = {var for lane in lanes for var in lane.members}
        owner: dict[Var, Optional] = {option.value: option for option in self.system.optionals}
        flags = {option.present for option in self.system.optionals}
        for var in self.system.inputs:
            if var not in flags and var not in on_lanes:
                self._alone(made, folding, var, owner.get(var), number)
        for lane in lanes:
            lane.add(made, folding, number, counters)
        return made

    def ghosts_near(self, cycle: int, state: Mapping[int, int], folding: Folding) -> list[int]:
        """Return the conditions that the ghosts named in the deviations are near the recorded ones after a cycle."""
        found = list[int]()
        for var in self.system.state:
            if var in self.system.ghosts and var.name in self.widths and self.given.ghosts:
                at, width = int(self.given.ghosts[cycle][var]), self.widths[var.name]
                found += between(folding, state[self.write(var)], (at - width, at + width))
        return found

    def _lanes(self) -> list[_Lane]:
        known = {var.name: var for var in self.system.inputs}
        return [
            _Lane(self, one, [known[name] for name in one.names]) for one in self.channels if one.drops or one.delay
        ]

    def _alone(self, made: Cycle, folding: Folding, var: Var, option: Optional | None, number: int) -> None:
        node, name = self.write(var), f"{var.name}@{number}"
        if var in self.system.ghosts:
            bounds = bounds_of(var)
            if isinstance(var, NumVar) and var.name in self.widths:
                bounds = near(var, int(self.given.choices[number - 1][var]), self.widths[var.name])
            made.inputs[node] = free(folding, name, bounds)
            return
        row = self.given.rows[number - 1]
        if option is not None:
            made.inputs[self.write(option.present)] = folding.dag.truth[bool(row[option.present])]
        if not isinstance(var, NumVar):
            made.inputs[node] = folding.dag.truth[bool(row[var])]
        elif option is not None and not row[option.present]:
            made.inputs[node] = folding.number(canonical(var))
        else:
            made.inputs[node] = free(folding, name, near(var, int(row[var]), self.widths.get(var.name, 0)))


@dataclass(frozen=True, eq=False)
class _Lane:
    """The messages of one channel."""

    tube: Tube
    channel: Channel
    members: Sequence[Var]

    @property
    def _options(self) -> dict[Var, Optional]:
        members = set(self.members)
        return {option.value: option for option in self.tube.system.optionals if option.value in members}

    @property
    def _sent(self) -> list[int]:
        """The cycles in which a message was sent; an input that is never absent is sent in every cycle."""
        options = self._options.values()
        return [
            number
            for number, row in enumerate(self.tube.given.rows, 1)
            if not options or any(row[option.present] for option in options)
        ]

    @property
    def counters(self) -> list[Counter]:
        """The counters of this channel."""
        name = f"tube.{'+'.join(self.channel.names)}"
        taken = Counter(f"{name}.taken", len(self._sent))
        return [taken, Counter(f"{name}.lost", self.channel.drops)] if self._options else [taken]

    def add(self, made: Cycle, folding: Folding, number: int, before: Mapping[str, int]) -> None:
        """Add the inputs of the channel in a cycle: `last` is the number of the last message that was taken or lost."""
        sent, delay = self._sent, self.channel.delay
        due, late = (sum(at <= limit for at in sent) for limit in (number, number - delay))
        taken, *lost = self.counters
        least = late if self._options else max(1, late)
        last = free(folding, f"{taken.name}@{number}", (least, due))
        made.counters[taken.name] = last
        made.conditions.append(folding.make("<=", [before[taken.name], last]))
        if not lost:
            self._read_late(made, folding, number, (last, range(least, due + 1)))
            return
        comes = folding.variable(f"{taken.name} comes@{number}", BOOL, None)
        one = folding.make("ite", [comes, folding.number(1), folding.number(0)])
        passed = folding.make("-", [folding.make("-", [last, before[taken.name]]), one])
        gone = folding.make("+", [before[lost[0].name], passed])
        made.counters[lost[0].name] = gone
        made.conditions.append(folding.make("<=", [folding.number(0), passed]))
        made.conditions.append(folding.make("<=", [gone, folding.number(self.channel.drops)]))
        possible = [which for which, at in enumerate(sent, 1) if number - delay <= at <= number]
        made.conditions.append(folding.make("or", [folding.make("not", [comes]), *self._is(folding, last, possible)]))
        for var, option in self._options.items():
            self._member(made, folding, number, (var, option), (comes, last, possible))

    def _is(self, folding: Folding, last: int, which: Sequence[int]) -> list[int]:
        return [folding.make("=", [last, folding.number(one)]) for one in which]

    def _member(
        self,
        made: Cycle,
        folding: Folding,
        number: int,
        of: tuple[Var, Optional],
        message: tuple[int, int, Sequence[int]],
    ) -> None:
        """An input of the message that comes: present if the message holds it, and then near what was sent."""
        (var, option), (comes, last, possible), rows = of, message, self.tube.given.rows
        assert isinstance(var, NumVar)
        holding = {which: rows[self._sent[which - 1] - 1] for which in possible}
        holding = {which: row for which, row in holding.items() if row[option.present]}
        present = folding.make("and", [comes, folding.make("or", self._is(folding, last, [*holding]))])
        rest = canonical(var)
        ranges = {which: near(var, int(row[var]), self.tube.widths.get(var.name, 0)) for which, row in holding.items()}
        ends = [rest, *(end for bounds in ranges.values() for end in bounds)]
        value = free(folding, f"{var.name}@{number}", (min(ends), max(ends)))
        made.inputs[self.tube.write(option.present)] = present
        made.inputs[self.tube.write(var)] = value
        made.conditions.append(folding.make("or", [present, folding.make("=", [value, folding.number(rest)])]))
        for which, bounds in ranges.items():
            unless = folding.make("not", [folding.make("and", [comes, *self._is(folding, last, [which])])])
            made.conditions += [folding.make("or", [unless, one]) for one in between(folding, value, bounds)]

    def _read_late(self, made: Cycle, folding: Folding, number: int, last: tuple[int, range]) -> None:
        """Inputs that are never absent, read as they were in the cycle `last`."""
        node, possible = last
        for var in self.members:
            values = {at: self.tube.given.rows[at - 1][var] for at in possible}
            if not isinstance(var, NumVar):
                where = self._is(folding, node, [at for at, value in values.items() if value])
                made.inputs[self.tube.write(var)] = folding.make("or", where)
                continue
            ranges = {at: near(var, int(value), self.tube.widths.get(var.name, 0)) for at, value in values.items()}
            ends = [end for bounds in ranges.values() for end in bounds]
            read = free(folding, f"{var.name}@{number}", (min(ends), max(ends)))
            made.inputs[self.tube.write(var)] = read
            for at, bounds in ranges.items():
                unless = folding.make("not", self._is(folding, node, [at]))
                made.conditions += [folding.make("or", [unless, one]) for one in between(folding, read, bounds)]


def near(var: NumVar, at: int, width: int) -> Bounds:
    """Return the values of an input near that one, within its declared range."""
    return max(var.low, at - width), min(var.high, at + width)


def free(folding: Folding, name: str, bounds: Bounds | None) -> int:
    """Return a variable with these bounds, a truth value without bounds; a number if the bounds leave one value."""
    if bounds is None:
        return folding.variable(name, BOOL, None)
    return folding.number(bounds[0]) if bounds[0] == bounds[1] else folding.variable(name, INT, bounds)


def between(folding: Folding, term: int, bounds: Bounds) -> Iterator[int]:
    """Yield the conditions that a number lies within bounds."""
    yield folding.make("<=", [folding.number(bounds[0]), term])
    yield folding.make("<=", [term, folding.number(bounds[1])])
