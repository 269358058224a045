"""Some cycles of a machine from a set of states on, as terms over the first state and what the tube leaves free.

Each step is folded as it is made: inputs without a deviation are constants, and comparisons that the ranges decide are gone.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

from safeloc.codegen.simplify_under_facts import Known
from safeloc.language.expr import FALSE, TRUE, Bool, BoolVar, Expr, Lit, Num, NumVar, Var, all_of, between
from safeloc.language.interpret import evaluate
from safeloc.language.nodes import Choose, ChooseBool, Max, Min, Truth, Value
from safeloc.language.ranges import Bounds
from safeloc.language.system import TransitionSystem, canonical, environment, in_range
from safeloc.language.terms import conjuncts, in_order
from safeloc.language.units import Enumeration
from safeloc.proof.around.intervals import Intervals
from safeloc.proof.around.tube import Tube
from safeloc.proof.provers.linear import constant_of

CHOOSING = (Choose, ChooseBool, Min, Max)


@dataclass(frozen=True, eq=False)
class Piece:
    """A set of states: constants, and ranges of numbers; what is not named is free.

    condition  of the first states: the machine's `initially`
    """

    fixed: Mapping[Var, Value]
    ranges: Mapping[NumVar, Bounds] = field(default_factory=dict)
    condition: Bool = TRUE

    def holds_in(self, state: Mapping[Var, Value]) -> bool:
        """Return whether a state belongs to the piece."""
        return (
            all(state[var] == value for var, value in self.fixed.items())
            and all(low <= state[var] <= high for var, (low, high) in self.ranges.items())
            and bool(evaluate([self.condition], state)[0])
        )


@dataclass(frozen=True, eq=False)
class Space:
    """A machine with observers, a tube around a stream of it, and facts that are proved of every state it can come to.

    restarts  observers that begin anew after a cycle, with their values, by that cycle
    """

    system: TransitionSystem
    tube: Tube
    facts: Sequence[Bool] = ()
    restarts: Mapping[int, Mapping[Var, Value]] = field(default_factory=dict)

    @property
    def state(self) -> tuple[Var, ...]:
        """The state of the machine and of the tube."""
        return (*self.system.state, *self.tube.state)

    def tells_apart(self, var: Var) -> bool:
        """Return whether a variable is a mode, a flag, or counts the messages of a channel: pieces are told apart by these."""
        return isinstance(var, BoolVar) or isinstance(var.unit, Enumeration) or var in self.tube.state


class Course:
    """The cycles after `begin`, from a piece on; `states` are those after 0, 1, 2 ... cycles."""

    def __init__(self, space: Space, piece: Piece, begin: int) -> None:
        self.space, self.piece, self.begin = space, piece, begin
        self.intervals = Intervals()
        self._environment = environment(space.system)
        free: list[Var] = []
        first = {var: self._first(var, free) for var in space.state}
        self.states: list[Mapping[Var, Expr]] = [first]
        self.inputs: list[Mapping[Var, Expr]] = []
        self._free: list[Sequence[Var]] = [free]
        known = Known(first, self.intervals.decide)
        self.of_each_cycle: list[Sequence[Bool]] = [_parts(known, [piece.condition, *space.facts])]

    def _first(self, var: Var, free: list[Var]) -> Expr:
        if var in self.piece.fixed:
            return constant_of(var, self.piece.fixed[var])
        if isinstance(var, BoolVar):
            made: Var = BoolVar(f"{var.name}@{self.begin}")
        else:
            low, high = self.piece.ranges.get(var, (var.low, var.high))
            if low == high:
                return Lit(low, var.unit)
            made = NumVar(f"{var.name}@{self.begin}", var.unit, low, high)
        free.append(made)
        return made

    @property
    def end(self) -> int:
        """The last cycle."""
        return self.begin + len(self.inputs)

    @property
    def free(self) -> list[Var]:
        """All free variables."""
        return [var for some in self._free for var in some]

    @property
    def dead(self) -> bool:
        """Folding alone shows that no stream comes so far."""
        return any(
            part is FALSE or (isinstance(part, Truth) and not part.value)
            for some in self.of_each_cycle
            for part in some
        )

    @property
    def choices(self) -> int:
        """The number of choices that folding leaves open in the last state."""
        return sum(isinstance(node, CHOOSING) for node in in_order(self.states[-1].values()))

    def to(self, cycle: int) -> Course:
        """Go on up to a cycle."""
        while self.end < cycle and not self.dead:
            self.step()
        return self

    def step(self) -> None:
        """Go on by one cycle."""
        number, state = self.end + 1, self.states[-1]
        cycle, decide = self.space.tube.cycle(number), self.intervals.decide
        of_tube = Known({var: state[var] for var in self.space.tube.state}, decide)
        inputs = {var: of_tube(term) for var, term in cycle.inputs.items()}
        known = Known({**state, **inputs}, decide)
        after = {var: known(term) for var, term in self.space.system.next.items()}
        after |= {var: of_tube(term) for var, term in cycle.moves.items()}
        after |= {var: constant_of(var, value) for var, value in self.space.restarts.get(number, {}).items()}
        allowed = [*_parts(of_tube, [cycle.allowed]), *_parts(known, [self._environment])]
        allowed += _parts(Known(after, decide), [cycle.after]) if cycle.after is not TRUE else []
        self.inputs.append(inputs)
        self._free.append(cycle.free)
        self.of_each_cycle.append(allowed)
        self.states.append(after)

    def at(self, term: Expr, cycle: int) -> Expr:
        """Return a term over the state after a cycle, folded."""
        return Known(self.states[cycle - self.begin], self.intervals.decide)(term)

    def hypotheses(self, cycle: int) -> list[Bool]:
        """Return what holds of all streams up to a cycle."""
        count = cycle - self.begin + 1
        free = [var for some in self._free[:count] for var in some]
        return [in_range(free), *(part for some in self.of_each_cycle[:count] for part in some)]

    def conditions(self, cycle: int) -> int:
        """Return the number of conditions up to a cycle, ranges apart."""
        return sum(map(len, self.of_each_cycle[: cycle - self.begin + 1]))

    # -------------------------------------------------------------- a single stream

    def first_state(self, values: Mapping[Var, Value]) -> dict[Var, Value]:
        """Return the first state under values of the free variables."""
        return self._values(self.states[0], values)

    def last_state(self, values: Mapping[Var, Value]) -> dict[Var, Value]:
        """Return the last state under values of the free variables."""
        return self._values(self.states[-1], values)

    def stream(self, values: Mapping[Var, Value], cycles: int) -> list[dict[Var, Value]]:
        """Return the inputs of so many cycles under values of the free variables."""
        return [self._values(terms, values) for terms in self.inputs[:cycles]]

    def _values(self, terms: Mapping[Var, Expr], values: Mapping[Var, Value]) -> dict[Var, Value]:
        return dict(zip(terms, evaluate(list(terms.values()), self.with_rest(values)), strict=True))

    def with_rest(self, values: Mapping[Var, Value]) -> dict[Var, Value]:
        """Return values of all free variables: those that are not given are at rest."""
        return {**{var: _at_rest(var) for var in self.free}, **values}


def _at_rest(var: Var) -> Value:
    return canonical(var) if isinstance(var, NumVar) else False


def within(term: Num, bounds: Bounds) -> Bool:
    """Return the condition that a number lies within bounds, or that a member of an enumeration is one of those."""
    if isinstance(term.unit, Enumeration):
        return term.one_of(*(Lit(index, term.unit) for index in range(bounds[0], bounds[1] + 1)))
    return between(bounds[0], term, bounds[1])


def _parts(known: Known, terms: Sequence[Bool]) -> list[Bool]:
    """Return the conjuncts of folded conditions that are not simply true."""
    found: list[Bool] = []
    for term in terms:
        for part in conjuncts(term):
            folded = known(part)
            assert isinstance(folded, Bool)
            found += [one for one in conjuncts(folded) if not (isinstance(one, Truth) and one.value)]
    return list(dict.fromkeys(found))


def first_piece(space: Space) -> Piece:
    """Return the first states: declared values, the given ones of the machine's open variables, and every one of the world's."""
    system, tube = space.system, space.tube
    fixed: dict[Var, Value] = dict(tube.state)
    for var in system.state:
        declared = system.initial[var]
        if isinstance(declared, Lit):
            fixed[var] = declared.value
        elif isinstance(declared, (bool, int)):
            fixed[var] = declared
        elif var not in system.ghosts:
            fixed[var] = tube.given.first.get(var, _at_rest(var))
    return Piece(fixed, condition=all_of([system.init, tube.ghosts_at(0)]))
