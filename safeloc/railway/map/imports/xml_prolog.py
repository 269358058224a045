"""Refuses XML with a document type before any library that might act on it reads the document."""

from __future__ import annotations

from xml.parsers import expat

from safeloc.errors import InputError

DOCUMENT_TYPE = "has a document type; none is needed, and entities are refused. Remove the <!DOCTYPE ...>."


class _PrologRead(Exception):
    """Raised at the first element, since no document type can follow it."""


def refuse_document_type(place: str, data: bytes) -> None:
    """Refuse a document type, and text that is not XML up to its first element. InputError with the line.

    Nothing beyond is read, so that no declaration of a document type is ever processed.
    """
    parser = expat.ParserCreate()

    def refuse(*_: object) -> None:
        raise InputError(f"{place}:{parser.CurrentLineNumber}: {DOCUMENT_TYPE}")

    def stop(*_: object) -> None:
        raise _PrologRead

    parser.StartDoctypeDeclHandler = refuse
    parser.StartElementHandler = stop
    try:
        parser.Parse(data, True)
    except (_PrologRead, InputError) as end:
        if isinstance(end, InputError):
            raise
    except expat.ExpatError as error:
        reason = expat.ErrorString(error.code)
        raise InputError(f"{place}:{error.lineno}: not well-formed XML ({reason}).") from error
    except (LookupError, ValueError) as error:
        raise InputError(f"{place}:1: not readable as XML ({error}).") from error
