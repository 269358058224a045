"""Reads the first sheet of an XLSX workbook as plain values, row by row, as many cells as its heading has.

A workbook is XML in a ZIP file; `workbook_parts` checks it before the workbook is read.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any
from zipfile import BadZipFile
from zlib import error as ZlibError  # noqa: N812 - lower case there

from safeloc.errors import InputError
from safeloc.railway.map.imports.building import content, missing
from safeloc.railway.map.imports.workbook_parts import refuse_unsafe
from safeloc.runtime.outside import refuse_beyond, shortened

_MOST_COLUMNS = 200
_LAST_ROW = 1_048_576
"""Greatest row number of a sheet. A row beyond it is refused: the empty rows before it would take too long."""


@dataclass(frozen=True)
class Sheet:
    """The title and filled rows of the first sheet, each with its number and as long as the heading; titles of the others."""

    title: str
    heading: tuple[Any, ...]
    rows: tuple[tuple[int, tuple[Any, ...]], ...]
    others: tuple[str, ...]


def read_sheet(path: Path) -> Sheet:
    """Return the first sheet. InputError for a file that is not a workbook or not safe to read; EngineError without
    openpyxl.

    Row 1 is the heading. Cells to the right of it are not read.
    """
    content(path)
    openpyxl = _openpyxl()
    try:
        refuse_unsafe(path)
        book = openpyxl.load_workbook(path, read_only=True, data_only=True)
        try:
            return _sheet(book)
        finally:
            book.close()
    except InputError:
        raise
    except (openpyxl.utils.exceptions.InvalidFileException, BadZipFile) as error:
        raise InputError(f"not an XLSX file ({shortened(error)}).") from error
    except _BROKEN as error:
        raise InputError(f"not a readable XLSX file ({shortened(error)}).") from error


_BROKEN = (
    ArithmeticError,
    AttributeError,
    EOFError,
    LookupError,
    NotImplementedError,
    SyntaxError,
    TypeError,
    ValueError,
    ZlibError,
)
"""Exceptions that libraries raise on a damaged workbook."""


def _sheet(book: Any) -> Sheet:
    first, *others = book.worksheets
    heading = _heading(next(first.iter_rows(max_row=1, values_only=True), ()))
    listed = first.iter_rows(min_row=2, max_row=_LAST_ROW, max_col=max(1, len(heading)), values_only=True)
    rows = [(number, tuple(row)) for number, row in enumerate(listed, 2) if any(cell is not None for cell in row)]
    return Sheet(first.title, heading, tuple(rows), tuple(other.title for other in others))


def _heading(row: Sequence[Any]) -> tuple[Any, ...]:
    """Return the first row up to its last filled cell."""
    last = max((number for number, cell in enumerate(row, 1) if cell is not None), default=0)
    refuse_beyond("row 1", last, _MOST_COLUMNS, "columns")
    return tuple(row[:last])


def _openpyxl() -> Any:
    try:
        import openpyxl
    except ImportError as error:
        raise missing("openpyxl", "reading XLSX") from error
    return openpyxl
