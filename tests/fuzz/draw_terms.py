"""Random terms of our own, over given variables: small, of every kind, and never a comparison that cannot change."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from random import Random

from tests.fuzz.bounds import LAST, fits
from tests.fuzz.terms import Term
from tests.fuzz.world import COLOURS, Var

NUMBERS = ("add", "sub", "mul", "floor", "ceil", "min", "max", "abs", "ite", "times")
TRUTHS = ("not", "and", "or", "implies", "iff", "ite")


@dataclass(frozen=True)
class Pen:
    """Writes terms over some variables: numbers, truths, colours, and modes of machines (name, how many)."""

    rng: Random
    variables: tuple[Var, ...]
    modes: tuple[tuple[str, int], ...] = ()
    wide: bool = False  # numbers up to the ends of 64 bits; no term leaves them

    def _of(self, kind: str) -> list[Var]:
        return [var for var in self.variables if var.kind == kind]

    def number(self, depth: int) -> Term:
        """A number; a constant only where there is nothing else."""
        numbers = self._of("number")
        if not numbers:
            return ("lit", self.rng.randint(-2, 3))
        term = self._number(depth, numbers)
        return term if not self.wide or self._fits(term) else self._leaf(self.rng.choice(numbers))

    def _fits(self, term: Term) -> bool:
        return fits(term, {var.name: (var.low, var.high) for var in self.variables})

    def _number(self, depth: int, numbers: list[Var]) -> Term:
        if depth == 0 or self.rng.random() < 0.35:
            return self._leaf(self.rng.choice(numbers))
        kind = self.rng.choice(NUMBERS)
        match kind:
            case "floor" | "ceil":
                return (kind, self.number(depth - 1), self._divisor())
            case "abs":
                return (kind, self.number(depth - 1))
            case "ite":
                return (kind, self.truth(depth - 1), self.number(depth - 1), self._number_or_constant(depth - 1))
            case "times":
                return ("mul", self.number(depth - 1), ("lit", self.rng.choice((-2, -1, 2, 3))))
            case "mul":
                return (kind, self.number(0), self.number(0))
            case _:
                return (kind, self.number(depth - 1), self._number_or_constant(depth - 1))

    def _divisor(self) -> int:
        return self.rng.choice((2, 3, 7, 10**6, 2**31, 2**62 + 1, LAST)) if self.wide else self.rng.randint(2, 4)

    def _number_or_constant(self, depth: int) -> Term:
        constants = (-2, -1, 1, 2, 3, 2**31, -(2**32) - 1, LAST - 1, -LAST) if self.wide else (-2, -1, 1, 2, 3)
        return ("lit", self.rng.choice(constants)) if self.rng.random() < 0.4 else self.number(depth)

    def _leaf(self, var: Var) -> Term:
        """The variable; of one that may be absent, mostly a value that is read only where it is there."""
        if var.optional and self.rng.random() < 0.85:
            return ("ite", ("var", var.present), ("var", var.name), ("lit", self.rng.randint(var.low, var.high)))
        return ("var", var.name)

    def colour(self) -> Term:
        """A member or a variable."""
        colours = self._of("colour")
        if colours and self.rng.random() < 0.5:
            return ("var", self.rng.choice(colours).name)
        return ("member", self.rng.randrange(len(COLOURS)))

    def truth(self, depth: int) -> Term:
        """A truth value that some variable decides."""
        if depth == 0 or self.rng.random() < 0.35:
            return self.atom()
        kind = self.rng.choice(TRUTHS)
        count = {"not": 1, "ite": 3}.get(kind, 2)
        return (kind, *(self.truth(depth - 1) for _ in range(count)))

    def atom(self) -> Term:
        """A comparison or a variable."""
        ways = [self._compared, self._compared] if self._of("number") else []
        ways += [self._flag] if self._flags() else []
        ways += [self._mode] if self.modes else []
        ways += [self._coloured] if self._of("colour") else []
        return self.rng.choice(ways)()

    def _flags(self) -> list[str]:
        return [var.name for var in self._of("truth")] + [var.present for var in self.variables if var.optional]

    def _flag(self) -> Term:
        return ("var", self.rng.choice(self._flags()))

    def _mode(self) -> Term:
        name, count = self.rng.choice(self.modes)
        chosen = self.rng.sample(range(count), self.rng.randint(1, max(1, count - 1)))
        return ("among", ("var", name), *chosen)

    def _coloured(self) -> Term:
        var = self.rng.choice(self._of("colour"))
        return (self.rng.choice(("eq", "ne")), ("var", var.name), self.colour())

    def _compared(self) -> Term:
        """A variable with a constant that its range does not decide, or two terms."""
        var = self.rng.choice(self._of("number"))
        if self.rng.random() < 0.6 and var.low < var.high:
            return against_constant(self.rng, var)
        term: Term = ("sub", self.number(1), self.number(1))
        if self.wide and not self._fits(term):
            term = self.number(1)
            return (self.rng.choice(("lt", "ge", "eq")), ("max", term, self._leaf(var)), self.number(1))
        return (self.rng.choice(("lt", "le", "gt", "ge", "eq", "ne")), term, ("lit", self.rng.randint(-2, 2)))


def against_constant(rng: Random, var: Var) -> Term:
    """A comparison of the variable with a constant that its range does not decide."""
    operator = rng.choice(("lt", "le", "gt", "ge", "eq", "ne"))
    low = var.low + 1 if operator in ("lt", "ge") else var.low
    high = var.high - 1 if operator in ("le", "gt") else var.high
    return (operator, ("var", var.name), ("lit", rng.randint(low, high)))


def clamped(var: Var, term: Term) -> Term:
    """The term, kept in the variable's range."""
    return ("max", ("min", term, ("lit", var.high)), ("lit", var.low))


def fitting(pen: Pen, var: Var, depth: int) -> Term:
    """A term of the variable's kind, in its range."""
    if var.kind == "truth":
        return pen.truth(depth)
    return pen.colour() if var.kind == "colour" else clamped(var, pen.number(depth))


def weighted(rng: Random, choices: Sequence[tuple[str, float]]) -> str:
    """One of the names, by weight."""
    names, weights = zip(*choices, strict=True)
    return str(rng.choices(names, weights)[0])
