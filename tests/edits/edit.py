"""One small edit of a Python file: a number, a comparison or a connective that stands in it becomes another one."""

from __future__ import annotations

import ast
import random
from collections.abc import Iterator
from dataclasses import dataclass

OTHER = {"<=": "<", "<": "<=", ">=": ">", ">": ">=", "&": "|", "|": "&", "+": "-", "-": "+"}


@dataclass(frozen=True)
class Edit:
    """From one place of a text up to another: what stands there becomes something else."""

    begin: int
    end: int
    before: str
    after: str
    line: int

    def made(self, text: str) -> str:
        """The text with the edit."""
        assert text[self.begin : self.end] == self.before
        return text[: self.begin] + self.after + text[self.end :]


def edits(text: str) -> list[Edit]:
    """All edits that there are of a text, in order."""
    starts = [0]
    for line in text.splitlines(keepends=True):
        starts.append(starts[-1] + len(line))
    at = _Places(text, starts)
    return sorted((edit for node in ast.walk(ast.parse(text)) for edit in _of(node, at)), key=lambda one: one.begin)


def drawn(text: str, draw: random.Random) -> Edit:
    """One of them."""
    return draw.choice(edits(text))


@dataclass(frozen=True)
class _Places:
    """Lines and columns of a syntax tree as places in its text (files here are ASCII where code stands)."""

    text: str
    starts: list[int]

    def begin(self, node: ast.expr) -> int:
        return self.starts[node.lineno - 1] + node.col_offset

    def end(self, node: ast.expr) -> int:
        return self.starts[(node.end_lineno or node.lineno) - 1] + (node.end_col_offset or 0)


def _of(node: ast.AST, at: _Places) -> Iterator[Edit]:
    match node:
        case ast.Constant(value=bool()):
            return
        case ast.Constant(value=int(value)):
            begin, end = at.begin(node), at.end(node)
            yield Edit(begin, end, at.text[begin:end], str(value + 1), node.lineno)
        case ast.Compare(left=left, comparators=[right]) | ast.BinOp(left=left, right=right):
            begin, end = at.end(left), at.begin(right)
            between = at.text[begin:end]
            sign = between.strip(" ()\n")
            if sign in OTHER:
                yield Edit(begin, end, between, between.replace(sign, OTHER[sign]), node.lineno)
        case _:
            return
