"""Random machines of our own, small enough to be searched to the end.

A trap is a habit of declaring that once led to a wrong verdict: `Draw.traps` says which ones may be drawn, and `Drawn`
tells which were.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from random import Random

from tests.fuzz.bounds import FIRST, LAST
from tests.fuzz.draw_terms import Pen, against_constant, clamped, fitting
from tests.fuzz.terms import TRUE, Term
from tests.fuzz.world import Kind, Row, Var, World

RANGES = ((0, 1), (0, 2), (0, 3), (0, 4), (0, 7), (-2, 2), (1, 4), (-3, 0))
SMALL = ((0, 1), (0, 2), (-1, 1), (1, 3))
WIDE = (
    (FIRST, LAST),
    (LAST - 4, LAST),
    (FIRST, FIRST + 4),
    (-(2**31) - 1, 2**31),
    (0, 2**32),
    (-(10**9), 10**9),
    (2**62, LAST),
    (-7, 13),
    (0, 1),
)
STATES, CHOICES = 350, 12


@dataclass
class Drawn:
    """What traps a machine or composition came with."""

    traps: set[str] = field(default_factory=set)


@dataclass(frozen=True)
class Draw:
    """A source of machines: the same seed gives the same ones."""

    rng: Random
    traps: frozenset[str] = frozenset()
    drawn: Drawn = field(default_factory=Drawn)
    wide: bool = False  # ranges up to the ends of 64 bits: for back ends, which search nothing

    def sometimes(self, share: float) -> bool:
        """True so often."""
        return self.rng.random() < share

    def trap(self, name: str, share: float) -> bool:
        """Whether to draw this trap; if so it is remembered. Where only one is asked for, it is drawn often."""
        often = max(share, 0.7) if len(self.traps) == 1 else share
        hit = name in self.traps and self.sometimes(often)
        if hit:
            self.drawn.traps.add(name)
        return hit

    # -------------------------------------------------------------- variables

    def variables(self, prefix: str, count: int, ranges: tuple[tuple[int, int], ...], most: int) -> list[Var]:
        """Variables with at most so many combinations of values."""
        made: list[Var] = []
        size = 1
        for number in range(count):
            kind: Kind = self.rng.choice(("number", "number", "number", "truth", "colour"))
            low, high = self.rng.choice(WIDE if self.wide else ranges) if kind == "number" else (0, 2)
            var = Var(f"{prefix}{number}", kind, low, high)
            values = 2 if kind == "truth" or self.wide else high - low + 1
            if size * values <= most:
                size *= values
                made.append(var)
        return made

    def inputs(self) -> list[Var]:
        """Inputs, some of which may be absent."""
        made = self.variables("i", self.rng.randint(1, 3), SMALL, CHOICES // 2)
        if self.sometimes(0.25):
            made.append(Var("o0", "number", *self.rng.choice(WIDE if self.wide else SMALL), optional=True))
        while not self.wide and _combinations(made) > CHOICES:
            made.pop(0)
        return made or [Var("i0", "truth")]

    def first(self, var: Var, open_: float = 0.1) -> int | None:
        """A first value, or None for any."""
        return None if self.sometimes(open_) else self.value(var)

    def value(self, var: Var) -> int:
        """A value in its range, the ends of it more often than not."""
        if var.kind != "number":
            return self.rng.choice(var.values)
        ends = (var.low, min(var.low + 1, var.high), max(var.high - 1, var.low), var.high, var.absent)
        return self.rng.choice(ends) if self.sometimes(0.7) else self.rng.randint(var.low, var.high)

    # -------------------------------------------------------------- a machine

    def world(self, name: str = "m", inputs: list[Var] | None = None, states: int = STATES) -> World:
        """A machine that is well-formed but for the traps."""
        modes = self.rng.randint(1, 3)
        state = self.variables("s", self.rng.randint(2, 4), RANGES, states // modes)
        inputs = self.inputs() if inputs is None else inputs
        ghosts, ghost_inputs = self._environment(states)
        own = Pen(self.rng, (*state, *inputs), (("mode", modes),), self.wide)
        everything = Pen(self.rng, (*state, *inputs, *ghosts, *ghost_inputs), (("mode", modes),), self.wide)
        inside = Pen(self.rng, tuple(state), (("mode", modes),), self.wide)
        made = World(
            name,
            modes,
            tuple(inputs),
            {var: self.first(var) for var in state},
            {"told": inside.number(2), "flag": inside.truth(1)},
            self._rows(own, state, modes),
            {var: self.first(var) for var in ghosts},
            tuple(ghost_inputs),
            {var.name: fitting(everything, var, 2) for var in ghosts},
            self._assumption(everything, [*inputs, *ghost_inputs], 0.5),
            {"clause": self._assumption(everything, [*inputs, *ghost_inputs], 1)} if self.sometimes(0.2) else {},
        )
        return self._beginning(made, inside)

    def _environment(self, states: int) -> tuple[list[Var], list[Var]]:
        if not self.sometimes(0.35 if self.traps != {"initially over ghosts"} else 0.9) or states < 30:
            return [], []
        ghost = Var("g0", self.rng.choice(("number", "number", "truth")), 0, 2)
        return [ghost], self.variables("p", self.rng.randint(0, 1), ((0, 1), (-1, 1)), 3)

    def _rows(self, own: Pen, state: list[Var], modes: int) -> tuple[Row, ...]:
        shared = self.sometimes(0.4)
        rows = []
        for number in range(self.rng.randint(2, 6)):
            sources = tuple(self.rng.sample(range(modes), self.rng.randint(1, modes)))
            if modes > 2 and len(sources) < modes and self.trap("source named twice", 0.05):
                sources = (*sources, *sources[-1:] * (modes - len(sources)))
            sets = {var.name: self._update(own, var) for var in state if self.sometimes(0.6)}
            guard = TRUE if self.sometimes(0.1) else own.truth(self.rng.randint(0, 2))
            rank = number // 2 if shared else number
            rows.append(Row(f"t{number}", sources, self.rng.randrange(modes), guard, sets, rank))
        return tuple(rows)

    def _update(self, own: Pen, var: Var) -> Term:
        if var.kind == "number" and not self.wide and self.trap("range lies", 0.01):
            return self._moved(var, own)
        if var.kind == "number" and not self.wide and self.sometimes(0.6):
            return clamped(var, self._moved(var, own)) if self.sometimes(0.6) else self._turned(var)
        if var.kind == "truth" and self.sometimes(0.3):
            return ("not", ("var", var.name))
        return fitting(own, var, 2)

    def _moved(self, var: Var, own: Pen) -> Term:
        """A little up or down, or by what is heard."""
        by: Term = ("lit", self.rng.choice((-2, -1, 1, 1, 1, 2))) if self.sometimes(0.7) else own.number(0)
        return ("add", ("var", var.name), by)

    def _turned(self, var: Var) -> Term:
        """Round and round."""
        around: Term = ("eq", ("var", var.name), ("lit", var.high))
        return ("ite", around, ("lit", var.low), ("add", ("var", var.name), ("lit", 1)))

    def _assumption(self, everything: Pen, heard: list[Var], share: float) -> Term:
        if not self.sometimes(share):
            return TRUE
        numbers = [var for var in heard if var.kind == "number" and not var.optional]
        if numbers and self.sometimes(0.5):
            return against_constant(self.rng, self.rng.choice(numbers))
        return everything.truth(self.rng.randint(0, 1))

    def _beginning(self, world: World, inside: Pen) -> World:
        """With conditions on first values, and lemmas."""
        state, initially = dict(world.state), list[Term]()
        opened = [var for var in state if var.kind == "number"]
        if opened and self.sometimes(0.15):
            state[opened[0]] = None
            initially.append(against_constant(self.rng, opened[0]))
        seen = replace(inside, variables=(*inside.variables, *world.ghosts)) if self.sometimes(0.3) else inside
        lemmas = {f"lemma {n}": self._lemma(seen, opened) for n in range(2) if self.sometimes(0.25)}
        made = replace(world, state=state, initially=tuple(initially), lemmas=lemmas)
        ghosts = [var for var in world.ghosts if var.kind == "number"]
        if opened and ghosts and self.trap("initially over ghosts", 0.3):
            return self._told_the_truth(made, opened[0], ghosts[0])
        return made

    def _told_the_truth(self, world: World, var: Var, ghost: Var) -> World:
        """It starts where the truth is, mostly moves little, and a lemma says what is so only then."""
        told = replace(world, state={**world.state, var: None})
        rows = told.rows
        if self.sometimes(0.6):
            kept = [{name: term for name, term in row.sets.items() if name != var.name} for row in rows]
            rows = tuple(replace(row, sets=sets) for row, sets in zip(rows, kept, strict=True))
        first = world.ghosts[ghost]
        lemma: Term = ("le", ("var", var.name), ("lit", ghost.high if first is None else first))
        initially = (*told.initially, ("eq", ("var", var.name), ("var", ghost.name)))
        return replace(told, rows=rows, initially=initially, lemmas={**told.lemmas, "start": lemma})

    def _lemma(self, inside: Pen, opened: list[Var]) -> Term:
        if opened and self.sometimes(0.5):
            return against_constant(self.rng, self.rng.choice(opened))
        return inside.truth(1)


def _combinations(inputs: list[Var]) -> int:
    count = 1
    for var in inputs:
        count *= len(var.choices)
    return count
