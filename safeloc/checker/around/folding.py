"""Terms with their variables replaced, in which all is folded away that the bounds of variables decide.

A term and its folded form have the same value for all values of the variables within their bounds. Whoever uses a folded
term must therefore have these bounds among the hypotheses.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import product
from operator import add, sub

from safeloc.checker.dag import INT, Dag

Bounds = tuple[int, int]
Sum = tuple[int, Mapping[int, int]]
"""A constant, and the factor of each atom."""
_MOST_ATOMS, _MOST_VALUES = 40, 16


class Folding:
    """Bounds of the terms of one Dag, and terms made with them."""

    def __init__(self, dag: Dag) -> None:
        self.dag = dag
        self.bounds: dict[int, Bounds] = {}
        self._sums: dict[int, Sum] = {}
        self._values: dict[int, frozenset[int]] = {}

    def variable(self, name: str, sort: str, bounds: Bounds | None) -> int:
        """Return a new variable; one of a number has bounds, which are a hypothesis of everything that reads it."""
        made = self.dag.variable(name, sort)
        if bounds is not None:
            self.bounds[made], self._sums[made] = bounds, (0, {made: 1})
        return made

    def number(self, value: int) -> int:
        """Return a whole number."""
        return self.with_bounds(self.dag.number(value))

    def replacing(self, replaced: Mapping[int, int]) -> Replacing:
        """Return what replaces variables by these folded terms."""
        return Replacing(self, replaced)

    def make(self, operator: str, parts: list[int]) -> int:
        """Return the operator applied to folded operands."""
        if operator in ("<", "<=", ">=", "="):
            decided = self._decided(operator, *parts)
            return self.dag.make(operator, parts) if decided is None else self.dag.truth[decided]
        if operator == "ite" and parts[1] == parts[2]:
            return parts[1]
        if operator in ("and", "or"):
            parts = list(dict.fromkeys(parts))
        constant = self._constant(operator, parts)
        return self.with_bounds(self.dag.make(operator, parts) if constant is None else constant)

    def _constant(self, operator: str, parts: list[int]) -> int | None:
        """Return the number that arithmetic on numbers gives, and a sum with nothing as its other part."""
        values = [self.dag.nodes[part][1] if self.dag.nodes[part][0] == "lit" else None for part in parts]
        if operator not in ("+", "-", "*", "div"):
            return None
        if None not in values:
            one, other = map(int, values)  # type: ignore[arg-type] # none of them is None
            return self.dag.number(
                one // other
                if operator == "div"
                else one * other
                if operator == "*"
                else (add if operator == "+" else sub)(one, other)
            )
        if operator in ("+", "-") and values[1] == 0:
            return parts[0]
        return parts[1] if operator == "+" and values[0] == 0 else None

    # -------------------------------------------------------------- bounds

    def with_bounds(self, node: int) -> int:
        """Return the node; if it is a number, its bounds are known from now on."""
        if node not in self.bounds and self.dag.sort(node) == INT:
            total = self._sum(node)
            low, high = self._of_parts(node)
            if total is not None:
                least, most = self._of_sum(total)
                low, high = max(low, least), min(high, most)
            self.bounds[node] = low, high
            self._sums[node] = (0, {node: 1}) if total is None or len(total[1]) > _MOST_ATOMS else total
            self._values[node] = self._few_values(node)
        return node

    def _of_parts(self, node: int) -> Bounds:
        """Return the bounds that follow from those of the operands."""
        operator, *rest = self.dag.nodes[node]
        if operator == "lit":
            return int(rest[0]), int(rest[0])
        parts = [self.bounds[part] for part in self.dag.parts(node) if part in self.bounds]
        (low, high), (least, most) = parts[0], parts[1]
        match operator:
            case "+":
                return low + least, high + most
            case "-":
                return low - most, high - least
            case "ite":
                return min(low, least), max(high, most)
            case "*":
                ends = [one * other for one, other in product((low, high), (least, most))]
                return min(ends), max(ends)
            case "div" if least == most > 0:
                return low // least, high // least
            case _:
                raise ValueError(f"no bounds of {operator}")

    def _sum(self, node: int) -> Sum | None:
        operator, *rest = self.dag.nodes[node]
        if operator == "lit":
            return int(rest[0]), {}
        if operator in ("+", "-"):
            one, other = self.dag.parts(node)
            return _plus(self._sums[one], self._sums[other], 1 if operator == "+" else -1)
        if operator == "*":
            for factor, of in (self.dag.parts(node), self.dag.parts(node)[::-1]):
                if self.dag.nodes[factor][0] == "lit":
                    return _plus((0, {}), self._sums[of], int(self.dag.nodes[factor][1]))
        return None

    def _of_sum(self, total: Sum) -> Bounds:
        low = high = total[0]
        for atom, factor in total[1].items():
            ends = [factor * end for end in self.bounds[atom]]
            low, high = low + min(ends), high + max(ends)
        return low, high

    def _few_values(self, node: int) -> frozenset[int]:
        """Return the values of a number, and of a choice among a few numbers; empty if there are others."""
        operator, *rest = self.dag.nodes[node]
        if operator == "lit":
            return frozenset([int(rest[0])])
        if operator != "ite":
            return frozenset()
        then, other = (self._values.get(part, frozenset()) for part in self.dag.parts(node)[1:])
        both = then | other
        return both if then and other and len(both) <= _MOST_VALUES else frozenset()

    def _decided(self, operator: str, one: int, other: int) -> bool | None:
        """Return whether a comparison holds for all values within the bounds (True), for none (False), or for some (None)."""
        if one not in self.bounds:
            return None  # two truths are compared
        low, high = self._of_sum(_plus(self._sums[one], self._sums[other], -1))
        low, high = (
            max(low, self.bounds[one][0] - self.bounds[other][1]),
            min(high, self.bounds[one][1] - self.bounds[other][0]),
        )
        if operator == "<":
            return True if high < 0 else False if low >= 0 else None
        if operator == "<=":
            return True if high <= 0 else False if low > 0 else None
        if operator == ">=":
            return True if low >= 0 else False if high < 0 else None
        few, more = self._values.get(one), self._values.get(other)
        if low > 0 or high < 0 or (few and more and few.isdisjoint(more)):
            return False
        return True if low == high == 0 else None


class Replacing:
    """Replaces the variables of terms; of a choice that the bounds decide it visits the chosen side only."""

    def __init__(self, folding: Folding, replaced: Mapping[int, int]) -> None:
        self._folding, self._dag, self._done = folding, folding.dag, dict(replaced)

    def __call__(self, term: int) -> int:
        """Return a term with its variables replaced. ValueError for a variable that has no replacement."""
        stack = [term]
        while stack:
            node = stack[-1]
            waits = [] if node in self._done else [part for part in self._read(node) if part not in self._done]
            if waits:
                stack += waits
                continue
            stack.pop()
            if node not in self._done:
                self._done[node] = self._made(node)
        return self._done[term]

    def conjuncts(self, term: int) -> list[int]:
        """Return the parts of a condition that bounds do not decide; the constant false among them, if one is false."""
        parts = self._dag.conjuncts([term])
        return sorted(self._dag.conjuncts(self(part) for part in parts))

    def _read(self, node: int) -> Sequence[int]:
        parts = self._dag.parts(node)
        if self._dag.nodes[node][0] != "ite":
            return parts
        decided = self._decided(parts[0])
        return (
            parts[:1] if parts[0] not in self._done else parts[1:] if decided is None else (parts[1 if decided else 2],)
        )

    def _decided(self, condition: int) -> bool | None:
        truth = self._dag.truth
        return {truth[True]: True, truth[False]: False}.get(self._done.get(condition, -1))

    def _made(self, node: int) -> int:
        operator, *_ = self._dag.nodes[node]
        if operator == "var":
            raise ValueError(f"{self._dag.nodes[node][1]} has no value")
        parts = self._dag.parts(node)
        if not parts:
            return self._folding.with_bounds(node)
        decided = self._decided(parts[0]) if operator == "ite" else None
        if decided is not None:
            return self._done[parts[1 if decided else 2]]
        return self._folding.make(str(operator), [self._done[part] for part in parts])


def _plus(one: Sum, other: Sum, factor: int) -> Sum:
    """Return a sum plus a multiple of another."""
    atoms = dict(one[1])
    for atom, times in other[1].items():
        atoms[atom] = atoms.get(atom, 0) + factor * times
    return one[0] + factor * other[0], {atom: times for atom, times in atoms.items() if times}
