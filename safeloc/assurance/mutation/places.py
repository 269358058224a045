"""Where each term of a declaration is written: file, line and columns of the expression that made it.

Terms say nothing of where they come from, since nothing but this asks. While a declaration is made inside `noted`, each node
is noted with the expression that was being evaluated, and each node that was rewritten (a guard as a property looks back
at it, a machine's term in a composition) with the node that it was rewritten from.
"""

from __future__ import annotations

import linecache
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from itertools import islice
from pathlib import Path
from types import CodeType, FrameType
from typing import Any

from safeloc.errors import is_engine
from safeloc.language import spec, terms
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

PACKAGE = Path(terms.__file__).parents[1]
NOTED: tuple[type[Expr], ...] = (
    Lit, Add, Sub, Mul, FloorDiv, Min, Max, Choose, Truth, Not, And, Or, ChooseBool, Compare, Past,
)  # fmt: skip


@dataclass(frozen=True)
class Place:
    """An expression in a source file: lines from 1, columns from 0."""

    file: str
    line: int
    end_line: int
    column: int
    end_column: int

    def __str__(self) -> str:
        return f"{shown(self.file)}:{self.line}"

    @property
    def text(self) -> str:
        """The expression as it is written, on one line; "" where its file cannot be read."""
        lines = linecache.getlines(self.file)[self.line - 1 : self.end_line]
        if not lines:
            return ""
        encoded = [line.rstrip("\n").encode() for line in lines]
        encoded[-1] = encoded[-1][: self.end_column]
        encoded[0] = encoded[0][self.column :]
        return " ".join(line.decode().strip() for line in encoded)


def shown(file: str) -> str:
    """A file of the package from its root on, any other as it is."""
    path = Path(file)
    return path.relative_to(PACKAGE).as_posix() if path.is_relative_to(PACKAGE) else file


@dataclass(eq=False)
class Places:
    """What was noted. Nodes are kept, so that none gets the identity of another."""

    _written: dict[Expr, Place] = field(default_factory=dict)
    _from: dict[Expr, Expr] = field(default_factory=dict)
    _known: dict[tuple[CodeType, int], Place] = field(default_factory=dict)

    def of(self, node: Expr) -> Place | None:
        """Where the node, or the one that it was rewritten from, is written; None where that was not noted."""
        return self._written.get(self.origin(node))

    def origin(self, node: Expr) -> Expr:
        """The node as it was first written."""
        while node in self._from:
            node = self._from[node]
        return node

    def born(self, node: Expr) -> None:
        """Note a node that is being made."""
        frame = _writer()
        key = (frame.f_code, frame.f_lasti)
        if key not in self._known:
            self._known[key] = _expression(frame)
        self._written[node] = self._known[key]

    def rewritten(self, node: Expr, parts: tuple[Expr, ...], result: Expr) -> None:
        """Note that a node was rewritten; a result that is one of its parts keeps its own place."""
        if result is not node and all(result is not part for part in parts):
            self._from[result] = node


def _writer() -> FrameType:
    """The nearest frame that is not the engine's."""
    frame = sys._getframe(2)
    while frame.f_back is not None and is_engine(frame.f_globals.get("__name__", "")):
        frame = frame.f_back
    return frame


def _expression(frame: FrameType) -> Place:
    """The expression that a frame is at."""
    code = frame.f_code
    line, end, column, last = next(islice(code.co_positions(), frame.f_lasti // 2, None))
    first = line or frame.f_lineno
    return Place(code.co_filename, first, end or first, column or 0, last or 0)


@contextmanager
def noted() -> Iterator[Places]:
    """Note every node that is made or rewritten meanwhile."""
    places = Places()
    plain = {kind: kind.__init__ for kind in NOTED}
    rebuilt = terms.rebuilt
    try:
        for kind in NOTED:
            _set_init(kind, _noting(plain[kind], places))
        terms.rebuilt = spec.rebuilt = _tracing(rebuilt, places)  # type: ignore[assignment, attr-defined]
        yield places
    finally:
        terms.rebuilt = spec.rebuilt = rebuilt  # type: ignore[attr-defined]
        for kind in NOTED:
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
