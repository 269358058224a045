"""The tube around a stream: the inputs that each cycle may have, as terms over a few free variables.

    an input without a deviation   is as given: a constant
    with a width                   is a variable between what is given less the width and what is given plus the width, as far as
                                   its declared range goes, since no value outside of it can be an input
    with losses or a delay         comes as messages: each message of the stream comes in its cycle or up to the delay later, in
                                   the order given, at most one in a cycle; up to so many never come
    never absent, with a delay     is read as it was given in a cycle up to the delay before; never older than in the cycle before
    a choice of the world          is free, within the laws; if it is named, near the recorded one

What a channel has given out so far is a state of the tube (`Tube.state`). It moves with the machine's.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

from safeloc.language.expr import (
    FALSE,
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
    as_num,
    between,
    ite,
)
from safeloc.language.nodes import Truth, Value
from safeloc.language.system import TransitionSystem, canonical
from safeloc.language.units import COUNT, Enumeration
from safeloc.proof.around.deviations import Channel, Deviations

Row = Mapping[Var, Value]


@dataclass(frozen=True, eq=False)
class Given:
    """The stream that is given: inputs on board in each cycle, and what is recorded of the world, if it is.

    first   values of the machine's variables whose first value is open
    choices recorded choices of the world in each cycle; ghosts recorded ghosts after each cycle, the first state at 0
    """

    rows: Sequence[Row]
    first: Mapping[Var, Value] = field(default_factory=dict)
    choices: Sequence[Row] = ()
    ghosts: Sequence[Row] = ()

    @property
    def length(self) -> int:
        """The number of cycles."""
        return len(self.rows)


@dataclass(frozen=True, eq=False)
class Cycle:
    """The values that the tube allows in one cycle.

    inputs  every input as a term over the tube's state and `free`
    free    variables of this cycle alone, with their ranges
    allowed condition over both
    moves   the tube's state after the cycle
    after   condition on the machine's state after the cycle
    """

    inputs: Mapping[Var, Expr]
    free: tuple[Var, ...]
    allowed: Bool
    moves: Mapping[Var, Expr]
    after: Bool = TRUE


@dataclass(eq=False)
class _Made:
    """A cycle that is being made."""

    inputs: dict[Var, Expr] = field(default_factory=dict)
    free: list[Var] = field(default_factory=list)
    allowed: list[Bool] = field(default_factory=list)
    moves: dict[Var, Expr] = field(default_factory=dict)

    def number(self, like: NumVar, name: str, low: int, high: int) -> Num:
        """Return a new variable of that range; a constant if the range holds one value."""
        if low == high:
            return Lit(low, like.unit)
        var = NumVar(name, like.unit, low, high)
        self.free.append(var)
        return var

    def truth(self, name: str) -> BoolVar:
        """Return a new truth value."""
        var = BoolVar(name)
        self.free.append(var)
        return var


class Tube:
    """All streams near a given one. Cycles are numbered from 1."""

    def __init__(self, system: TransitionSystem, given: Given, deviations: Deviations) -> None:
        self.system, self.given, self.deviations = system, given, deviations
        self._optional: dict[Var, Optional] = {one.value: one for one in system.optionals}
        by_name = {var.name: var for var in system.inputs}
        self._lanes = [
            _Lane(self, one, [by_name[name] for name in one.names])
            for one in deviations.channels
            if one.drops or one.delay
        ]
        self._on_lanes = {var for lane in self._lanes for var in lane.members}
        flags = {one.present for one in system.optionals}
        self._alone = [var for var in system.inputs if var not in flags and var not in self._on_lanes]

    @property
    def state(self) -> dict[Var, Value]:
        """The tube's own state variables, with their first values."""
        return {var: value for lane in self._lanes for var, value in lane.first.items()}

    @property
    def length(self) -> int:
        """The number of cycles."""
        return self.given.length

    def scaled(self, parts: int) -> Tube:
        """Return the tube with so many thousandths of each width."""
        return Tube(self.system, self.given, self.deviations.scaled(parts))

    def width(self, var: Var) -> int:
        """Return the width of an input; 0 if it has none."""
        return self.deviations.widths.get(var.name, 0)

    def named(self, var: Var) -> bool:
        """Return whether a ghost is held near what is recorded."""
        return var.name in self.deviations.widths

    def cycle(self, number: int) -> Cycle:
        """Return what the tube allows in a cycle."""
        made = _Made()
        for var in self._alone:
            if var in self.system.ghosts:
                made.inputs[var] = self._choice(made, var, number)
            else:
                self._single(made, var, number)
        for lane in self._lanes:
            lane.add(made, number)
        return Cycle(made.inputs, tuple(made.free), all_of(made.allowed), made.moves, self.ghosts_at(number))

    def ghosts_at(self, number: int) -> Bool:
        """Return the condition on named ghosts after so many cycles."""
        if not self.given.ghosts:
            return TRUE
        row = self.given.ghosts[number]
        near = [
            (var, row[var], self.width(var))
            for var in self.system.state
            if var in self.system.ghosts and self.named(var)
        ]
        return all_of(
            between(int(at) - width, var, int(at) + width) for var, at, width in near if isinstance(var, NumVar)
        )

    def _choice(self, made: _Made, var: Var, number: int) -> Expr:
        if isinstance(var, BoolVar):
            return made.truth(f"{var.name}@{number}")
        if self.named(var):
            return self.near(made, var, int(self.given.choices[number - 1][var]), f"{var.name}@{number}")
        return made.number(var, f"{var.name}@{number}", var.low, var.high)

    def _single(self, made: _Made, var: Var, number: int) -> None:
        row, option = self.given.rows[number - 1], self._optional.get(var)
        present = True if option is None else bool(row[option.present])
        if option is not None:
            made.inputs[option.present] = Truth(present)
        if isinstance(var, BoolVar):
            made.inputs[var] = Truth(bool(row[var]))
        elif present:
            made.inputs[var] = self.near(made, var, int(row[var]), f"{var.name}@{number}")
        else:
            made.inputs[var] = Lit(canonical(var), var.unit)

    def near(self, made: _Made, var: NumVar, at: int, name: str) -> Num:
        """Return a value near that one, in the declared range."""
        width = self.width(var)
        return made.number(var, name, max(var.low, at - width), min(var.high, at + width))


class _Lane:
    """A channel: which message comes in a cycle, and what is on its way."""

    def __init__(self, tube: Tube, channel: Channel, members: Sequence[Var]) -> None:
        self._tube, self._channel, self.members = tube, channel, tuple(members)
        self._options = {var: option for option in tube.system.optionals for var in members if option.value is var}
        rows = tube.given.rows
        self._held = not self._options
        self._sent = [
            number
            for number, row in enumerate(rows, 1)
            if self._held or any(row[option.present] for option in self._options.values())
        ]
        name, most = f"tube.{channel.name}", len(self._sent)
        self._taken = NumVar(f"{name}.taken", COUNT, 0, most)
        self._lost = NumVar(f"{name}.lost", COUNT, 0, channel.drops)

    @property
    def first(self) -> dict[Var, Value]:
        """The lane's state before the first cycle."""
        return {self._taken: 0} if self._held else {self._taken: 0, self._lost: 0}

    def _due(self, number: int) -> int:
        """Return how many messages were sent up to a cycle."""
        return sum(1 for at in self._sent if at <= number) if number > 0 else 0

    def add(self, made: _Made, number: int) -> None:
        """Add the inputs of the channel in a cycle."""
        due, late = self._due(number), self._due(number - self._channel.delay)
        if self._held:
            self._add_held(made, number, due, max(1, late))
            return
        possible = range(self._due(number - 1 - self._channel.delay) + 1, due + 1)
        comes: Bool = made.truth(f"{self._channel.name} comes@{number}") if possible else FALSE
        came = ite(comes, as_num(1, COUNT), Lit(0, COUNT))
        last: Num = self._taken + came
        if self._channel.drops:
            last = made.number(self._taken, f"{self._channel.name} last@{number}", late, due)
            lost = self._lost + (last - self._taken - came)
            made.allowed += [last >= self._taken + came, lost <= self._channel.drops]
            made.moves[self._lost] = lost
        else:
            made.allowed.append(between(late, last, due))
            made.moves[self._lost] = self._lost
        made.moves[self._taken] = last
        for var, option in self._options.items():
            self._add_message(made, number, (var, option), comes, last, possible)

    def _add_held(self, made: _Made, number: int, due: int, late: int) -> None:
        """An input that is never absent is read as in the cycle `last`."""
        last = made.number(self._taken, f"{self._channel.name} from@{number}", late, due)
        made.allowed.append(last >= self._taken)
        made.moves[self._taken] = last
        for var in self.members:
            values = {at: self._tube.given.rows[at - 1][var] for at in range(late, due + 1)}
            if isinstance(var, BoolVar):
                made.inputs[var] = any_of(last.eq(at) for at, value in values.items() if value)
            else:
                numbers = {at: int(value) for at, value in values.items()}
                made.inputs[var] = self._deviated(
                    made, var, number, _picked(last, numbers, var), set(numbers.values()), TRUE
                )

    def _add_message(
        self, made: _Made, number: int, of: tuple[Var, Optional], comes: Bool, last: Num, possible: range
    ) -> None:
        """One input of a message: present if the message that comes holds it."""
        var, option = of
        assert isinstance(var, NumVar)
        rows = self._tube.given.rows
        holding = {
            one: int(rows[self._sent[one - 1] - 1][var])
            for one in possible
            if rows[self._sent[one - 1] - 1][option.present]
        }
        there = TRUE if len(holding) == len(possible) else any_of(last.eq(one) for one in holding)
        present = comes & there
        made.inputs[option.present] = present
        if not holding:
            made.inputs[var] = Lit(canonical(var), var.unit)
            return
        value = self._deviated(made, var, number, _picked(last, holding, var), set(holding.values()), present)
        made.inputs[var] = ite(present, value, canonical(var))

    def _deviated(self, made: _Made, var: NumVar, number: int, value: Num, among: set[int], where: Bool) -> Num:
        """Return the value with a deviation of at most its width, in the declared range."""
        width = self._tube.width(var)
        if not width:
            return value
        if len(among) == 1:
            return self._tube.near(made, var, next(iter(among)), f"{var.name}@{number}")
        assert not isinstance(var.unit, Enumeration)
        deviated = value + made.number(var, f"{var.name} deviation@{number}", -width, width)
        made.allowed.append(where.implies(between(var.low, deviated, var.high)))
        return deviated


def _picked(last: Num, values: Mapping[int, int], var: NumVar) -> Num:
    """Return the value of the message of that number, among these."""
    *others, (_, value) = values.items()
    found: Num = Lit(value, var.unit)
    for number, other in others:
        if other != value:
            found = ite(last.eq(number), Lit(other, var.unit), found)
    return found
