"""The selection of least cost that satisfies demands, with a lower bound that anybody can add up.

A demand is a clause: one of these options is chosen, or one of those is not. HiGHS (through scipy) finds the selection and a weight
for each demand, the dual of the linear relaxation. Neither is trusted: a selection is checked by its demands and by the audit, and
`bound` adds the weights up in whole fractions; any weights give a bound. Where the relaxation leaves a gap, the provers are asked
whether a cheaper selection exists (`none_cheaper`).
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import Any

from safeloc.codegen.smtlib import Query, to_smtlib
from safeloc.errors import EngineError, InputError
from safeloc.language.expr import Bool, BoolVar, Num, any_of, as_num, boolean, ite
from safeloc.language.units import COUNT
from safeloc.proof.provers.implication import unproved
from safeloc.proof.provers.recheck import recheck

_PARTS = 2_520
"""Weights are rounded down to this part of the unit of costs; the bound loses less than one unit for some thousand demands."""
_INFEASIBLE, _FOUND = 2, 0


@dataclass(frozen=True)
class Demand:
    """One of the options `any_of` is chosen, or one of the options `unless` is not."""

    any_of: frozenset[int]
    unless: frozenset[int] = frozenset()

    def holds(self, chosen: frozenset[int]) -> bool:
        """Return whether a selection satisfies the demand."""
        return bool(self.any_of & chosen) or not self.unless <= chosen


@dataclass(frozen=True)
class AtMost:
    """No more than so many of these options are chosen."""

    number: int
    of: frozenset[int]


def least(
    costs: Sequence[int],
    demands: Sequence[Demand],
    seconds: float = 60.0,
    gap: float = 0.0,
    at_most: AtMost | None = None,
) -> frozenset[int] | None:
    """Return a selection of least cost; None if no selection satisfies all demands. EngineError within the limit without an answer.

    gap      share of its cost by which the selection may be dearer than need be
    at_most  how many of some options may be chosen
    """
    optimize, numpy = _scipy()
    kept = [one for one in demands if not one.any_of & one.unless]
    if not kept:
        return frozenset()
    if not costs:
        return frozenset() if all(one.holds(frozenset()) for one in kept) else None
    rows = [optimize.LinearConstraint(_matrix(kept, len(costs)), [1 - len(one.unless) for one in kept])]
    if at_most is not None:
        those = [[1.0 if number in at_most.of else 0.0 for number in range(len(costs))]]
        rows.append(optimize.LinearConstraint(those, ub=at_most.number))
    every = numpy.ones(len(costs))
    found = optimize.milp(
        numpy.array(costs, dtype=float), constraints=rows, integrality=every, bounds=optimize.Bounds(0, 1),
        options={"time_limit": seconds, "mip_rel_gap": gap},
    )  # fmt: skip
    if found.status == _INFEASIBLE:
        return None
    if found.status != _FOUND:
        raise EngineError(f"no selection of least cost was found within {seconds:g} s: {found.message}")
    chosen = frozenset(number for number, value in enumerate(found.x) if value > 0.5)
    too_many = at_most is not None and len(at_most.of & chosen) > at_most.number
    if too_many or not all(one.holds(chosen) for one in kept):
        raise EngineError("the solver's selection breaks a demand; it cannot be used.")
    return chosen


def weights(costs: Sequence[int], demands: Sequence[Demand]) -> dict[Demand, Fraction]:
    """Return a weight for each demand that makes `bound` about as great as the linear relaxation allows; those of 0 are left out."""
    optimize, numpy = _scipy()
    kept = [one for one in dict.fromkeys(demands) if not one.any_of & one.unless]
    if not kept or not costs:
        return {}
    found = optimize.linprog(
        numpy.array(costs, dtype=float), A_ub=-_matrix(kept, len(costs)), b_ub=[len(one.unless) - 1 for one in kept],
        bounds=(0, 1), method="highs",
    )  # fmt: skip
    if found.status != _FOUND:
        return {}
    marginals = (Fraction(int(max(0.0, -value) * _PARTS), _PARTS) for value in found.ineqlin.marginals)
    return {one: weight for one, weight in zip(kept, marginals, strict=True) if weight}


def bound(costs: Sequence[int], weighted: Mapping[Demand, Fraction]) -> Fraction:
    """Return a cost below which no selection satisfies these demands; any weights that are not negative give one.

    Each demand, taken as often as its weight says, asks for its weight of chosen options, less what may be unmet because an option is
    not chosen. What an option meets beyond its cost is taken off.
    """
    if any(weight < 0 for weight in weighted.values()):
        raise ValueError("weights of demands must not be negative")
    load = [Fraction(0)] * len(costs)
    total = Fraction(0)
    for one, weight in weighted.items():
        total += weight * (1 - len(one.unless))
        for index in one.any_of:
            load[index] += weight
        for index in one.unless:
            load[index] -= weight
    over = (max(met - cost, Fraction(0)) for met, cost in zip(load, costs, strict=True))
    return total - sum(over, Fraction(0))


def none_cheaper(
    costs: Sequence[int], demands: Sequence[Demand], cost: int, seconds: float, at_most: AtMost | None = None
) -> bool:
    """Return whether z3 proves that no selection that satisfies the demands costs less, and a second solver confirms it."""
    options = [boolean(f"option_{number}") for number in range(len(costs))]
    given = [_term(one, options) for one in demands]
    if at_most is not None:
        given.append(_sum([int(number in at_most.of) for number in range(len(costs))], options) <= at_most.number)
    query = Query("no cheaper selection", given, {"": _sum(costs, options) >= cost})
    if unproved(query, seconds):
        return False
    return recheck("no cheaper selection", to_smtlib(query), 1, seconds=seconds) == ["unsat"]


def _term(one: Demand, options: Sequence[BoolVar]) -> Bool:
    return any_of([*(options[n] for n in sorted(one.any_of)), *(~options[n] for n in sorted(one.unless))])


def _sum(costs: Sequence[int], options: Sequence[BoolVar]) -> Num:
    total = as_num(0, COUNT)
    for cost, option in zip(costs, options, strict=True):
        total += ite(option, as_num(cost, COUNT), as_num(0, COUNT))
    return total


def _matrix(demands: Sequence[Demand], options: int) -> Any:
    """Return the rows of the demands: 1 for an option that is asked for, -1 for one that has to be chosen for it to ask."""
    from scipy import sparse  # an optional package

    array: Any = sparse.csr_array

    entries = [(row, index, 1) for row, one in enumerate(demands) for index in one.any_of]
    entries += [(row, index, -1) for row, one in enumerate(demands) for index in one.unless]
    rows, columns, values = zip(*entries, strict=True) if entries else ((), (), ())
    return array((values, (rows, columns)), shape=(len(demands), options), dtype=float)


def _scipy() -> tuple[Any, Any]:
    """Return scipy's optimisers and numpy. InputError without scipy."""
    try:
        import numpy
        from scipy import optimize
    except ImportError as error:
        raise InputError("designing a line needs scipy: pip install safeloc[design]") from error
    return optimize, numpy
