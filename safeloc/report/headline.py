"""What a page or a terminal says of all findings together: one sentence, and how many there are of each verdict.

`all holds` is said only where something was asked of the machines and proved: what was only held on recordings or in
tests says so, and so does a report in which nothing was asked.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass

from safeloc.language.verdict import WORST_FIRST, worst

COUNTED = {
    "proved": "proved",
    "held": "held in tests and replays",
    "not asked": "not asked",
    "vacuous": "vacuous",
    "unknown": "undecided",
    "violated": "violated",
}
"""Verdict -> the word for it after a number, from best to worst."""
ALWAYS_COUNTED = ("proved", "held", "unknown", "violated")
BEST_FIRST = tuple(reversed(WORST_FIRST))


@dataclass(frozen=True)
class Said:
    """What a headline has to know of one finding: the words of its kind and its verdict."""

    kind: str
    verdict: str


def counted(found: Sequence[Said], always: Sequence[str] = ()) -> str:
    """Such as `21 proved, 1 undecided`: each verdict there is, and those that are counted also where there is none."""
    number = Counter(one.verdict for one in found)
    return ", ".join(f"{number[word]} {COUNTED[word]}" for word in BEST_FIRST if number[word] or word in always)


def headline(found: Sequence[Said]) -> str:
    """The sentence; never better than the worst verdict."""
    match worst(one.verdict for one in found):
        case "violated":
            return "violated"
        case "unknown":
            return "undecided: something is neither shown nor excluded"
        case "vacuous":
            return "vacuous: something is said of what never happens"
        case "not asked":
            return _not_asked(found)
        case _:
            return _good(found)


def _not_asked(found: Sequence[Said]) -> str:
    if any(one.verdict != "not asked" for one in found):
        return "not everything was asked: what holds is not all that is to be shown"
    return "nothing was asked, so nothing is shown"


def _good(found: Sequence[Said]) -> str:
    """Where nothing speaks against it: whether anything was proved, and else on what it was held."""
    if any(one.verdict == "proved" for one in found):
        return "all holds"
    kinds, number = {one.kind for one in found}, len(found)
    where = (
        "on recordings" if kinds == {"replay"} else "in tests" if kinds == {"test"} else "in tests and on recordings"
    )
    return f"held {where}: {number} check{'' if number == 1 else 's'}; nothing was proved"
