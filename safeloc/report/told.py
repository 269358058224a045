"""Verdicts as a reader of the page is told them: of what always holds, of what one run shows, and of a requirement.

The data have one word, `proved`, for both; what confirmed the result tells them apart: a solver confirms a proof, the interpreter a run.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from safeloc.language.verdict import SHOWN

_INTERPRETER = "interpreter"
"""What confirms a run, in `rechecked` of a result."""
_NOT_AS_SUCH = "properties proved"
"""The verdict of a requirement: no proof is of the requirement itself."""
_KINDS: Mapping[str, tuple[str, str]] = {
    "property": ("property", "properties"),
    "obligation": ("obligation", "obligations"),
    "lemma": ("lemma", "lemmas"),
    "test": ("property test", "property tests"),
    "replay": ("replay", "replays"),
}
"""Kind of a result -> words for one and for several of them."""
_Data = Mapping[str, Any]


def told_of(row: _Data) -> str:
    """Return the verdict of a result of a report: its own, but `shown by a run` where one run is the whole evidence."""
    return SHOWN if row["verdict"] == "proved" and _INTERPRETER in row["rechecked"] else str(row["verdict"])


def requirement_verdict(row: _Data, results: Sequence[_Data]) -> str:
    """Return the verdict of a requirement in a few words; nothing if nothing is about it."""
    if row["verdict"] != "proved":
        return str(row["verdict"])
    return _NOT_AS_SUCH if any(told_of(one) == "proved" for one in results) else SHOWN


def requirement_lines(results: Sequence[_Data]) -> Iterator[tuple[str, str]]:
    """Yield words and verdict for each kind of evidence of a requirement, such as `3 properties proved`."""
    for (kind, verdict), number in Counter((one["kind"], told_of(one)) for one in results).items():
        one, several = _KINDS[kind]
        yield f"{number} {one if number == 1 else several} {verdict}", verdict
