"""Repair of drawn inputs, so that they satisfy a machine's assumption.

One input after another is moved to an end of the segments in which the broken part of the assumption holds together with
every other part that reads the input. Mostly this is an input that the environment chooses freely, else a measurement. If
no single move is enough, the broken part alone is repaired and the others follow, or the measurement is left out of the
step.
"""

from __future__ import annotations

import random
import weakref
from collections.abc import Callable, Iterable, Mapping, Sequence
from itertools import combinations

from safeloc.errors import InputError
from safeloc.language.expr import BoolVar, Lit, NumVar, Var
from safeloc.language.interpret import start
from safeloc.language.machine import Any_
from safeloc.language.nodes import Value
from safeloc.language.system import TransitionSystem, canonical
from safeloc.proof.drawn_runs.allowed import Allowed, Condition, Together
from safeloc.proof.drawn_runs.linear import Segment
from safeloc.proof.drawn_runs.parts import falsifiable

_REPAIRS, _REPAIRS_A_PART = 40, 3
"""Attempts to repair a step: so many, and so many for each part that is broken at first."""
ATTEMPTS = 5
_GHOSTS_FIRST = 0.8
_LINEAR_FIRST = 0.9
_PATIENCE = 0.5
"""Share of the first attempts without success after which no truth value is changed, such as the presence of a measurement."""
Pick = Callable[[NumVar, int, int], int]


def any_end(draw: random.Random) -> Pick:
    """Return a choice that takes either end of the allowed interval, or a value inside."""
    return lambda _var, low, high: draw.choice((low, high, draw.randint(low, high)))


class NoFirstStateError(InputError):
    """No values were found that satisfy `initially`."""


class Repair:
    """Changes inputs until the assumption holds."""

    def __init__(self, system: TransitionSystem) -> None:
        self._system = system
        self._conditions = [Condition(part) for part in falsifiable(system.assume)]
        inputs = set(system.inputs)
        self._present = {option.value: option.present for option in system.optionals}
        self._value = {option.present: option.value for option in system.optionals}
        self._free = {c: [var for var in c.reads if var in inputs] for c in self._conditions}
        self._all = Together(self._conditions)
        self._readers = {var: Together([c for c in self._conditions if var in c.reads]) for var in system.inputs}
        self._along = dict[NumVar, Allowed]()

    def mend(
        self, state: Mapping[Var, Value], inputs: Mapping[Var, Value], draw: random.Random, pick: Pick | None = None
    ) -> dict[Var, Value] | None:
        """Find inputs that satisfy the assumption, or None. `pick` chooses within the allowed values."""
        pick = pick or any_end(draw)
        values = {**state, **inputs}
        broken = dict.fromkeys(
            one for one, kept in zip(self._conditions, self._all.holds(values), strict=True) if not kept
        )
        most = _REPAIRS + _REPAIRS_A_PART * len(broken)
        for attempt in range(most):
            if not broken:
                return {var: values[var] for var in self._system.inputs}
            for var in self._mend_one(
                draw.choice(list(broken)), values, draw, pick, patience=_PATIENCE * (1 - attempt / most)
            ):
                readers = self._readers[var]
                for one, kept in zip(readers.conditions, readers.holds(values), strict=True):
                    if kept:
                        broken.pop(one, None)
                    else:
                        broken[one] = None
        return None

    def _mend_one(
        self, broken: Condition, values: dict[Var, Value], draw: random.Random, pick: Pick, patience: float
    ) -> Sequence[Var]:
        """Repair one broken part; return the variables that were changed."""
        candidates = self._ordered(broken, values, draw)
        for var in candidates:
            allowed = self._allowed(var, broken, values, draw)
            if allowed:
                values[var] = pick(var, *draw.choice(allowed))
                return [var]
        left_out = self._leave_out(broken, values, draw) if draw.random() > patience else []
        if left_out:
            return left_out
        for var in candidates:
            allowed = broken.segments(var, values)
            if allowed:
                values[var] = pick(var, *draw.choice(allowed))
                return [var]
        return []

    def _ordered(self, broken: Condition, values: Mapping[Var, Value], draw: random.Random) -> list[NumVar]:
        """Return the numeric inputs that the part reads, in the order to try, without those that are absent.

        Mostly those come first in which the part is linear: what lies further behind a long term seldom mends it.
        """
        numbers = [var for var in self._free[broken] if isinstance(var, NumVar)]
        usable = [var for var in numbers if var not in self._present or values[self._present[var]]]
        mixed = draw.sample(usable, len(usable))
        ghosts_first = draw.random() < _GHOSTS_FIRST
        linear_first = draw.random() < _LINEAR_FIRST
        return sorted(
            mixed,
            key=lambda var: (
                linear_first and broken.straight(var) is None,
                (var not in self._system.ghosts) == ghosts_first,
            ),
        )

    def _allowed(
        self, var: NumVar, broken: Condition, values: Mapping[Var, Value], draw: random.Random
    ) -> Sequence[Segment]:
        """Return segments of `var`, or some of them, in which every part that reads it holds, the broken one too."""
        if var not in self._along:
            self._along[var] = Allowed(var, self._readers[var].conditions)
        return self._along[var].some(values, draw, broken)

    def _leave_out(self, broken: Condition, values: dict[Var, Value], draw: random.Random) -> Sequence[Var]:
        """Flip one or two truth values, such as the presence of a measurement, so that the broken part holds.

        Return the changed variables.
        """
        flags = [var for var in self._free[broken] if isinstance(var, BoolVar)]
        mixed = draw.sample(flags, len(flags))
        for some in (*((one,) for one in mixed), *combinations(mixed, 2)):
            changed = {var: value for flag in some for var, value in self._other(flag, values).items()}
            before = {var: values[var] for var in changed}
            values.update(changed)
            if broken.holds(values):
                return list(changed)
            values.update(before)
        return []

    def _other(self, flag: BoolVar, values: Mapping[Var, Value]) -> dict[Var, Value]:
        """Return the opposite truth value; a value whose presence it flips becomes canonical."""
        changed: dict[Var, Value] = {flag: not values[flag]}
        if flag in self._value:
            changed[self._value[flag]] = canonical(self._value[flag])
        return changed


def begins(system: TransitionSystem, first: Mapping[str, Value]) -> bool:
    """Return whether `first` is a possible first state of the system, so that `initially` holds in it."""
    try:
        start(system, first)
    except InputError:
        return False
    return True


_FIRST: weakref.WeakKeyDictionary[TransitionSystem, list[Condition]] = weakref.WeakKeyDictionary()


def first_state(system: TransitionSystem, draw: random.Random, *, adventurous: float = 0.0) -> dict[str, Value]:
    """Return values for the open initial variables such that `initially` holds; NoFirstStateError if none were found.

    adventurous: the share of variables that begin at an end of their range instead of near zero
    """
    free = [var for var in system.state if isinstance(system.initial[var], Any_)]
    if system not in _FIRST:
        _FIRST[system] = [Condition(part) for part in falsifiable(system.init)]
    conditions = _FIRST[system]
    for attempt in range(ATTEMPTS):
        share = adventurous * (1 - attempt / (ATTEMPTS - 1))
        values = {var: _first_value(system, var, draw, share) for var in system.state}
        if _mended(conditions, free, values, draw):
            return {var.name: values[var] for var in free}
    raise NoFirstStateError(f"{system.name}: no first state found that satisfies `initially`; give one explicitly.")


def _mended(
    conditions: Sequence[Condition], free: Sequence[Var], values: dict[Var, Value], draw: random.Random
) -> bool:
    """Repair the values; return whether they then satisfy every condition."""
    for _ in range(_REPAIRS):
        broken = [one for one in conditions if not one.holds(values)]
        if not broken:
            return True
        for one in broken:
            _mend_first(one, free, values, draw)
    return False


def _first_value(system: TransitionSystem, var: Var, draw: random.Random, adventurous: float) -> Value:
    declared = system.initial[var]
    if not isinstance(declared, Any_):
        return declared.value if isinstance(declared, Lit) else declared
    if isinstance(var, BoolVar):
        return draw.random() < 0.5
    return draw.choice((var.low, var.high)) if draw.random() < adventurous else canonical(var)


def _mend_first(broken: Condition, free: Iterable[Var], values: dict[Var, Value], draw: random.Random) -> None:
    candidates = [var for var in free if var in broken.reads]
    for var in draw.sample(candidates, len(candidates)):
        if isinstance(var, BoolVar):
            values[var] = not values[var]
            return
        allowed = broken.segments(var, values)
        if allowed:
            values[var] = draw.choice(draw.choice(allowed))
            return
