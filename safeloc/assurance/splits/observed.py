"""The case splits that occur while a machine is built: every comparison, minimum, choice, sum and product, live or folded.

Calls of the language are observed from outside, through Python's profiling hook, so the observed code is the proved code.
"""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, field
from types import CodeType, FrameType
from typing import Any, TypeVar

from safeloc.assurance.source_places import Place
from safeloc.assurance.splits.places import way_to
from safeloc.language import expr, nodes
from safeloc.language.nodes import Add, Expr, Lit, Max, Min, Sub, Truth
from safeloc.language.terms import Sharing

_Made = TypeVar("_Made")
_Locals = Mapping[str, Any]
_Judged = tuple[str, str] | None
"""The kind of split, and the reason why it is folded ("" if it is not); None if the call makes no split."""


@dataclass(frozen=True)
class Split:
    """A place where a machine, its world or a claim distinguishes cases, or adds a configured figure.

    kind  comparison, minimum, maximum, choice, condition, sum, product, rounding
    way   the expression, and the calls that led to it, the innermost first
    """

    kind: str
    way: tuple[Place, ...]

    @property
    def place(self) -> Place:
        """The place of the expression."""
        return self.way[0]


@dataclass(eq=False)
class Observed:
    """All splits that occurred: `live` maps a split to its terms that were not folded, `folded` to the reason for folding."""

    live: dict[Split, list[Expr]] = field(default_factory=dict)
    folded: dict[Split, str] = field(default_factory=dict)
    share: Sharing = field(default_factory=Sharing)

    def alike(self, one: Expr, other: Expr) -> bool:
        """Return whether two terms have the same structure."""
        return self.share(one) is self.share(other)

    def add(self, split: Split, term: Expr, folded: str) -> None:
        """Record one call of the language."""
        if folded:
            self.folded.setdefault(split, folded)
        else:
            self.live.setdefault(split, []).append(term)


def observe(make: Callable[[], _Made]) -> tuple[_Made, Observed]:
    """Call `make`; return its result, and the splits that occurred during the call."""
    observed = Observed()

    def returned(frame: FrameType, event: str, result: Any) -> None:
        judge = _JUDGES.get(frame.f_code) if event == "return" else None
        if judge is None or result is None:
            return
        judged = judge(frame.f_locals, result, observed)
        if judged is not None:
            kind, why = judged
            way = way_to(frame.f_back)
            if way:
                observed.add(Split(kind, way), result, why)

    with _watching(returned):
        return make(), observed


@contextmanager
def _watching(hook: Callable[[FrameType, str, Any], None]) -> Iterator[None]:
    before = sys.getprofile()
    sys.setprofile(hook)
    try:
        yield
    finally:
        sys.setprofile(before)


# ------------------------------------------------------------------ the split of a call of the language


def _compared(_: _Locals, result: Expr, __: Observed) -> _Judged:
    return "comparison", "both sides are constant" if isinstance(result, Truth) else ""


def _chosen(given: _Locals, result: Expr, observed: Observed) -> _Judged:
    if isinstance(given["condition"], Truth):
        return "choice", "its condition is constant"
    then, other = given["then"], given["other"]
    both = (nodes.as_bool(then), nodes.as_bool(other)) if isinstance(result, nodes.Bool) else (then, other)
    return "choice", "both branches are alike" if observed.alike(*both) else ""


def _computed(given: _Locals, _: Expr, observed: Observed) -> _Judged:
    """Return the split of a minimum or maximum, or of a sum or difference with a figure."""
    kind, left, right = given["kind"], given["left"], given["right"]
    constant = isinstance(left, Lit) and isinstance(right, Lit)
    if kind in _EXTREMES:
        why = "both sides are constant" if constant else "both sides are alike" if observed.alike(left, right) else ""
        return _EXTREMES[kind], why
    if constant or kind not in (Add, Sub):
        return None
    return "sum", "one addend is 0" if _is(right, 0) or (kind is Add and _is(left, 0)) else ""


def _multiplied(given: _Locals, _: Expr, __: Observed) -> _Judged:
    left, right = given["left"], given["right"]
    if isinstance(left, Lit) and isinstance(right, Lit):
        return None
    return "product", "one factor is 0" if _is(left, 0) or _is(right, 0) else ""


def _divided(given: _Locals, result: Expr, _: Observed) -> _Judged:
    return None if isinstance(result, Lit) else ("rounding", "it divides by 1" if given["divisor"] == 1 else "")


def _is(term: Expr, value: int) -> bool:
    return isinstance(term, Lit) and term.value == value


_EXTREMES = {Min: "minimum", Max: "maximum"}
_JUDGES: Mapping[CodeType, Callable[[_Locals, Expr, Observed], _Judged]] = {
    nodes._compare.__code__: _compared,
    nodes.arith.__code__: _computed,
    nodes.product.__code__: _multiplied,
    expr.ite.__code__: _chosen,
    expr.floor_div.__code__: _divided,
}
"""The functions of the language that make every term, by their code."""
