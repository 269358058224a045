"""Verdicts as a reader of the page is told them: of what always holds, of what one run shows, and of a requirement.

The verdict in the data is `proved` for both, which is what programs read; beside it the data have `told` where a reader is told another
word. Reports of earlier versions have no such field; there what confirmed the result tells them apart: a solver confirms a proof, the
interpreter a run.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Collection, Iterator, Mapping, Sequence
from typing import Any

from safeloc.language.verdict import SHOWN

_INTERPRETER = "interpreter"
"""What confirms a run, in `rechecked` of a result."""
_EVERY_CASE = "/obligation/antecedents"
"""End of the id of the result that every case of the properties occurs: each has its run in a recording, or with a result of its own."""
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
    """Return the verdict of a result of a report: its own, but `shown by a run` where runs are the whole evidence."""
    by_runs = _INTERPRETER in row["rechecked"] or row["id"].endswith(_EVERY_CASE)
    return str(row.get("told") or (SHOWN if row["verdict"] == "proved" and by_runs else row["verdict"]))


def requirement_verdict(verdict: str, told: Collection[str]) -> str:
    """Return the verdict of a requirement in a few words, from that of its results as they are told; nothing if nothing is about it."""
    if verdict != "proved":
        return verdict
    return _NOT_AS_SUCH if "proved" in told else SHOWN


def requirement_lines(results: Sequence[_Data]) -> Iterator[tuple[str, str]]:
    """Yield words and verdict for each kind of evidence of a requirement, such as `3 properties proved`."""
    for (kind, verdict), number in Counter((one["kind"], told_of(one)) for one in results).items():
        one, several = _KINDS[kind]
        yield f"{number} {one if number == 1 else several} {verdict}", verdict
