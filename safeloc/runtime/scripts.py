"""Packed data in a script: a page that is opened from disk may load scripts and nothing else.

    safelocRuns("odometry", "H4sI...");

The script calls a function of the page with words and, at the end, data packed with gzip, in base64. Programs read the same
file, within bounds. A damaged or truncated file is refused by name: gzip contains a checksum.
"""

from __future__ import annotations

import base64
import binascii
import gzip
import json
import re
import zlib
from pathlib import Path

from safeloc.errors import InputError
from safeloc.runtime.outside import LARGEST_FILE, read_bytes, refuse_beyond

SUFFIX = ".js"
_CALL = re.compile(rb'(\w+)\((?:"(?:[^"\\]|\\.)*", )*"([A-Za-z0-9+/=]*)"\);\n')
_GZIP = 31
"""The window of zlib, with the header and checksum of gzip."""


def script(function: str, *words: str, data: bytes) -> str:
    """Return the text of a script; equal data give equal texts. It may also stand within a page."""
    given = [*map(quoted, words), f'"{base64.b64encode(gzip.compress(data, mtime=0)).decode()}"']
    return f"{function}({', '.join(given)});\n"


def quoted(text: str) -> str:
    """Return a string of JavaScript that cannot end the script around it."""
    return json.dumps(text).replace("<", "\\u003c")


def read_script(path: Path, function: str, most: int = LARGEST_FILE) -> bytes:
    """Return the unpacked data. InputError for a file that is damaged, is another script, or is too large."""
    found = _CALL.fullmatch(read_bytes(path, most))
    if found is None or found[1].decode() != function:
        raise InputError(f"{path}: damaged, it is no complete call of {function}. Write the report again.")
    unpacking = zlib.decompressobj(_GZIP)
    try:
        data = unpacking.decompress(base64.b64decode(found[2], validate=True), most + 1)
    except (zlib.error, binascii.Error) as error:
        raise InputError(f"{path}: damaged, it cannot be unpacked ({error}). Write the report again.") from error
    refuse_beyond(path, len(data), most, "bytes when unpacked")
    if not unpacking.eof or unpacking.unused_data:
        raise InputError(f"{path}: damaged, its data do not end where they should. Write the report again.")
    return data
