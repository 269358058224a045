"""Statements without those whose result nobody reads: what folding or another choice has made needless."""

from __future__ import annotations

import re
from collections.abc import Iterable
from typing import assert_never

from safeloc.codegen.nested_statements import Bind, Block, Choice, End, Statement, Test

_WORD = re.compile(r"[A-Za-z_]\w*")
Names = frozenset[str]


def live(block: Block) -> Block:
    """The block without names that are given and not read; what it ends with stays as it is."""
    return _live(block, frozenset())[0]


def _live(block: Block, needed: Names) -> tuple[Block, Names]:
    """What is left of a block after which some names are needed; the names that are needed before it."""
    kept: list[Statement] = []
    for statement in reversed(block):
        match statement:
            case End(values):
                kept, needed = [statement], _words(values)
            case Bind(name, value, _):
                if name in needed:
                    kept.append(statement)
                    needed |= _words([value])
            case Test(test, inner):
                inner, read = _live(inner, frozenset())
                kept.append(Test(test, inner))
                needed |= read | _words([test])
            case Choice():
                choice, needed = _choice(statement, needed)
                kept += choice
            case _:
                assert_never(statement)
    return kept[::-1], needed


def _choice(choice: Choice, needed: Names) -> tuple[Block, Names]:
    """The choice, if it gives a name that is needed."""
    branches = [(test, *_live(block, needed)) for test, block in choice.branches]
    otherwise, read = _live(choice.otherwise, needed)
    if not otherwise and not any(block for _, block, _ in branches):
        return [], needed
    needed = needed.union(read, _words(test for test, _, _ in branches), *(names for _, _, names in branches))
    return [Choice(tuple((test, block) for test, block, _ in branches), otherwise)], needed


def _words(texts: Iterable[str]) -> Names:
    return frozenset(word for text in texts for word in _WORD.findall(text))
