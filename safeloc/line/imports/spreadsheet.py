"""The first sheet of an XLSX workbook as plain values, read whole and safely.

A workbook is XML in a ZIP file: parts with a document type, and parts of more than `LARGEST_PART` bytes, are refused
before they are read as such.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any
from zipfile import BadZipFile, ZipFile

from safeloc.errors import InputError
from safeloc.line.imports.building import content, missing
from safeloc.line.imports.xml_prolog import refuse_document_type

LARGEST_PART = 200_000_000
PROLOG = 65_536
"""Bytes within which the first element of a part must begin."""


@dataclass(frozen=True)
class Sheet:
    """Title and rows (row 1 first, all equally long) of the first sheet, and the titles of the others."""

    title: str
    rows: tuple[tuple[Any, ...], ...]
    others: tuple[str, ...]


def read_sheet(path: Path) -> Sheet:
    """The first sheet. InputError for what is no workbook or not safe to read; EngineError where openpyxl is missing."""
    content(path)
    openpyxl = _openpyxl()
    try:
        _refuse_unsafe(path)
        book = openpyxl.load_workbook(path, read_only=True, data_only=True)
        first, *others = book.worksheets
        rows = [tuple(row) for row in first.iter_rows(values_only=True)]
        book.close()
    except InputError:
        raise
    except (openpyxl.utils.exceptions.InvalidFileException, BadZipFile) as error:
        raise InputError(f"not an XLSX file ({error}).") from error
    except (KeyError, ValueError, TypeError, AttributeError, SyntaxError, EOFError) as error:
        raise InputError(f"not a readable XLSX file ({type(error).__name__}: {error}).") from error
    width = max(map(len, rows), default=0)
    padded = tuple(row + (None,) * (width - len(row)) for row in rows)
    return Sheet(first.title, padded, tuple(other.title for other in others))


def _refuse_unsafe(path: Path) -> None:
    with ZipFile(path) as archive:
        for part in archive.infolist():
            if part.file_size > LARGEST_PART:
                raise InputError(f"part {part.filename} holds {part.file_size} bytes; at most {LARGEST_PART} are read.")
            if part.filename.endswith((".xml", ".rels")):
                with archive.open(part) as file:
                    refuse_document_type(f"part {part.filename}", file.read(PROLOG))


def _openpyxl() -> Any:
    try:
        import openpyxl
    except ImportError as error:
        raise missing("openpyxl", "reading XLSX") from error
    return openpyxl


def cells(sheet: Sheet) -> Iterator[tuple[int, tuple[Any, ...]]]:
    """The rows below the heading with their numbers, without the empty ones."""
    for number, row in enumerate(sheet.rows[1:], 2):
        if any(cell is not None for cell in row):
            yield number, row
