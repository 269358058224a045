"""The place in the source of each term of a declaration: file, line and columns of the expression that made it.

Terms do not store their origin. While a declaration is made inside `noted`, each new node is recorded with the expression that
was being evaluated, and each rewritten node (a guard in a property, a machine's term in a composition) with its original. The
arguments of `compose` are recorded too.
"""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from types import FrameType
from typing import Any

from safeloc.assurance.source_places import Place, place_of
from safeloc.errors import is_engine
from safeloc.language import spec, terms
from safeloc.language.checks.composition import Plan
from safeloc.language.composition import plans_changed
from safeloc.language.nodes import (
    Add,
    And,
    Choose,
    ChooseBool,
    Compare,
    Expr,
    FloorDiv,
    Lit,
    Max,
    Min,
    Mul,
    Node,
    Not,
    Or,
    Past,
    Sub,
    Truth,
)

_NOTED: tuple[type[Expr], ...] = (
    Lit, Add, Sub, Mul, FloorDiv, Min, Max, Choose, Truth, Not, And, Or, ChooseBool, Compare, Past,
)  # fmt: skip


@dataclass(eq=False)
class Places:
    """The recorded places. Nodes are referenced, so that no new node gets the identity of an old one."""

    _written: dict[Expr, Place] = field(default_factory=dict)
    _from: dict[Expr, Expr] = field(default_factory=dict)
    plans: list[Plan] = field(default_factory=list)
    """The arguments of each `compose`."""

    def of(self, node: Expr) -> Place | None:
        """Return the place of the node, or of its original if it was rewritten; None if it was not recorded."""
        return self._written.get(self.origin(node))

    def origin(self, node: Expr) -> Expr:
        """Return the original of a rewritten node; any other node is its own original."""
        while node in self._from:
            node = self._from[node]
        return node

    def born(self, node: Expr) -> None:
        """Record the place of a new node: the expression outside of the engine that is being evaluated."""
        frame = _writer()
        self._written[node] = place_of(frame.f_code, frame.f_lasti)

    def rewritten(self, node: Expr, parts: tuple[Expr, ...], result: Expr) -> None:
        """Record that a node was rewritten; a result that is one of its parts keeps its own place."""
        if result is not node and all(result is not part for part in parts):
            self._from[result] = node

    def composed(self, plan: Plan) -> Plan:
        """Record the arguments of a `compose`, and return them unchanged."""
        self.plans.append(plan)
        return plan


def _writer() -> FrameType:
    """Return the nearest calling frame outside of the engine."""
    frame = sys._getframe(2)
    while frame.f_back is not None and is_engine(frame.f_globals.get("__name__", "")):
        frame = frame.f_back
    return frame


@contextmanager
def noted() -> Iterator[Places]:
    """Record every node that is made or rewritten, and every `compose`, inside this context."""
    places = Places()
    plain = {kind: kind.__init__ for kind in _NOTED}
    rebuilt = terms.rebuilt
    try:
        for kind in _NOTED:
            _set_init(kind, _noting(plain[kind], places))
        terms.rebuilt = spec.rebuilt = _tracing(rebuilt, places)  # type: ignore[assignment, attr-defined]
        with plans_changed(places.composed):
            yield places
    finally:
        terms.rebuilt = spec.rebuilt = rebuilt  # type: ignore[attr-defined]
        for kind in _NOTED:
            _set_init(kind, plain[kind])


def _set_init(kind: Any, init: Callable[..., None]) -> None:
    kind.__init__ = init


def _noting(plain: Callable[..., None], places: Places) -> Callable[..., None]:
    def init(node: Expr, *parts: Any, **named: Any) -> None:
        plain(node, *parts, **named)
        places.born(node)

    return init


def _tracing(
    plain: Callable[[Node, tuple[Expr, ...]], Expr], places: Places
) -> Callable[[Node, tuple[Expr, ...]], Expr]:
    def rebuilt(node: Node, parts: tuple[Expr, ...]) -> Expr:
        result = plain(node, parts)
        places.rewritten(node, parts, result)
        return result

    return rebuilt
