"""External input: one rule for all errors, and reading of files within bounds.

    with reading(path):   a flaw in the file, or a file that cannot be read, raises an InputError that names the file;
                          any other exception becomes an UnforeseenError, which reports a defect of safeloc

So external input raises only a SafelocError, and a defect of safeloc is never reported as a flaw of the input.
`refusal` applies the same rule if a message is returned instead of raised.
"""

from __future__ import annotations

import re
import reprlib
import traceback
from collections.abc import Iterator
from contextlib import contextmanager
from io import BufferedIOBase
from os import fstat
from pathlib import Path

from safeloc.errors import InputError, SafelocError, UnforeseenError

LARGEST_FILE = 500_000_000
"""Bytes of a file that is read at once or line by line."""

_WHOLE = re.compile(r"[+-]?[0-9]+")
_NUMBER = re.compile(r"[+-]?(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][+-]?[0-9]{1,3})?")
"""Numbers in files have ASCII digits only; Python's `int`, `float` and `Decimal` also accept other digits, and `_`."""

MOST_DIGITS = 1_000
"""Digits of a whole number in a file: the time to read one grows with the square of its length."""

_CHUNK = 1 << 20
_TOO_LARGE = "needs more memory than there is; give a smaller one"


@contextmanager
def reading(place: object) -> Iterator[None]:
    """Turn errors in reading external input into SafelocErrors. Messages begin with `place`, such as a path.

    SafelocErrors pass. An OSError and a MemoryError are InputErrors, anything else an UnforeseenError.
    """
    try:
        yield
    except SafelocError:
        raise
    except (OSError, MemoryError) as error:
        raise InputError(f"{place}: {refusal(error)}.") from error
    except Exception as error:
        raise UnforeseenError(f"{place}: {refusal(error)}") from error


@contextmanager
def reading_file(path: Path, name: str = "") -> Iterator[None]:
    """Do as `reading`, and put the file's `name` (by default its path) before a message that does not name the file."""
    try:
        with reading(path):
            yield
    except UnforeseenError:
        raise
    except InputError as error:
        message = str(error)
        if message.startswith((str(path), path.name)):
            raise
        raise type(error)(f"{name or path}: {message}") from error


def refusal(error: Exception) -> str:
    """Return the reason for which an input is refused; an unforeseen error is named as such."""
    match error:
        case SafelocError():
            return str(error)
        case OSError():
            return _unreadable(error)
        case MemoryError():
            return _TOO_LARGE
        case _:
            return f"{UNFORESEEN} ({shortened(error)}, {_where(error)}). Please report it with the input."


UNFORESEEN = "not read: safeloc itself failed on it"
"""Beginning of a message about an unforeseen failure."""


def _unreadable(error: OSError) -> str:
    """Return the reason that the operating system gives for a file that cannot be read."""
    return f"cannot be read: {error.strerror or error}"


def shortened(error: BaseException) -> str:
    """Return type and first line of an error, cut to 200 characters: errors of other packages may quote without bounds."""
    first = (_text(error).splitlines() or [""])[0]
    return f"{type(error).__name__}: {first[:200]}" if first else type(error).__name__


def _text(error: BaseException) -> str:
    try:
        return str(error)
    except Exception:  # an error of another package, whose own `str` fails
        return ""


def _where(error: BaseException) -> str:
    """Return file and line of the innermost frame in safeloc."""
    frames = traceback.extract_tb(error.__traceback__)
    inside = [frame for frame in frames if Path(frame.filename).is_relative_to(_ROOT)] or frames
    if not inside:
        return "place unknown"
    name = Path(inside[-1].filename)
    return f"{name.relative_to(_ROOT.parent) if name.is_relative_to(_ROOT) else name.name}:{inside[-1].lineno}"


_ROOT = Path(__file__).resolve().parents[1]
_QUOTED = reprlib.Repr()
_QUOTED.maxstring = _QUOTED.maxother = _QUOTED.maxlong = 80


def quoted(value: object) -> str:
    """Return a received value for a message, in at most 240 characters, however large or deep it is."""
    return _QUOTED.repr(value)[:240]


def shown(name: object) -> str:
    """Return a received name without quotes, on one line."""
    return quoted(str(name))[1:-1]


def whole_number(text: str) -> int | None:
    """Return a whole number in ASCII digits; None for other text, and for more than `MOST_DIGITS`."""
    return int(text) if len(text) <= MOST_DIGITS and _WHOLE.fullmatch(text) else None


def number(text: str) -> float | None:
    """Return a decimal number in ASCII digits; None for other text, including NaN and infinity."""
    return float(text) if len(text) <= MOST_DIGITS and _NUMBER.fullmatch(text) else None


def read_bytes(path: Path, most: int = LARGEST_FILE) -> bytes:
    """Return the file's bytes. InputError with the path for a file that cannot be read or has more than `most` bytes."""
    with reading(path):
        _refuse_device(path)
        with path.open("rb") as file:
            data = file.read(min(fstat(file.fileno()).st_size, most) + 1)
            while len(data) <= most and (more := file.read(_CHUNK)):  # in case the file's size is not known
                data += more
    refuse_beyond(path, len(data), most, "bytes")
    return data


def read_text(path: Path, most: int = LARGEST_FILE) -> str:
    """Return the file's UTF-8 text without a byte order mark. InputError as `read_bytes`, and with the line if it is no UTF-8."""
    return decoded(path, read_bytes(path, most))


def decoded(place: object, data: bytes) -> str:
    """Return UTF-8 text without a byte order mark; InputError with the line for anything else."""
    try:
        return data.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        line = data.count(b"\n", 0, error.start) + 1
        raise InputError(f"{place}:{line}: not UTF-8 text ({error.reason} at byte {error.start}).") from error


def read_lines(path: Path, longest: int) -> Iterator[tuple[int, str]]:
    """Yield each line of UTF-8 text with its number and without its end; only one is in memory at a time.

    Lines end with LF, CR LF or CR. InputError with file and line for a line of more than `longest` bytes and for bytes that
    are no UTF-8; InputError for a file that cannot be read or is larger than LARGEST_FILE.
    """
    with reading(path):
        _refuse_device(path)
        with path.open("rb") as file:
            yield from cut_lines(path, file, longest)


def cut_lines(path: Path, file: BufferedIOBase, longest: int, counted: str = "bytes") -> Iterator[tuple[int, str]]:
    """Do as `read_lines` for an open file. `counted` names the unit of the size in the message for a file too large."""
    number = read = 0
    while data := file.readline(longest + 1):
        read += len(data)
        refuse_beyond(path, read, LARGEST_FILE, counted)
        if len(data) > longest and not data.endswith(b"\n"):
            raise InputError(f"{path}:{number + 1}: a line of more than {longest} bytes; break it up.")
        for part in _parts(data.removeprefix(b"\xef\xbb\xbf") if number == 0 else data):
            number += 1
            yield number, _decoded_line(path, number, part)


def _parts(data: bytes) -> list[bytes]:
    """Cut the bytes up to a LF at every CR that stands alone."""
    body = data.removesuffix(b"\n").removesuffix(b"\r")
    return body.split(b"\r")


def _decoded_line(path: Path, number: int, data: bytes) -> str:
    """Return one line as text; InputError with file and line if it is none."""
    try:
        return data.decode()
    except UnicodeDecodeError as error:
        raise InputError(f"{path}:{number}: not UTF-8 text ({error.reason} at byte {error.start} of it).") from error


def refuse_beyond(place: object, found: int, most: int, what: str) -> None:
    """Raise InputError if an input has more than `most` of `what`, such as bytes."""
    if found > most:
        raise InputError(f"{place}: more than {most} {what}; this is too large to be read at once, split it.")


def _refuse_device(path: Path) -> None:
    if path.exists() and not path.is_file():
        raise InputError(f"{path}: {'a folder' if path.is_dir() else 'a device, pipe or socket'}, not a file.")
