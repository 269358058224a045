"""Decisions about the claims of a stream, as plain data: from it a checker shows every window again.

The hand-over sets alone are told, with the names of their variables. What was folded or asked on the way is not: the checker
makes the cycles of each window anew from the declaration, the stream and the deviations.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from safeloc.language.verdict import Proved, word
from safeloc.proof.around.claims import Asked
from safeloc.proof.around.course import Piece
from safeloc.proof.around.deviations import Deviations
from safeloc.proof.around.members import Member
from safeloc.proof.around.windows import Passage
from safeloc.proof.results import Finding


@dataclass(frozen=True, eq=False)
class Shown:
    """A claim that was shown to hold: the claims that were run together, with or without the world, from hand-over to hand-over.

    facts  certificates of what is proved of every state of the machine with its world
    """

    lawful: bool
    together: Sequence[Asked]
    passage: Passage
    facts: Mapping[str, str]


@dataclass(frozen=True, eq=False)
class Decided:
    """The findings, a lawful stream of the tube, and how claims were shown that hold neither in general nor by a run."""

    findings: list[Finding]
    witness: Member | None
    shown: Mapping[Asked, Shown]


def decided_data(decided: Decided, asked: Sequence[Asked], near: Deviations, without: Sequence[str]) -> dict[str, Any]:
    """Return the question and what decides it, as data for JSON; files are named by who writes them."""
    passages: dict[int, dict[str, Any]] = {}
    claims = []
    for finding, one in zip(decided.findings, asked, strict=True):
        shown = decided.shown.get(one) if isinstance(finding.result, Proved) else None
        if shown is not None:
            passages.setdefault(id(shown.passage.handed), _passage(shown))
        texts = finding.result.certificates if isinstance(finding.result, Proved) else {}
        claims.append(
            {
                **_claim(one),
                "id": finding.id,
                "verdict": word(finding.result),
                "statement": finding.statement,
                "passage": None if shown is None else [*passages].index(id(shown.passage.handed)),
                "certificates": [] if shown is not None else sorted(texts),
            }
        )
    return {
        "within": dict(near.widths),
        "channels": [{"names": [*one.names], "drops": one.drops, "delay": one.delay} for one in near.channels],
        "without": [*without],
        "passages": [*passages.values()],
        "claims": claims,
    }


def _claim(one: Asked) -> dict[str, Any]:
    return {"written": one.own, "claim": one.prop.name, "first": one.first, "last": one.last}


def _passage(shown: Shown) -> dict[str, Any]:
    _, *handed = shown.passage.handed
    return {
        "lawful": shown.lawful,
        "together": [_claim(one) for one in shown.together],
        "handed": [{"cycle": cycle, "pieces": [_piece(one) for one in pieces]} for cycle, pieces in handed],
        "back": [
            {"claim": one.claim, "from": one.handed, "first": one.first, "last": one.last} for one in shown.passage.back
        ],
        "facts": sorted(shown.facts),
    }


def _piece(piece: Piece) -> dict[str, Any]:
    """Return the states that belong to a piece by the names of their variables."""
    return {
        "fixed": {var.name: value for var, value in piece.fixed.items()},
        "ranges": {var.name: [*bounds] for var, bounds in piece.ranges.items()},
    }
