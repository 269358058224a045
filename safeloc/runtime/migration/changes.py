"""The changes in a file: old and new names, how often, and where first; replacement of names in text."""

from __future__ import annotations

import json
import re
from collections.abc import Iterable
from dataclasses import dataclass

_STRING = re.compile(r'"(?:[^"\\]|\\.)*"')


@dataclass(frozen=True)
class Change:
    """A changed name."""

    old: str
    new: str
    line: int
    times: int = 1

    @property
    def words(self) -> str:
        """Return the change in words: `over_mm -> margin_above_mm (12 times, first in line 3)`."""
        where = f"line {self.line}" if self.times == 1 else f"{self.times} times, first in line {self.line}"
        return f"{self.old} -> {self.new} ({where})"


def summed(changes: Iterable[Change]) -> tuple[Change, ...]:
    """Return every pair of names once, in order of appearance, with its number."""
    found: dict[tuple[str, str], Change] = {}
    for one in changes:
        before = found.get((one.old, one.new))
        times = one.times + (0 if before is None else before.times)
        found[one.old, one.new] = Change(one.old, one.new, one.line if before is None else before.line, times)
    return tuple(found.values())


def with_names(text: str, names: dict[str, str]) -> str:
    """Return the text with these names replaced where they stand in quotes."""

    def renamed(found: re.Match[str]) -> str:
        new = names.get(json.loads(found[0]))
        return found[0] if new is None else json.dumps(new)

    return _STRING.sub(renamed, text)
