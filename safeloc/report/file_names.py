"""Names of files in a report folder, made from the ids of results and the names of machines."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import count

_LONGEST_NAME = 150


def file_names(finding_ids: Sequence[str]) -> dict[str, str]:
    """Return a readable file name for each id. Two names always differ, even if the file system ignores case."""
    names: dict[str, str] = {}
    taken: set[str] = set()
    for one in dict.fromkeys(finding_ids):
        plain = "".join(letter if letter.isascii() and letter.isalnum() else "-" for letter in one)[:_LONGEST_NAME]
        name = next(name for name in _numbered(plain) if name.casefold() not in taken)
        taken.add(name.casefold())
        names[one] = name
    return names


def _numbered(plain: str) -> Iterator[str]:
    yield plain
    yield from (f"{plain}-{number}" for number in count(2))
