"""Profiles of inputs over a stretch of steps: how a moving train, its sensors and its surroundings behave for a while.

    steady, ramp, standstill, reversal     one level for all inputs of a kind, as sensors of one train see one movement
    ends, random                           each input at an end of its range, or anywhere
    stuck, silent, zero, scaled            steady, with one input at fault: frozen, absent, zero, too great or too small

Identities and absolute positions have a meaning only in relation to the state of the machine. Some inputs therefore repeat
a value of the state (the identity of an expected marker, the position of the train), or a value next to it. Choices of the
environment can stay on one side for long, so that errors add up.
"""

from __future__ import annotations

import random
import weakref
from collections.abc import Mapping
from fractions import Fraction

from safeloc.language.expr import BoolVar, NumVar, Var
from safeloc.language.nodes import Value
from safeloc.language.system import TransitionSystem, canonical
from safeloc.language.units import COUNT, Enumeration, Unit
from safeloc.proof.drawn_runs.lawful import Pick, any_end

PLAUSIBLE = ("steady", "steady", "ramp", "standstill", "reversal", "ends", "random")
FAULTY = ("stuck", "silent", "zero", "scaled", "ends", "random")
Kind = tuple[str, int, int, str]
AnyUnit = Unit | Enumeration
Like = tuple[NumVar, int, int]
"""A state variable of the same dimension as an input, and the factor between their units as a fraction."""


class Profile:
    """Inputs of one stretch, drawn from one seed.

    lean  draws the side to which the environment leans, often the same for a whole run
    """

    def __init__(
        self, system: TransitionSystem, kind: str, draw: random.Random, lean: random.Random | None = None
    ) -> None:
        self._system, self._kind, self.draw = system, kind, draw
        self._numbers = [var for var in system.inputs if isinstance(var, NumVar)]
        self._together = draw.random() < 0.85
        self._groups = {var: self._group(var) for var in self._numbers}
        self._level = {group: _level(var, draw) for var, group in self._groups.items()}
        self._change = {group: draw.uniform(-1, 1) * (group[2] - group[1]) / 200 for group in self._level}
        self._missing = {option.value: draw.choice((0.0, 0.02, 0.5, 0.95, 1.0)) for option in system.optionals}
        related = {option.value for option in system.optionals} | {var for var in self._numbers if var.unit is COUNT}
        likes = _likes(system)
        self._mirrored = {
            var: likes[var.unit] for var in self._numbers if draw.random() < (0.4 if var in related else 0.05)
        }
        self._favourite = draw.randrange(1_000)
        self._coin_for_all = draw.random() < 0.5
        self._flags = {var: draw.choice((0.0, 0.05, 0.5, 1.0)) for var in system.inputs if isinstance(var, BoolVar)}
        self._held = {var: _member(var, draw) for var in self._numbers if isinstance(var.unit, Enumeration)}
        self._lean = {var: (lean or draw).choice((0, 1, 0, 1, 2)) for var in self._numbers}
        self._leaning = lean is not None
        measured = [var for var in self._numbers if var not in system.ghosts]
        self._at_fault = draw.choice(measured) if measured else None
        self._scale = draw.choice((0.0, 0.5, 0.9, 1.1, 2.0, -1.0))
        self._number = 0
        self._nonzero: dict[AnyUnit, list[Like]] = {}

    @property
    def pick(self) -> Pick:
        """The choice of a value among the allowed ones: always on the same side, or at a random end."""
        if not self._leaning:
            return any_end(self.draw)
        return lambda var, low, high: (low, high, (low + high) // 2)[self._lean[var]]

    def inputs(self, state: Mapping[Var, Value]) -> dict[Var, Value]:
        """Return the next step's inputs; absent optional ones hold their canonical value."""
        values: dict[Var, Value] = {}
        self._nonzero.clear()
        for var in self._system.inputs:
            if isinstance(var, BoolVar):
                values[var] = self.draw.random() < self._flags[var]
            else:
                values[var] = self._value(var, state)
        coin = self.draw.random()
        for option in self._system.optionals:
            silent = self._kind == "silent" and option.value is self._at_fault
            thrown = coin if self._coin_for_all else self.draw.random()
            absent = silent or thrown < self._missing[option.value]
            values[option.present] = not absent
            if absent:
                values[option.value] = canonical(option.value)
        self._number += 1
        return values

    def _value(self, var: NumVar, state: Mapping[Var, Value]) -> int:
        if isinstance(var.unit, Enumeration):
            if self.draw.random() < 0.3:
                self._held[var] = _member(var, self.draw)
            return self._held[var]
        if self._leaning and var in self._system.ghosts and self._lean[var] < 2:
            return (var.low, var.high)[self._lean[var]]
        if self._mirrored.get(var):
            return _within(var, self._mirror(var, state))
        moved = self._moved(var)
        return _within(var, moved * self._fault() if var is self._at_fault else moved)

    def _mirror(self, var: NumVar, state: Mapping[Var, Value]) -> float:
        """Return a value of the state, preferably one that is not zero, or a value next to it."""
        if var.unit not in self._nonzero:
            likes = self._mirrored[var]
            self._nonzero[var.unit] = [like for like in likes if state[like[0]]] or likes
        known = self._nonzero[var.unit]
        like = known[self._favourite % len(known)] if self.draw.random() < 0.7 else self.draw.choice(known)
        seen, numerator, denominator = like
        beside = self.draw.choice((0, 0, 0, 1, -1, self.draw.randint(-1000, 1000)))
        return state[seen] * numerator / denominator + beside

    def _fault(self) -> float:
        """Return the factor on the measured value of the input at fault."""
        return {"zero": 0.0, "scaled": self._scale}.get(self._kind, 1.0)

    def _moved(self, var: NumVar) -> float:
        group = self._groups[var]
        level, kind = self._level[group], self._kind
        if kind in ("ramp", "stuck", "scaled") and var is not self._at_fault:
            return level + self._number * self._change[group]
        if kind == "ends":
            return self.draw.choice((var.low, var.high, canonical(var)))
        if kind == "standstill":
            return canonical(var)
        if kind == "reversal":
            return level if self._number % 20 < 10 else -level
        if kind == "random":
            return self.draw.choice((var.low, var.high, canonical(var), self.draw.randint(var.low, var.high)))
        return level

    def _group(self, var: NumVar) -> Kind:
        return (var.unit.name, var.low, var.high, "" if self._together else var.name)


def _level(var: NumVar, draw: random.Random) -> float:
    """Draw a level to hold: an end of the range, rest, or some small or large share of the range."""
    share = draw.choice((0.0005, 0.01, 0.1, 1.0, 1.0))
    inside = draw.uniform(var.low, var.high) * share
    return draw.choice((var.low, var.high, canonical(var), inside, inside, inside))


def _member(var: NumVar, draw: random.Random) -> int:
    return draw.randint(var.low, var.high)


def _within(var: NumVar, value: float) -> int:
    whole = round(value)
    return var.low if whole < var.low else var.high if whole > var.high else whole


_LIKES: weakref.WeakKeyDictionary[TransitionSystem, dict[AnyUnit, list[Like]]] = weakref.WeakKeyDictionary()


def _likes(system: TransitionSystem) -> dict[AnyUnit, list[Like]]:
    """Return, for each unit of inputs, the state variables whose values an input of this unit may repeat."""
    if system not in _LIKES:
        _LIKES[system] = {
            unit: [
                (other, *_factor(other.unit, unit).as_integer_ratio())
                for other in system.state
                if isinstance(other, NumVar) and _same_dimension(other.unit, unit)
            ]
            for unit in {var.unit for var in system.inputs if isinstance(var, NumVar)}
        }
    return _LIKES[system]


def _same_dimension(one: AnyUnit, other: AnyUnit) -> bool:
    if isinstance(one, Enumeration) or isinstance(other, Enumeration):
        return False
    return one.dimension == other.dimension


def _factor(one: AnyUnit, other: AnyUnit) -> Fraction:
    assert not isinstance(one, Enumeration) and not isinstance(other, Enumeration)
    return one.scale / other.scale
