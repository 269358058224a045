"""No function is written twice: equal bodies stand in one place, but for the few that are to be independent of each other."""

from __future__ import annotations

import ast
from collections.abc import Iterator, Sequence

from tests.rooms import parsed
from tests.test_architecture import MODULES, name_of

SHORTEST = 70
"""Characters from which a body counts, spaces and line breaks apart."""

DEFENDED = {
    frozenset({"models/train_order/world.py: many", "properties/how_many.py: how_many"}): (
        "a claim counts by itself: a wrong count in the world does not weaken it as well"
    ),
    frozenset({"models/vocabulary/how_many.py: how_many", "properties/train_order.py: _how_many"}): (
        "a claim counts by itself: a wrong count in the machine does not weaken it as well"
    ),
    frozenset({"models/fibre/cycle.py: _room", "properties/fibre/seen.py: _room_nm"}): (
        "a claim states the figure by itself"
    ),
    frozenset(
        {
            *(f"models/{name}/variables.py: max_cycle_distance_mm" for name in ("reflector", "unlinked_group")),
            "models/layout_rules/marker_readers.py: measured_in_a_cycle_mm",
        }
    ): "a name of the configuration for the shared figure",
    frozenset(f"properties/{name}/step.py: distance" for name in ("balise", "unlinked_group")): (
        "each reads the step of its own machine"
    ),
    frozenset({"safeloc/checker/claims.py: _while", "safeloc/proof/provers/absence.py: _where"}): (
        "the checker shares nothing with the provers"
    ),
}
"""Groups of equal functions that stay apart, each with its reason."""


def functions() -> Iterator[tuple[str, str]]:
    """Yield every function of safeloc, models and properties with its body, spaces and docstring apart."""
    for path in MODULES:
        text = path.read_text(encoding="utf-8")
        for node in _inside(parsed(text).body):
            begins = node.body[0 if ast.get_docstring(node) is None else 1 :]
            if begins:
                lines = text.splitlines()[begins[0].lineno - 1 : node.end_lineno]
                yield f"{name_of(path)}: {node.name}", "".join("".join(lines).split())


def _inside(statements: Sequence[ast.stmt]) -> Iterator[ast.FunctionDef]:
    """Yield functions and methods."""
    for node in statements:
        if isinstance(node, ast.FunctionDef):
            yield node
        elif isinstance(node, ast.ClassDef):
            yield from _inside(node.body)


def test_no_function_is_written_twice() -> None:
    """Equal bodies are one function, or stand in the list with a reason; each reason is of a group that there still is."""
    groups: dict[str, set[str]] = {}
    for name, body in functions():
        if len(body) >= SHORTEST:
            groups.setdefault(body, set()).add(name)
    twice = {frozenset(names) for names in groups.values() if len(names) > 1}
    assert sorted(map(sorted, twice)) == sorted(map(sorted, DEFENDED))
