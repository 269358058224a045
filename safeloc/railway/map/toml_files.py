"""Lines as TOML, the native format (docs/line.md), and as JSON of the same shape."""

from __future__ import annotations

import json
import tomllib
from collections import Counter
from pathlib import Path
from typing import Any

import tomli_w
from pydantic import ValidationError

from safeloc.errors import InputError
from safeloc.language.renamed import hint
from safeloc.railway.map.model import Line
from safeloc.runtime.outside import quoted, read_text, reading, refuse_beyond, shortened
from safeloc.runtime.toml_place import line_of, refusal

LARGEST_TEXT = 50_000_000
"""Bytes of a line as TOML or JSON; enough for a hundred thousand edges."""
_MOST_DOTS = 2_000
_FOREIGN = (".railml", ".xml", ".geojson", ".xlsx")
_SHIPPED = Path(__file__).resolve().parents[2] / "models" / "lines"


def from_toml(text: str, name: str) -> Line:
    """Return a line from TOML. `name` stands for the text in messages.

    Raises InputError with line and key for anything wrong in it, including the checksum.
    """
    _refuse_long_keys(text, name)
    try:
        data = tomllib.loads(text)
    except tomllib.TOMLDecodeError as error:
        raise InputError(f"{name}: not TOML: {error}.") from error
    except RecursionError as error:
        raise InputError(f"{name}: nested too deeply to be a line.") from error
    except ValueError as error:  # a number of thousands of digits
        raise InputError(f"{name}: not TOML: {shortened(error)}.") from error
    return _line(data, name, lambda path: f"{name}:{line_of(text, path)}")


def from_json(text: str, name: str) -> Line:
    """Return a line from JSON. InputError as in `from_toml`, with keys but no lines."""
    try:
        data = json.loads(text, object_pairs_hook=lambda pairs: _without_double_keys(pairs, name))
    except json.JSONDecodeError as error:
        raise InputError(f"{name}:{error.lineno}: not JSON: {error.msg}.") from error
    except RecursionError as error:
        raise InputError(f"{name}: nested too deeply to be a line.") from error
    except ValueError as error:
        if isinstance(error, InputError):
            raise
        raise InputError(f"{name}: not JSON: {shortened(error)}.") from error
    return _line(data, name, lambda _: name)


def to_toml(line: Line) -> str:
    """Return the line as TOML, without default values."""
    return tomli_w.dumps(line.model_dump(mode="json", exclude_defaults=True))


def load_line(path: Path) -> Line:
    """Return a line from a .toml or .json file. InputError with file, line and key for anything wrong in it."""
    with reading(path):
        text = read_text(path, LARGEST_TEXT)
        return from_json(text, str(path)) if path.suffix == ".json" else from_toml(text, str(path))


def _refuse_long_keys(text: str, name: str) -> None:
    """Refuse keys with very many parts, which take a time quadratic in their number."""
    for number, line in enumerate(text.splitlines(), 1):
        refuse_beyond(f"{name}:{number}", line.count("."), _MOST_DOTS, "points in one line")


def shipped_lines() -> dict[str, Path]:
    """Return the worked examples by name."""
    return {path.stem: path for path in sorted(_SHIPPED.glob("*.toml"))}


def find_line(name: str) -> Line:
    """Return a shipped line by name, or a line from the file of that name. InputError if there is neither.

    A map of another format is refused, with the command that converts it.
    """
    known = shipped_lines()
    if name in known:
        return load_line(known[name])
    if Path(name).suffix.lower() in _FOREIGN:
        raise InputError(
            f"{name}: a map of another format; convert it first, and read the notes: "
            f"safeloc import {name} --out {Path(name).stem}.toml"
        )
    if not Path(name).is_file():
        raise InputError(
            f"{name}: no such file, and no shipped line; shipped are {', '.join(known)}.{hint(name, known)}"
        )
    return load_line(Path(name))


def _line(data: Any, name: str, where: Any) -> Line:
    if not isinstance(data, dict):
        raise InputError(f"{name}: a line is a table of keys, not {type(data).__name__}.")
    try:
        return Line.model_validate_json(json.dumps(data, allow_nan=True, default=str))
    except RecursionError as error:
        raise InputError(f"{name}: nested too deeply to be a line.") from error
    except ValidationError as error:
        raise InputError(refusal(error, where)) from error


def _without_double_keys(pairs: list[tuple[str, Any]], name: str) -> dict[str, Any]:
    """Refuse a key that is given twice, as TOML does; JSON alone would take the last one."""
    found = dict(pairs)
    if len(found) < len(pairs):
        counts = Counter(key for key, _ in pairs)
        twice = next(key for key, count in counts.items() if count > 1)
        raise InputError(f"{name}: key {quoted(twice)} is given twice.")
    return found
