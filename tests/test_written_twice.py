"""No function is written twice: equal bodies stand in one place, but for the few that are to be independent of each other."""

from __future__ import annotations

import ast
from collections.abc import Iterator
from copy import deepcopy
from functools import cache

import pytest

from tests.test_architecture import MODULES, name_of

SMALLEST, SMALLEST_RENAMED = 25, 45
"""Nodes of the syntax tree from which a body counts: with the same names, and with other ones (attributes and keywords remain)."""

DEFENDED = {
    frozenset({"safeloc/checker/claims.py: _while", "safeloc/proof/provers/absence.py: _where"}): (
        "the checker shares nothing with the provers"
    ),
    frozenset({"models/train_order/world.py: many", "properties/how_many.py: how_many"}): (
        "a claim counts by itself: a wrong count in the world does not weaken it as well"
    ),
    frozenset({"properties/balise/step.py: distance", "properties/unlinked_group/step.py: distance"}): (
        "each reads the step of its own machine; what both read is one line"
    ),
    frozenset({"models/marker_device/target.py: target", "models/reflector_device/target.py: target"}): (
        "a target names its own composition, claims and recordings, one argument each"
    ),
    frozenset({"models/balise/target.py: target", "models/guard/target.py: target"}): (
        "a target names its own machine, claims and simulation, one argument each"
    ),
    frozenset(
        f"models/{name}/target.py: target" for name in ("axle_counter", "axle_head", "axle_section", "emitter")
    ): "a target names its own machine, claims and simulation, one argument each",
    frozenset({"properties/fibre/counting.py: properties", "properties/fibre/place.py: properties"}): (
        "each lists the seven groups of its own file"
    ),
}
"""Groups of equal functions that stay apart, each with its reason."""


class _OtherNames(ast.NodeTransformer):
    """Replaces the names of variables and arguments by numbers, in the order in which they occur."""

    def __init__(self) -> None:
        self._known: dict[str, str] = {}

    def visit_Name(self, node: ast.Name) -> ast.AST:  # the name that `ast` asks for
        """Replace a name."""
        return ast.Name(self._known.setdefault(node.id, f"n{len(self._known)}"), node.ctx)

    def visit_arg(self, node: ast.arg) -> ast.AST:
        """Replace an argument, and leave its type out."""
        return ast.arg(self._known.setdefault(node.arg, f"n{len(self._known)}"))


@cache
def functions() -> list[tuple[str, ast.FunctionDef]]:
    """Return every function of safeloc, models and properties that is large enough, without its docstring."""
    return [one for one in _functions() if size(one[1]) >= SMALLEST]


def _functions() -> Iterator[tuple[str, ast.FunctionDef]]:
    for path in MODULES:
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            if isinstance(node, ast.FunctionDef):
                begins = 0 if ast.get_docstring(node) is None else 1
                bare = ast.FunctionDef("f", node.args, node.body[begins:], [], None, lineno=0)
                yield f"{name_of(path)}: {node.name}", bare


def size(function: ast.FunctionDef) -> int:
    """Return the number of nodes of a function's body."""
    return sum(1 for statement in function.body for _ in ast.walk(statement))


@pytest.mark.parametrize(("least", "renamed"), [(SMALLEST, False), (SMALLEST_RENAMED, True)])
def test_no_function_is_written_twice(least: int, renamed: bool) -> None:
    """Equal bodies are one function, or stand in the list with a reason."""
    groups: dict[str, set[str]] = {}
    for name, function in functions():
        if size(function) >= least:
            groups.setdefault(ast.dump(_OtherNames().visit(deepcopy(function)) if renamed else function), set()).add(
                name
            )
    twice = [sorted(names) for names in groups.values() if len(names) > 1 and frozenset(names) not in DEFENDED]
    assert twice == []


def test_no_reason_is_left_over() -> None:
    """Each group with a reason is one that still exists."""
    names = {name for name, _ in functions()}
    assert [sorted(group) for group in DEFENDED if not group <= names] == []
