"""Removal of statements whose result is never read, which simplification and case splitting leave behind."""

from __future__ import annotations

from collections.abc import Iterable
from typing import assert_never

from safeloc.codegen.naming_terms import Text
from safeloc.codegen.nested_statements import Bind, Block, Choice, End, Statement, Test

Names = frozenset[str]


def live(block: Block) -> Block:
    """Return the block without statements whose result is never read; its final values stay."""
    return _live(block, frozenset())[0]


def _live(block: Block, needed: Names) -> tuple[Block, Names]:
    """Remove the unused statements of a block, given the names needed after it; return also the names needed before it."""
    kept: list[Statement] = []
    for statement in reversed(block):
        match statement:
            case End(values):
                kept, needed = [statement], _used(values)
            case Bind(name, value, _):
                if name in needed:
                    kept.append(statement)
                    needed |= value.uses
            case Test(test, inner):
                inner, read = _live(inner, frozenset())
                kept.append(Test(test, inner))
                needed |= read | test.uses
            case Choice():
                choice, needed = _choice(statement, needed)
                kept += choice
            case _:
                assert_never(statement)
    return kept[::-1], needed


def _choice(choice: Choice, needed: Names) -> tuple[Block, Names]:
    """Return the choice without unused statements, if it gives a needed name a value, and the names needed before it."""
    branches = [(test, *_live(block, needed)) for test, block in choice.branches]
    otherwise, read = _live(choice.otherwise, needed)
    if not otherwise and not any(block for _, block, _ in branches):
        return [], needed
    needed = needed.union(read, _used(test for test, _, _ in branches), *(names for _, _, names in branches))
    return [Choice(tuple((test, block) for test, block, _ in branches), otherwise)], needed


def _used(texts: Iterable[Text]) -> Names:
    return frozenset[str]().union(*(text.uses for text in texts))
