"""Statements as C text. Each name is declared where it gets its value, or before the choice that gives it a value."""

from __future__ import annotations

import textwrap
from collections.abc import Callable, Iterable, Iterator, Sequence
from typing import assert_never

from safeloc.codegen.naming_terms import Text
from safeloc.codegen.nested_statements import Bind, Block, Choice, End, Test

_WIDTH = 118
Leaf = Callable[[Sequence[Text]], Iterable[Text]]
"""A function from the targets' values to the statements at the end of a branch."""


def statements(block: Block, leaf: Leaf, depth: int = 1, declared: frozenset[str] = frozenset()) -> str:
    """Return the statements as text; the names in `declared` are declared already."""
    text = ""
    for statement in block:
        match statement:
            case Bind(name, value, is_truth):
                kind = "" if name in declared else f"const {_kind(is_truth)} "
                text += line(f"{kind}{name} = {value.code};", depth)
            case Test(test, inner):
                text += (
                    line(f"if ({test.code}) {{", depth)
                    + statements(inner, leaf, depth + 1, declared)
                    + line("}", depth)
                )
            case Choice():
                text += _choice(statement, leaf, depth, declared)
            case End(values):
                text += "".join(line(one.code, depth) for one in leaf(values))
            case _:
                assert_never(statement)
    return text


def used(block: Block, leaf: Leaf) -> frozenset[str]:
    """Return the names that the statements read or call."""
    return frozenset(name for text in _texts(block, leaf) for name in text.uses)


def _texts(block: Block, leaf: Leaf) -> Iterator[Text]:
    for statement in block:
        match statement:
            case Bind(_, value, _):
                yield value
            case Test(test, inner):
                yield test
                yield from _texts(inner, leaf)
            case Choice(branches, otherwise):
                for test, inner in branches:
                    yield test
                    yield from _texts(inner, leaf)
                yield from _texts(otherwise, leaf)
            case End(values):
                yield from leaf(values)
            case _:
                assert_never(statement)


def line(text: str, depth: int) -> str:
    """Return one indented statement; a long one continues on lines with a deeper indentation."""
    indent = "    " * depth
    return (
        textwrap.fill(
            text,
            max(_WIDTH, len(indent) + 60),
            initial_indent=indent,
            subsequent_indent=indent + "        ",
            break_long_words=False,
            break_on_hyphens=False,
        )
        + "\n"
    )


def returned(test: str, status: str) -> str:
    """Return the statement of a function's body that ends the call with this status if the test holds."""
    return f"{line(f'if ({test}) {{', 1)}        return {status};\n    }}\n"


def _choice(choice: Choice, leaf: Leaf, depth: int, declared: frozenset[str]) -> str:
    kept = {name: kind for name, kind in given(choice).items() if name not in declared}
    inside = declared | kept.keys()
    text = "".join(line(f"{_kind(is_truth)} {name};", depth) for name, is_truth in kept.items())
    for number, (test, inner) in enumerate(choice.branches):
        text += line(f"{'} else if' if number else 'if'} ({test.code}) {{", depth)
        text += statements(inner, leaf, depth + 1, inside)
    return text + line("} else {", depth) + statements(choice.otherwise, leaf, depth + 1, inside) + line("}", depth)


def given(choice: Choice) -> dict[str, bool]:
    """Return the names that get a value in every branch: name -> True for a truth value."""
    branches = [_given_by(block) for block in (*(block for _, block in choice.branches), choice.otherwise)]
    return {name: kind for name, kind in branches[0].items() if all(name in other for other in branches)}


def given_names(block: Block) -> Iterator[str]:
    """Yield every name that gets a value somewhere in the block."""
    for statement in block:
        match statement:
            case Bind(name, _, _):
                yield name
            case Test(_, inner):
                yield from given_names(inner)
            case Choice(branches, otherwise):
                yield from given_names([one for _, inner in branches for one in inner])
                yield from given_names(otherwise)
            case End(_):
                pass
            case _:
                assert_never(statement)


def _given_by(block: Block) -> dict[str, bool]:
    names: dict[str, bool] = {}
    for statement in block:
        if isinstance(statement, Bind):
            names[statement.name] = statement.is_truth
        elif isinstance(statement, Choice):
            names |= given(statement)
    return names


def _kind(is_truth: bool) -> str:
    return "bool" if is_truth else "int64_t"
