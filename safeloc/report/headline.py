"""The headline of a page or a terminal: one sentence about all findings, and the number of each verdict.

`all holds` requires that properties were declared and proved. If results only held on recordings or in tests, or if there was
no property, the headline says so. That of a quick run says that no proof was asked for, whatever else was found.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass

from safeloc.language.verdict import SHOWN, worst

_COUNTED = {
    "proved": "proved",
    SHOWN: SHOWN,
    "held": "held in tests and replays",
    "not asked": "not asked",
    "vacuous": "vacuous",
    "unknown": "undecided",
    "violated": "violated",
}
"""Verdict as it is told -> words for it after a number, from best to worst."""
ALWAYS_COUNTED = ("proved", "held", "unknown", "violated")
BEST_FIRST = tuple(_COUNTED)


@dataclass(frozen=True)
class KindAndVerdict:
    """The fields of one finding that a headline needs.

    quick   whether a quick run left it open (`safeloc verify --quick`)
    by_run  whether it is proved by one run, which shows that something can happen
    """

    kind: str
    verdict: str
    quick: bool = False
    by_run: bool = False


def counted(found: Sequence[KindAndVerdict], always: Sequence[str] = ()) -> str:
    """Count each verdict that occurs, and those in `always`, such as `14 proved, 7 shown by a run, 1 undecided`."""
    number = Counter(SHOWN if one.by_run else one.verdict for one in found)
    return ", ".join(f"{number[word]} {_COUNTED[word]}" for word in BEST_FIRST if number[word] or word in always)


def headline(found: Sequence[KindAndVerdict]) -> str:
    """Return the sentence, which is never better than the worst verdict."""
    if not any(one.quick for one in found):
        return _in_full(found)
    quick, rest = "quick: no proof was asked for", [one for one in found if not one.quick]
    return f"{_in_full(rest)}; {quick}" if worst(one.verdict for one in rest) in _WORSE else quick


_WORSE = ("violated", "unknown", "vacuous")
"""Verdicts that the headline of a quick run names before what was not asked."""


def _in_full(found: Sequence[KindAndVerdict]) -> str:
    match worst(one.verdict for one in found):
        case "violated":
            return "not all holds"
        case "unknown":
            return "undecided: at least one result is neither proved nor refuted"
        case "vacuous":
            return "vacuous: the case of at least one property never occurs"
        case "not asked":
            return _not_asked(found)
        case _:
            return _good(found)


def _not_asked(found: Sequence[KindAndVerdict]) -> str:
    if any(one.verdict != "not asked" for one in found):
        return "not asked: at least one machine had no property to check"
    return "not asked: there was no property to check"


def _good(found: Sequence[KindAndVerdict]) -> str:
    """Return the headline if no verdict is bad: `all holds` if anything was proved, else the kind of evidence."""
    if any(one.verdict == "proved" for one in found):
        return "all holds"
    kinds, number = {one.kind for one in found}, len(found)
    where = (
        "on recordings" if kinds == {"replay"} else "in tests" if kinds == {"test"} else "in tests and on recordings"
    )
    return f"held {where}: {number} check{'' if number == 1 else 's'}; nothing was proved"
