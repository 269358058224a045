"""Code that the line and the window of `safeloc step` share: it reads commands and describes transitions."""

from __future__ import annotations

import shlex
from collections.abc import Iterator, Mapping, Sequence

from safeloc.errors import InputError
from safeloc.explain.failing_parts import Part
from safeloc.explain.stepping import RowView

_MOST_PARTS = 12


def number_of_steps(text: str, command: str) -> int:
    """Return the number of steps that a command names, 1 if it names none. InputError for anything else."""
    if not text:
        return 1
    if not text.isdecimal() or int(text) < 1:
        raise InputError(f"{command} {text!r}: give a number of steps, 1 or more.")
    return int(text)


def words(text: str) -> list[str]:
    """Return the words of a command; a name with blanks stands in quotes. InputError for a quote without its end."""
    try:
        return shlex.split(text)
    except ValueError as error:
        raise InputError(f"{text!r}: a quote has no end.") from error


def quoted(name: str) -> str:
    """Return a name as `words` reads it."""
    return shlex.quote(name) if " " in name or "'" in name or '"' in name else name


def assignments(text: str) -> Iterator[tuple[str, str]]:
    """Yield name and value of each `NAME=VALUE`. InputError for another word."""
    for word in words(text):
        name, equal, value = word.partition("=")
        if not equal:
            raise InputError(f"{word!r}: write NAME=VALUE, without blanks around the sign.")
        yield name, value


def refuse_unknown(names: list[str], known: dict[str, str]) -> None:
    """Raise InputError for a name to watch that is no variable and no output."""
    for name in names:
        if name not in known:
            raise InputError(f"there is no variable or output {name!r}; `state` and `outputs` list them.")


def end_told(recorded: int, taken: int, wanted: int) -> str:
    """Return what is said where a recording ends, and a number of steps was wanted."""
    some = f": {taken} of {wanted} steps taken" if wanted > 1 else ""
    return f"the recording ends at step {recorded}{some}; further steps take what you set, and all else is at rest"


def broken_lines(broken: Mapping[str, Sequence[Part]]) -> Iterator[str]:
    """Yield the properties that a step broke, each with the parts of its term that fail."""
    for name, parts in broken.items():
        yield f"VIOLATED {name}"
        yield from (_part_line(part) for part in parts[:_MOST_PARTS])
        if len(parts) > _MOST_PARTS:
            yield f"         ... {len(parts) - _MOST_PARTS} more parts; `safeloc explain` shows them on the saved run"


def row_lines(row: RowView) -> Iterator[str]:
    """Yield a transition's lines: whether it fires, and of a refused one the parts of the guard that do not hold."""
    word = "fires" if row.fires else "enabled" if row.enabled else "refused"
    yield f"{word:8} {row.machine}: {row.name} -> {row.target}"
    if not row.enabled:
        yield from (_part_line(part) for part in row.why)


def _part_line(part: Part) -> str:
    values = ", ".join(f"{name} = {value}" for name, value in part.values.items())
    return f"         {'  ' * part.depth}{'true ' if part.holds else 'false'} {part.text}    {values}".rstrip()
