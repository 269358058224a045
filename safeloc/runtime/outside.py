"""External input: one rule for all errors, and bounded reading of files.

    with reading(path):   a file's flaw is an InputError that names the file; so is a file that cannot be read
                          any other exception is an UnforeseenError: refused as well, and reported as a defect of safeloc

External input raises only a SafelocError, and an error of safeloc itself is never reported as a flaw of the input.
`refusal` applies the same rule where a message is returned instead of an exception.
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
"""Bytes of a file that is read whole or line by line."""

WHOLE = re.compile(r"[+-]?[0-9]+")
NUMBER = re.compile(r"[+-]?(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][+-]?[0-9]{1,3})?")
"""Numbers of files have ASCII digits only: Python's own `int`, `float` and `Decimal` take those of every script, and `_`."""

MOST_DIGITS = 1_000
"""Of a whole number in a file; longer ones take time that grows with the square."""

_CHUNK = 1 << 20
_TOO_LARGE = "takes more memory than there is; give a smaller one"


@contextmanager
def reading(place: object) -> Iterator[None]:
    """The rule of every border that raises. `place` is what messages begin with, such as a path.

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
    """The same for a file, where flaws are found that do not know it: they are told with its `name`, by default its path."""
    try:
        with reading(path):
            yield
    except UnforeseenError:
        raise
    except InputError as error:
        told = str(error)
        if told.startswith((str(path), path.name)):
            raise
        raise type(error)(f"{name or path}: {told}") from error


def refusal(error: Exception) -> str:
    """Why what came is refused, for borders that answer instead of raising; what nobody foresaw is told as such."""
    match error:
        case SafelocError():
            return str(error)
        case OSError():
            return unreadable(error)
        case MemoryError():
            return _TOO_LARGE
        case _:
            return f"{UNFORESEEN} ({shortened(error)}, {_where(error)}). Please report it with the input."


UNFORESEEN = "not read, for safeloc itself failed on it"
"""What a message about an unforeseen failure says."""


def unreadable(error: OSError) -> str:
    """Why the system does not let a file be read."""
    return f"cannot be read: {error.strerror or error}"


def shortened(error: BaseException) -> str:
    """Kind and first line of an error, not longer than a line; for errors of others, which quote without bounds."""
    first = (_text(error).splitlines() or [""])[0]
    return f"{type(error).__name__}: {first[:200]}" if first else type(error).__name__


def _text(error: BaseException) -> str:
    try:
        return str(error)
    except Exception:  # an error of somebody else's that cannot even be shown
        return ""


def _where(error: BaseException) -> str:
    """The line in safeloc that failed: the last one on the way that is ours."""
    frames = traceback.extract_tb(error.__traceback__)
    own = [frame for frame in frames if Path(frame.filename).is_relative_to(_ROOT)] or frames
    if not own:
        return "place unknown"
    name = Path(own[-1].filename)
    return f"{name.relative_to(_ROOT.parent) if name.is_relative_to(_ROOT) else name.name}:{own[-1].lineno}"


_ROOT = Path(__file__).resolve().parents[1]
_QUOTED = reprlib.Repr()
_QUOTED.maxstring = _QUOTED.maxother = _QUOTED.maxlong = 80


def quoted(value: object) -> str:
    """Return the received value for a message: at most two lines, however large or deep it is."""
    return _QUOTED.repr(value)[:240]


def shown(name: object) -> str:
    """Return a name that came, without quotes, on one line."""
    return quoted(str(name))[1:-1]


def whole_number(text: str) -> int | None:
    """Return a whole number in ASCII digits; None for other text, and for more than `MOST_DIGITS`."""
    return int(text) if len(text) <= MOST_DIGITS and WHOLE.fullmatch(text) else None


def number(text: str) -> float | None:
    """Return a decimal number in ASCII digits; None for other text, NaN and infinity among it."""
    return float(text) if len(text) <= MOST_DIGITS and NUMBER.fullmatch(text) else None


def read_bytes(path: Path, most: int = LARGEST_FILE) -> bytes:
    """Return the file's bytes. InputError with the path for a file that cannot be read, or is larger than `most`."""
    with reading(path):
        _refuse_device(path)
        with path.open("rb") as file:
            data = file.read(min(fstat(file.fileno()).st_size, most) + 1)
            while len(data) <= most and (more := file.read(_CHUNK)):  # of a file that does not tell its size
                data += more
    refuse_beyond(path, len(data), most, "bytes")
    return data


def read_text(path: Path, most: int = LARGEST_FILE) -> str:
    """Return the file's UTF-8 text without a byte order mark. InputError with the line where it is none, and as `read_bytes`."""
    return decoded(path, read_bytes(path, most))


def decoded(place: object, data: bytes) -> str:
    """UTF-8 text without a byte order mark; InputError with the line for anything else."""
    try:
        return data.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        line = data.count(b"\n", 0, error.start) + 1
        raise InputError(f"{place}:{line}: not UTF-8 text ({error.reason} at byte {error.start}).") from error


def read_lines(path: Path, longest: int) -> Iterator[tuple[int, str]]:
    """Return every line of UTF-8 text with its number, without its end, one in memory at a time.

    Lines end with LF, CR LF or CR, as Python reads text. InputError with file and line for one of more than `longest`
    bytes, for what is no UTF-8, for a file that cannot be read, and one larger than LARGEST_FILE.
    """
    with reading(path):
        _refuse_device(path)
        with path.open("rb") as file:
            yield from cut_lines(path, file, longest)


def cut_lines(path: Path, file: BufferedIOBase, longest: int, counted: str = "bytes") -> Iterator[tuple[int, str]]:
    """Return the same of a file that is open. `counted` says what a file too large has too many of."""
    number = read = 0
    while data := file.readline(longest + 1):
        read += len(data)
        refuse_beyond(path, read, LARGEST_FILE, counted)
        if len(data) > longest and not data.endswith(b"\n"):
            raise InputError(f"{path}:{number + 1}: a line of more than {longest} bytes; break it up.")
        for part in _parts(data.removeprefix(b"\xef\xbb\xbf") if number == 0 else data):
            number += 1
            yield number, decoded_line(path, number, part)


def _parts(data: bytes) -> list[bytes]:
    """Cut the bytes before one LF at every lone CR."""
    body = data.removesuffix(b"\n").removesuffix(b"\r")
    return body.split(b"\r")


def decoded_line(path: Path, number: int, data: bytes) -> str:
    """Return one line as text; InputError with file and line if it is none."""
    try:
        return data.decode()
    except UnicodeDecodeError as error:
        raise InputError(f"{path}:{number}: not UTF-8 text ({error.reason} at byte {error.start} of it).") from error


def refuse_beyond(place: object, found: int, most: int, what: str) -> None:
    """InputError where more was found than is read: with what, where, and what to do."""
    if found > most:
        raise InputError(f"{place}: more than {most} {what}; that is too large to be read at once, split it.")


def _refuse_device(path: Path) -> None:
    if path.exists() and not path.is_file():
        raise InputError(f"{path}: {'a folder' if path.is_dir() else 'a device, pipe or socket'}, not a file.")
