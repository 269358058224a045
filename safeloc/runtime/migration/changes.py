"""What is changed in a file: which name became which, how often, and where first; and names within text."""

from __future__ import annotations

import json
import re
from collections.abc import Iterable
from dataclasses import dataclass

_STRING = re.compile(r'"(?:[^"\\]|\\.)*"')


@dataclass(frozen=True)
class Change:
    """A name that is another one now."""

    old: str
    new: str
    line: int
    times: int = 1

    @property
    def words(self) -> str:
        """In words: `over_mm -> margin_above_mm (12 times, first in line 3)`."""
        where = f"line {self.line}" if self.times == 1 else f"{self.times} times, first in line {self.line}"
        return f"{self.old} -> {self.new} ({where})"


def summed(changes: Iterable[Change]) -> tuple[Change, ...]:
    """Every pair of names once, in the order in which they come."""
    found: dict[tuple[str, str], Change] = {}
    for one in changes:
        before = found.get((one.old, one.new))
        times = one.times + (0 if before is None else before.times)
        found[one.old, one.new] = Change(one.old, one.new, one.line if before is None else before.line, times)
    return tuple(found.values())


def with_names(text: str, names: dict[str, str]) -> str:
    """The text with these names within quotes replaced, and all else as it stands."""

    def renamed(found: re.Match[str]) -> str:
        new = names.get(json.loads(found[0]))
        return found[0] if new is None else json.dumps(new)

    return _STRING.sub(renamed, text)
