"""Segments of one variable in which a condition holds, and the distance to its failure: guidance for searches.

Condition(term).segments(var, values)   the intervals of values of `var` for which it holds, the rest held fixed
Slack(term)(values)                     the least numeric distance to failing
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from operator import itemgetter

from safeloc.codegen.compiled import compile_terms
from safeloc.language.expr import Bool, Expr, NumVar, Var
from safeloc.language.interpret import Program, evaluate
from safeloc.language.nodes import Add, And, Compare, Lit, Mul, Not, Num, Or, Sub, Truth, Value
from safeloc.language.terms import children, conjuncts, in_order, variables
from safeloc.language.units import ONE

Segment = tuple[int, int]


class Condition:
    """A compiled condition: evaluates it, and finds where it changes along a variable."""

    def __init__(self, term: Bool) -> None:
        self.term = term
        self.reads: dict[Var, int] = {var: place for place, var in enumerate(variables([term]))}
        self._row = _row_of(tuple(self.reads))
        self._below = _variables_below(term)
        self._compares = [node for node in self._below if isinstance(node, Compare)]
        self._along: dict[Var, _Along] = {}
        self._truth = compiled_terms(tuple(self.reads), [term])

    def holds(self, values: Mapping[Var, Value]) -> bool:
        """Return whether the condition is true for the values."""
        return bool(self._truth(self._row(values))[0])

    def segments(self, var: NumVar, values: Mapping[Var, Value]) -> list[Segment]:
        """Return intervals of values of `var` for which the condition holds, in order; the other variables stay as they
        are.

        Comparisons are taken as linear between two neighbouring probes. If one is not, an interval may lack values or have wrong
        ones, so the caller has to check the condition again.
        """
        row = list(self._row(values))
        at = self.reads[var]
        if var not in self._along:
            self._along[var] = _along(var, tuple(self.reads), self._compares, self._below)
        begins = sorted({var.low, *self._along[var].cuts(row, at)})
        ends = [*(begin - 1 for begin in begins[1:]), var.high]
        pieces = zip(begins, ends, strict=True)
        return _joined([(low, high) for low, high in pieces if self._is_true(row, at, (low + high) // 2)])

    def _is_true(self, row: list[Value], at: int, value: int) -> bool:
        row[at] = value
        return bool(self._truth(row)[0])


@dataclass(frozen=True, eq=False)
class _Along:
    """The comparisons of a condition that read one variable.

    straight  right side minus left side, of the comparisons that are linear in the variable
    kinds     of each of these its operator, and how much the difference grows when the variable grows by 1
    bent      left side and right side of the other comparisons, in turn
    """

    var: NumVar
    straight: Callable[[Sequence[Value]], Sequence[Value]]
    kinds: tuple[tuple[str, int], ...]
    bent: Callable[[Sequence[Value]], Sequence[Value]] | None

    def cuts(self, row: list[Value], at: int) -> set[int]:
        """Return the values of the variable from which on a comparison may differ from the value before; the row is unchanged
        afterwards.

        They are exact for linear comparisons. Of the others all values near an estimated root are such values.
        """
        low, high, here = self.var.low, self.var.high, int(row[at])
        found = set[int]()
        if self.kinds:
            for gap, (op, slope) in zip(self.straight(row), self.kinds, strict=True):
                found.update(_flips(here, int(gap), op, slope))
        if self.bent is not None:
            found.update((low + 1, high))
            for probe, step in ((low, 1), (high, -1), (here, 1 if here < high else -1)):
                for root in _roots(self.bent, row, at, probe, step):
                    found.update((root - 1, root, root + 1, root + 2))
            row[at] = here
        return {cut for cut in found if low < cut <= high}


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


def _along(
    var: NumVar, reads: tuple[Var, ...], compares: Sequence[Compare], below: Mapping[Expr, frozenset[Var]]
) -> _Along:
    reading = [node for node in compares if var in below[node]]
    gaps = {node: Sub(node.right, node.left, ONE) for node in reading}
    slopes = {node: _slope(gap, var, below) for node, gap in gaps.items()}
    bent = [side for node in reading if slopes[node] is None for side in (node.left, node.right)]
    return _Along(
        var,
        compiled_terms(reads, [gaps[node] for node, grows in slopes.items() if grows]),
        tuple((node.op, grows) for node, grows in slopes.items() if grows),
        compiled_terms(reads, bent) if bent else None,
    )


def _slope(term: Num, var: NumVar, below: Mapping[Expr, frozenset[Var]]) -> int | None:
    """Return how much a term grows when the variable grows by 1; None if that depends on the values."""
    match term:
        case NumVar():
            return int(term is var)
        case Add(left, right) | Sub(left, right):
            first, second = _slope(left, var, below), _slope(right, var, below)
            if first is None or second is None:
                return None
            return first + second if isinstance(term, Add) else first - second
        case Mul(Lit(factor), inner) | Mul(inner, Lit(factor)):
            grows = _slope(inner, var, below)
            return None if grows is None else factor * grows
        case _:
            return None if var in below[term] else 0


def _row_of(reads: Sequence[Var]) -> Callable[[Mapping[Var, Value]], Sequence[Value]]:
    """Return a function for the values of `reads`, in order; `itemgetter` gives no sequence for fewer than two."""
    if len(reads) > 1:
        return itemgetter(*reads)
    return lambda values: [values[var] for var in reads]


def compiled_terms(reads: tuple[Var, ...], terms: Sequence[Expr]) -> Callable[[Sequence[Value]], Sequence[Value]]:
    """Compile the terms to a function of a row of values of `reads`; without case analysis, so this is quick."""
    if not reads:
        constants = evaluate(terms, {})
        return lambda _row: constants
    return compile_terms(reads, terms)


def _roots(
    sides: Callable[[Sequence[Value]], Sequence[Value]], row: list[Value], at: int, probe: int, step: int
) -> Iterable[int]:
    """Estimate the roots of each comparison from the slope at the probe."""
    row[at] = probe
    first = sides(row)
    row[at] = probe + step
    second = sides(row)
    for n in range(0, len(first), 2):
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
    pairs = [(max(a[0], b[0]), min(a[1], b[1])) for a in first for b in second]
    return [(low, high) for low, high in pairs if low <= high]


def falsifiable(term: Bool) -> list[Bool]:
    """Return the parts of a conjunction that may be false."""
    return [part for part in conjuncts(term) if not (isinstance(part, Truth) and part.value)]


class Slack:
    """The distance of a term from being false: the least numeric distance, negative once false, infinite if logical."""

    def __init__(self, term: Bool) -> None:
        self._term = term
        self._reads = [side for leaf in _leaves(term) for side in _sides(leaf)]
        self._program = Program(self._reads)

    def __call__(self, values: Mapping[Var, Value]) -> float:
        """Return the distance under these values."""
        return _slack(self._term, dict(zip(self._reads, self._program(values), strict=True)))


def _leaves(term: Bool) -> Iterable[Bool]:
    """Return the parts of conjunctions and disjunctions that are themselves neither."""
    if isinstance(term, (And, Or)):
        return [leaf for part in term.parts for leaf in _leaves(part)]
    return [term]


def _sides(leaf: Bool) -> Sequence[Expr]:
    """Return the terms whose values determine how far a leaf is from failing."""
    match leaf:
        case Compare(_, a, b) | Not(Compare("<" | "<=", a, b)):
            return (a, b)
        case _:
            return (leaf,)


def _slack(term: Bool, found: Mapping[Expr, Value]) -> float:
    match term:
        case Compare(op, a, b):
            left, right = found[a], found[b]
            return {"==": -abs(left - right), "<": right - left - 1, "<=": right - left}[op]
        case And(parts):
            return min(_slack(part, found) for part in parts)
        case Or(parts):
            return max(_slack(part, found) for part in parts)
        case Not(Compare("<", a, b)):
            return float(found[a] - found[b])
        case Not(Compare("<=", a, b)):
            return float(found[a] - found[b] - 1)
        case _:
            return float("inf") if found[term] else float("-inf")
