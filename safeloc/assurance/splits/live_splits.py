"""The case splits of a machine that are live in a configuration, and those that it folds away."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass

from safeloc.assurance.splits.branches import steps_of, taken
from safeloc.assurance.splits.observed import Observed, Split, observe
from safeloc.language.nodes import Compare, Expr, Max, Min, Num
from safeloc.language.ranges import Bounds, bounds
from safeloc.target import Target

_NOT_TAKEN = "no code takes it"
_DECIDED = "the ranges of its variables decide it"


@dataclass(frozen=True, eq=False)
class Splits:
    """The live splits of one configuration, and the dead ones, each with the reason why it is constant."""

    live: frozenset[Split]
    dead: Mapping[Split, str]


def splits_of(make: Callable[[], Target]) -> Splits:
    """Return the splits of the target that `make` builds."""
    _, observed = observe(make)
    _, steps = steps_of(make)
    branches, beside = taken(steps)
    live, dead = _judged(observed)
    return Splits(frozenset(live | branches), {**dead, **dict.fromkeys(beside - branches, _NOT_TAKEN)})


def together(found: Iterable[Splits]) -> Splits:
    """Return the splits of several configurations together: a split that is live in one of them is live."""
    every = list(found)
    live = frozenset().union(*(one.live for one in every))
    dead = {split: why for one in every for split, why in one.dead.items() if split not in live}
    return Splits(live, dead)


def _judged(observed: Observed) -> tuple[set[Split], dict[Split, str]]:
    """Return live and dead splits; one with several terms is live if any of them is."""
    of = bounds([term for terms in observed.live.values() for term in terms])
    live = {split for split, terms in observed.live.items() if any(not _decided(term, of) for term in terms)}
    dead = {split: _DECIDED for split in observed.live if split not in live}
    return live, dead | {split: why for split, why in observed.folded.items() if split not in live}


def _decided(term: Expr, of: Mapping[Num, Bounds]) -> bool:
    """Return whether the ranges of its variables leave only one case."""
    match term:
        case Compare(op, left, right):
            (low, high), (least, most) = of[left], of[right]
            apart = high < least or most < low
            return apart or (op != "==" and (high <= least if op == "<=" else low >= most))
        case Min(left, right, _) | Max(left, right, _):
            (low, high), (least, most) = of[left], of[right]
            return high <= least or most <= low
        case _:
            return False
