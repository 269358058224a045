"""The places of expressions in source files: file, lines and columns, derived from the running instruction."""

from __future__ import annotations

import linecache
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from types import CodeType

import safeloc

_PACKAGE = Path(safeloc.__file__).parent.resolve()
DECLARING = ("models", "properties")


@dataclass(frozen=True, order=True)
class Place:
    """An expression or statement in a source file: lines from 1, columns in bytes from 0."""

    file: str
    line: int
    end_line: int
    column: int
    end_column: int

    def __str__(self) -> str:
        return f"{shown(self.file)}:{self.line}"

    @property
    def text(self) -> str:
        """Return the source text of the expression on one line; "" if its file cannot be read."""
        lines = linecache.getlines(self.file)[self.line - 1 : self.end_line]
        if not lines:
            return ""
        encoded = [line.encode() for line in lines]
        encoded[-1] = encoded[-1][: self.end_column]
        encoded[0] = encoded[0][self.column :]
        return " ".join(b" ".join(encoded).decode().split())


@cache
def shown(file: str) -> str:
    """Return the path of a file of the package or its checkout relative to the root, any other path unchanged."""
    path = Path(file)
    for root in (*(_PACKAGE.parent / room for room in DECLARING), _PACKAGE):
        if path.is_relative_to(root):
            return path.relative_to(_PACKAGE if root == _PACKAGE else _PACKAGE.parent).as_posix()
    return file


def place_of(code: CodeType, offset: int) -> Place:
    """Return the place of the expression to which an instruction belongs."""
    return _place(code.co_filename, code, offset)


@cache
def _place(file: str, code: CodeType, offset: int) -> Place:
    """Return a place; the file is named, because Python holds two pieces of code to be equal that differ only in their file."""
    line, end_line, column, end_column = _positions(code)[offset // 2]
    first = line or code.co_firstlineno
    return Place(file, first, end_line or first, column or 0, end_column or 0)


@cache
def _positions(code: CodeType) -> list[tuple[int | None, int | None, int | None, int | None]]:
    return list(code.co_positions())
