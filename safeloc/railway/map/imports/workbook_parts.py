"""Checks the XML parts of a workbook before any library builds objects from them.

A kilobyte of ZIP may hold a megabyte of XML, and libraries that pad rows make 16 384 cells of one cell in the last column. So
this module counts the existing elements, rows and cells one element at a time. It also checks the text of numbers, since
libraries accept digits of every script.
"""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from xml.parsers import expat
from zipfile import ZipFile

from safeloc.errors import InputError
from safeloc.railway.map.imports.xml_prolog import DOCUMENT_TYPE
from safeloc.runtime.outside import number, quoted, refuse_beyond

LARGEST_PART = 100_000_000
"""Unpacked bytes of one part, and of all parts."""
_MOST_PARTS = 1_000
MOST_ELEMENTS = 3_000_000
"""Elements of all parts, two for each cell. Reading takes some ten microseconds for each."""
MOST_ROWS = 100_000
MOST_CELLS = 1_000_000
_DEEPEST = 64
"""Greatest depth of nested elements; a sheet has seven."""
_CHUNK = 1 << 16


def refuse_unsafe(path: Path) -> None:
    """Refuse a document type, malformed numbers and parts beyond the limits above. InputError with part and line."""
    with ZipFile(path) as archive:
        parts = archive.infolist()
        refuse_beyond("the workbook", len(parts), _MOST_PARTS, "parts")
        refuse_beyond("the workbook", sum(part.file_size for part in parts), LARGEST_PART, "bytes in its parts")
        elements = 0
        for part in parts:
            if part.filename.endswith((".xml", ".rels")):
                elements += _Look(f"part {part.filename}", elements).through(archive, part.filename)


class _Look:
    """Checks one part, element by element."""

    def __init__(self, place: str, before: int) -> None:
        self._place, self._before = place, before
        self._elements = self._rows = self._cells = self._depth = 0
        self._number: list[str] | None = None
        self._is_number = False
        self._parser = expat.ParserCreate(namespace_separator=" ")
        self._parser.buffer_text = True
        self._parser.StartDoctypeDeclHandler = self._refuse
        self._parser.StartElementHandler = self._begins
        self._parser.EndElementHandler = self._ends
        self._parser.CharacterDataHandler = self._text

    def through(self, archive: ZipFile, name: str) -> int:
        """Check the whole part; return the number of its elements."""
        try:
            with archive.open(name) as file:
                while data := file.read(_CHUNK):
                    self._parser.Parse(data, False)
            self._parser.Parse(b"", True)
        except expat.ExpatError as error:
            reason = expat.ErrorString(error.code)
            raise InputError(f"not a readable XLSX file: {self._place}:{error.lineno}: {reason}.") from error
        except LookupError as error:
            raise InputError(f"not a readable XLSX file: {self._place}:1: {error}.") from error
        return self._elements

    def _here(self) -> str:
        return f"{self._place}:{self._parser.CurrentLineNumber}"

    def _refuse(self, *_: object) -> None:
        raise InputError(f"{self._here()}: {DOCUMENT_TYPE}")

    def _begins(self, name: str, attributes: Mapping[str, str]) -> None:
        self._elements += 1
        self._depth += 1
        refuse_beyond(self._here(), self._before + self._elements, MOST_ELEMENTS, "elements")
        if self._depth > _DEEPEST:
            raise InputError(f"{self._here()}: elements are nested deeper than {_DEEPEST}; no workbook is.")
        match name.rpartition(" ")[2]:
            case "row":
                self._rows += 1
                refuse_beyond(self._here(), self._rows, MOST_ROWS, "rows")
            case "c":
                self._cells += 1
                refuse_beyond(self._here(), self._cells, MOST_CELLS, "cells")
                self._is_number = attributes.get("t", "n") == "n"
            case "v" if self._is_number:
                self._number = []

    def _text(self, text: str) -> None:
        if self._number is not None:
            self._number.append(text)

    def _ends(self, name: str) -> None:
        self._depth -= 1
        if self._number is not None and name.rpartition(" ")[2] == "v":
            written = "".join(self._number)
            self._number = None
            if written.strip(" \t\r\n") and number(written.strip(" \t\r\n")) is None:
                raise InputError(f"{self._here()}: {quoted(written)} is no number in ASCII digits.")
