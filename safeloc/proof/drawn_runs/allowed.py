"""Segments of one variable in which conditions hold: guidance for searches.

Condition(term).segments(var, values)   the intervals of values of `var` for which it holds, the rest held fixed
Allowed(var, conditions).segments(values)   the same of several conditions at once
"""

from __future__ import annotations

import random
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import accumulate
from operator import itemgetter

from safeloc.codegen.compiled import compile_terms
from safeloc.language.expr import Bool, Expr, NumVar, Var
from safeloc.language.interpret import evaluate
from safeloc.language.nodes import Compare, Lit, Num, Value
from safeloc.language.terms import children, in_order, variables
from safeloc.proof.drawn_runs.linear import Segment, Straight, slope_of_gap, straight_of

_Code = Callable[[Sequence[Value]], Sequence[Value]]
"""A compiled function of a row of values."""
_FEW = 3
_TRIED = 0.95
"""Share of the searches that first try a few values."""
_GIVEN_UP = 0.95
"""Share of those without success that end there: another variable may do, or the next attempt."""


class Condition:
    """A compiled condition: evaluates it, and finds where it changes along a variable."""

    def __init__(self, term: Bool) -> None:
        self.term = term
        self.reads: dict[Var, int] = {var: place for place, var in enumerate(variables([term]))}
        self._row = row_of(tuple(self.reads))
        self._below = _variables_below(term)
        self._compares = [node for node in self._below if isinstance(node, Compare)]
        self._along: dict[Var, _Along] = {}
        self._straight: dict[Var, Allowed] = {}
        self._kinds: dict[Var, Straight | None] = {}

    @cached_property
    def _truth(self) -> _Code:
        return compiled_terms(tuple(self.reads), [self.term])

    @cached_property
    def _sides(self) -> _Code:
        """The sides of all comparisons in turn. To compile those that read one variable, for each variable, takes longer than to
        evaluate all of them as often as most are asked for."""
        return compiled_terms(tuple(self.reads), [side for one in self._compares for side in (one.left, one.right)])

    def holds(self, values: Mapping[Var, Value]) -> bool:
        """Return whether the condition is true for the values."""
        return bool(self._truth(self._row(values))[0])

    def segments(self, var: NumVar, values: Mapping[Var, Value], within: Segment | None = None) -> list[Segment]:
        """Return intervals of values of `var`, or of those `within`, for which the condition holds, in order; the other variables
        stay as they are.

        Comparisons are taken as linear between two neighbouring probes. If one is not, an interval may lack values or have wrong
        ones, so the caller has to check the condition again.
        """
        if var not in self._along and var not in self._straight:
            if self.straight(var) is None:
                self._along[var] = _along(var, self._compares, self._below)
            else:
                self._straight[var] = Allowed(var, [self])
        if var in self._straight:
            return list(self._straight[var].segments(values, within))
        along = self._along[var]
        row = list(self._row(values))
        at = self.reads[var]
        low, high = within or (var.low, var.high)
        begins = sorted({low, *(cut for cut in along.cuts(self._sides, row, at) if low < cut <= high)})
        ends = [*(begin - 1 for begin in begins[1:]), high]
        pieces = zip(begins, ends, strict=True)
        return _joined([(low, high) for low, high in pieces if self._is_true(row, at, (low + high) // 2)])

    def straight(self, var: NumVar) -> Straight | None:
        """Return the condition as a disjunction of comparisons linear in the variable; None if it is none."""
        if var not in self._kinds:
            self._kinds[var] = straight_of(var, self.term, self._below)
        return self._kinds[var]

    def _is_true(self, row: list[Value], at: int, value: int) -> bool:
        row[at] = value
        return bool(self._truth(row)[0])


class Together:
    """Conditions that are evaluated at once, as one function that is compiled when it is first needed."""

    def __init__(self, conditions: Sequence[Condition]) -> None:
        self.conditions = conditions

    @cached_property
    def _code(
        self,
    ) -> tuple[Callable[[Mapping[Var, Value]], Sequence[Value]], _Code]:
        reads = tuple(dict.fromkeys(var for one in self.conditions for var in one.reads))
        return row_of(reads), compiled_terms(reads, [one.term for one in self.conditions])

    def holds(self, values: Mapping[Var, Value]) -> Sequence[Value]:
        """Return the truth of each condition for the values."""
        row, code = self._code
        return code(row(values))


class Allowed:
    """The values of one variable that several conditions allow at once."""

    def __init__(self, var: NumVar, conditions: Sequence[Condition]) -> None:
        self._var = var
        kinds = [one.straight(var) for one in conditions]
        straight = [kind for kind in kinds if kind is not None]
        self._bent = [one for one, kind in zip(conditions, kinds, strict=True) if kind is None]
        terms = [part for kind in straight for part in kind.parts]
        places = accumulate((len(kind.parts) for kind in straight), initial=0)
        self._straight = list(zip(straight, places, strict=False))
        reads = tuple(variables(terms))
        self._row, self._code = row_of(reads), compiled_terms(reads, terms)
        self._together = Together(self._bent)

    def some(
        self, values: Mapping[Var, Value], draw: random.Random, broken: Condition | None = None
    ) -> Sequence[Segment]:
        """Return some values for which all conditions hold, each as a segment, or all intervals of them; empty if none were found.

        Mostly only a few values are tried, at the ends of what the linear conditions allow and within: to find where the others hold
        takes much longer. `broken`, one of the conditions, is asked first: most variables cannot mend it, whatever the others say.
        """
        found = self._straight_segments(values, (self._var.low, self._var.high))
        if not found or not self._bent:
            return found
        if draw.random() < _TRIED:
            low, high = draw.choice(found)
            trial = dict(values)
            kept = list[Segment]()
            for value in sorted({low, high, draw.randint(low, high)}):
                trial[self._var] = value
                if (broken is None or broken.holds(trial)) and all(self._together.holds(trial)):
                    kept.append((value, value))
            if kept or draw.random() < _GIVEN_UP:
                return kept
        return self._narrowed(values, found, broken)

    def segments(self, values: Mapping[Var, Value], within: Segment | None = None) -> Sequence[Segment]:
        """Return the intervals, or what of them is `within`, in which all conditions hold, in order; the other variables stay as
        they are.
        """
        return self._narrowed(values, self._straight_segments(values, within or (self._var.low, self._var.high)))

    def _straight_segments(self, values: Mapping[Var, Value], within: Segment) -> Sequence[Segment]:
        here, numbers = int(values[self._var]), self._code(self._row(values))
        found: Sequence[Segment] = (within,)
        for kind, at in self._straight:
            if numbers[at]:
                continue
            kept = kind.segments(numbers, at, here, (found[0][0], found[-1][1]))
            found = kept if len(found) == 1 else common(found, kept)
            if not found:
                return found
        return found

    def _narrowed(
        self, values: Mapping[Var, Value], found: Sequence[Segment], first: Condition | None = None
    ) -> Sequence[Segment]:
        """Return the part of the segments in which the conditions hold that are not linear in the variable; `first` is asked first."""
        for one in sorted(self._bent, key=lambda one: one is not first):
            if not found:
                return found
            if _few(found):
                found = _where(one, self._var, values, found)
            else:
                found = common(found, one.segments(self._var, values, (found[0][0], found[-1][1])))
        return found


def _few(segments: Sequence[Segment]) -> bool:
    """Return whether to try the values in the segments is quicker than to find the segments of one more condition."""
    return sum(high - low + 1 for low, high in segments) <= _FEW


def _where(
    condition: Condition, var: NumVar, values: Mapping[Var, Value], segments: Sequence[Segment]
) -> list[Segment]:
    """Return those of few values for which the condition holds, each as a segment."""
    tried = [value for low, high in segments for value in range(low, high + 1)]
    read = {one: values[one] for one in condition.reads}
    return [(value, value) for value in tried if condition.holds({**read, var: value})]


@dataclass(frozen=True, eq=False)
class _Along:
    """The comparisons of a condition that read one variable, by the places of their left sides among all sides.

    straight  those that are linear in the variable: place, operator, and how much right side minus left side grows when the
              variable grows by 1
    bent      the others
    """

    var: NumVar
    straight: tuple[tuple[int, str, int], ...]
    bent: tuple[int, ...]

    def cuts(self, sides: _Code, row: list[Value], at: int) -> set[int]:
        """Return the values, some beyond the range, from which on a comparison may differ from the value before; the row is unchanged
        afterwards.

        They are exact for linear comparisons. Of the others all values near an estimated root are such values.
        """
        low, high, here = self.var.low, self.var.high, int(row[at])
        found = set[int]()
        if self.straight:
            values = sides(row)
            for place, op, slope in self.straight:
                found.update(_flips(here, int(values[place + 1]) - int(values[place]), op, slope))
        if self.bent:
            found.update((low + 1, high))
            for probe, step in ((low, 1), (high, -1), (here, 1 if here < high else -1)):
                for root in _roots(sides, self.bent, row, at, probe, step):
                    found.update((root - 1, root, root + 1, root + 2))
            row[at] = here
        return found


def _flips(here: int, gap: int, op: str, slope: int) -> tuple[int, ...]:
    """Return the values from which on a comparison has another truth, where its gap at `here` grows by `slope` a step.

    `<` holds where the gap is above 0, `<=` where it is not below, `==` where it is 0.
    """
    steps, rest = divmod(-gap, slope)
    below = here + steps  # the root, or the whole number below it
    if op == "==":
        return () if rest else (below, below + 1)
    return (below + 1,) if rest or (op == "<") == (slope > 0) else (below,)


def _variables_below(term: Expr) -> dict[Expr, frozenset[Var]]:
    """Return the variables below each node of the term, operands first."""
    found: dict[Expr, frozenset[Var]] = {}
    for node in in_order([term]):
        own = frozenset([node]) if isinstance(node, Var) else frozenset[Var]()
        found[node] = own.union(*(found[part] for part in children(node)))
    return found


def _constant(slope: Num | None) -> int | None:
    return slope.value if isinstance(slope, Lit) else None


def _along(var: NumVar, compares: Sequence[Compare], below: Mapping[Expr, frozenset[Var]]) -> _Along:
    reading = {2 * number: node for number, node in enumerate(compares) if var in below[node]}
    slopes = {place: _constant(slope_of_gap(node, var, below)) for place, node in reading.items()}
    return _Along(
        var,
        tuple((place, reading[place].op, grows) for place, grows in slopes.items() if grows),
        tuple(place for place, grows in slopes.items() if grows is None),
    )


def row_of(reads: Sequence[Var]) -> Callable[[Mapping[Var, Value]], Sequence[Value]]:
    """Return a function for the values of `reads`, in order; `itemgetter` gives no sequence for fewer than two."""
    if len(reads) > 1:
        return itemgetter(*reads)
    return lambda values: [values[var] for var in reads]


def compiled_terms(reads: tuple[Var, ...], terms: Sequence[Expr]) -> _Code:
    """Compile the terms to a function of a row of values of `reads`; without case analysis, so this is quick."""
    if not reads:
        constants = evaluate(terms, {})
        return lambda _row: constants
    return compile_terms(reads, terms)


def _roots(sides: _Code, places: Sequence[int], row: list[Value], at: int, probe: int, step: int) -> Iterable[int]:
    """Estimate the roots of each comparison from the slope at the probe."""
    row[at] = probe
    first = sides(row)
    row[at] = probe + step
    second = sides(row)
    for n in places:
        gap = first[n + 1] - first[n]
        slope = (second[n + 1] - second[n] - gap) * step
        if slope:
            yield from _meeting(probe, gap, slope)


def _meeting(here: int, gap: int, slope: int) -> tuple[int, int]:
    """Return the two whole numbers around the point where a gap that changes by `slope` from `here` on is zero."""
    return here - gap // slope, here - -(-gap // slope)


def _joined(pieces: Sequence[Segment]) -> list[Segment]:
    joined: list[Segment] = []
    for low, high in pieces:
        if joined and joined[-1][1] + 1 == low:
            joined[-1] = (joined[-1][0], high)
        else:
            joined.append((low, high))
    return joined


def common(first: Sequence[Segment], second: Sequence[Segment]) -> list[Segment]:
    """Intersect two lists of segments."""
    found = list[Segment]()
    for low, high in first:
        for begin, end in second:
            if begin <= high and low <= end:
                found.append((low if low > begin else begin, high if high < end else end))
    return found
