"""Random claims about a machine or composition of our own: half of them at the edge of what the search has seen."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from random import Random

from tests.fuzz.draw import Draw
from tests.fuzz.draw_terms import Pen, weighted
from tests.fuzz.explore import Space, lawful
from tests.fuzz.judge import WAITING, Claim
from tests.fuzz.terms import TRUE, Term, parts, reads
from tests.fuzz.world import Game, Var, Whole, World

KINDS = (("always", 0.55), ("within", 0.25), ("reachable", 0.2))


@dataclass(frozen=True)
class Claims:
    """Draws claims about a game whose states are known."""

    draw: Draw
    space: Space

    @property
    def rng(self) -> Random:
        """Where the draws come from."""
        return self.draw.rng

    @property
    def game(self) -> Game:
        """What the claims are about."""
        return self.space.game

    def some(self, count: int) -> list[Claim]:
        """Claims of every kind, each with a name of its own."""
        return [self.one(f"claim {number}") for number in range(count)]

    def one(self, name: str) -> Claim:
        """A claim."""
        kind = weighted(self.rng, KINDS)
        further = self._further() if self.draw.sometimes(0.15) else TRUE
        free = self.draw.sometimes(0.15)
        if kind == "within":
            return self._within(name, further, free)
        term = self._sharp() if self.draw.sometimes(0.5) else self._stepwise(1)
        if kind == "reachable" and self.draw.sometimes(0.5):
            term = ("not", term)
        return Claim(
            name, "reachable" if kind == "reachable" else "always", term, further_assumption=further, unconditional=free
        )

    # -------------------------------------------------------------- terms

    def _numbers(self) -> list[Var]:
        names = set(self.game.state_names)
        return [var for name, var in self.game.variables.items() if name in names and var.kind == "number"]

    def _pen(self, *, inputs: bool) -> Pen:
        names = set(self.game.state_names)
        state = tuple(var for name, var in self.game.variables.items() if name in names)
        return Pen(self.rng, (*state, *(self.game.own_inputs if inputs else ())), modes_of(self.game))

    def _sharp(self) -> Term:
        """What every state that was seen keeps, or all but a few."""
        reached = [self.space.states[state] for state in self.space.reached(lawful)]
        numbers = self._numbers()
        if not numbers or not reached:
            return self._pen(inputs=False).truth(1)
        var = self.rng.choice(numbers)
        low, high = min(state[var.name] for state in reached), max(state[var.name] for state in reached)
        edge = self.rng.choice((("le", high), ("le", high - 1), ("ge", low), ("ge", low + 1)))
        bound: Term = (edge[0], ("var", var.name), ("lit", edge[1]))
        if self.draw.sometimes(0.5):
            return bound
        return ("implies", self._pen(inputs=self.draw.sometimes(0.5)).truth(1), bound)

    def _stepwise(self, depth: int) -> Term:
        """A term over a step: state after and before, inputs, what fired, and the past."""
        if self.draw.sometimes(0.3):
            return self._past(depth)
        if depth > 0 and self.draw.sometimes(0.6):
            kind = self.rng.choice(("and", "or", "implies", "implies", "not"))
            return (kind, *(self._stepwise(depth - 1) for _ in range(1 if kind == "not" else 2)))
        return self._simple()

    def _past(self, depth: int) -> Term:
        kind = self.rng.choice(("previous", "once", "since"))
        inner = [self._stepwise(depth - 1) if depth else self._simple() for _ in range(2 if kind == "since" else 1)]
        return (kind, *inner)

    def _simple(self) -> Term:
        ways: tuple[Callable[[], Term], ...] = (
            lambda: self._pen(inputs=False).atom(),
            lambda: self._pen(inputs=True).atom(),
            lambda: before(self._pen(inputs=False).atom()),
            self._fired,
            self._changed,
        )
        return self.rng.choice(ways)()

    def _changed(self) -> Term:
        numbers = self._numbers()
        if not numbers:
            return self._fired()
        var = self.rng.choice(numbers)
        operator = self.rng.choice(("le", "ge", "eq", "ne"))
        return (operator, ("sub", ("var", var.name), ("was", var.name)), ("lit", self.rng.randint(-1, 1)))

    def _fired(self) -> Term:
        name, count = self.rng.choice(rows_of(self.game))
        return ("among", ("var", name), *self.rng.sample(range(count + 1), self.rng.randint(1, count)))

    def _further(self) -> Term:
        return self._pen(inputs=True).atom()

    # -------------------------------------------------------------- within

    def _within(self, name: str, further: Term, free: bool) -> Claim:
        trigger, response = self._stepwise(1), self._stepwise(0)
        if self.draw.sometimes(0.4):
            response = ("or", response, self._sharp())
        claim = Claim(name, "within", trigger, response, self.rng.randint(0, 3), further, free)
        if self.draw.trap("helper reads inputs", 0.1):
            pen = Pen(self.rng, self.game.own_inputs)
            return replace(claim, helper=("implies", ("var", WAITING), pen.atom()))
        if self.draw.sometimes(0.2):
            return replace(claim, helper=("implies", ("var", WAITING), self._pen(inputs=False).atom()))
        return claim


def before(term: Term) -> Term:
    """The term over the state before the step."""
    if term[0] == "var":
        return ("was", term[1])
    inner = tuple(before(part) for part in parts(term))
    return (term[0], *inner, *term[1 + len(inner) :])


def modes_of(game: Game) -> tuple[tuple[str, int], ...]:
    """Names of mode variables, and how many modes there are."""
    if isinstance(game, World):
        return (("mode", game.modes),)
    return tuple((f"{world.name}.mode", world.modes) for world in game.worlds)


def rows_of(game: Game) -> list[tuple[str, int]]:
    """Names of fired variables, and how many rows there are."""
    if isinstance(game, World):
        return [("fired", len(game.rows))]
    return [(f"{world.name}.fired", len(world.rows)) for world in game.worlds]


def inherited(draw: Draw, whole: Whole, name: str) -> Claim:
    """A claim of one machine of a composition by itself, as one of the whole."""
    world = draw.rng.choice(whole.worlds)
    heard = [var for var in world.inputs if f"{world.name}.{var.name}" in whole.wires]
    state = tuple(var for var in (*world.state, *world.ghosts))
    pen = Pen(draw.rng, (*state, *world.inputs), (("mode", world.modes),))
    own: Term = pen.truth(draw.rng.randint(0, 2))
    assumed = [term for term in (world.assumption, *world.clauses.values()) if reads(term) and _heard_only(term, world)]
    if heard and assumed and draw.trap("inherited over a wire", 0.5):
        own = draw.rng.choice(assumed)
    elif draw.sometimes(0.4):
        own = ("implies", before(Pen(draw.rng, state, (("mode", world.modes),)).atom()), own)
    free = draw.sometimes(0.2)
    return Claim(name, "always", whole.told(world, own), unconditional=free, of=world.name, own=own)


def _heard_only(term: Term, world: World) -> bool:
    """Whether it reads inputs of the machine only: what is assumed is over state BEFORE the step, a claim is not."""
    return reads(term) <= {name for var in world.inputs for name in var.names}
