"""The results of mutants, as plain data with a stable schema (safeloc-mutation/1)."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from types import MappingProxyType
from typing import Any, Literal

SCHEMA = "safeloc-mutation/1"
Of = Literal["machine", "world", "claims"]
"""The part of a declaration that is made wrong."""
OTHERS: tuple[Of, ...] = ("world", "claims")

REFUSED = "refused at birth"
REFUTED = "refuted by a run"
SEARCHED = "refuted by bounded search"
OVERLAP = "rows overlap"
NEVER = "something never happens"
UNPROVED = "no longer proved"
RECORDED = "a recording comes out otherwise"
EQUIVALENT = "equivalent"
CONSERVATIVE = "conservative"
SURVIVED = "survived"

# of clauses of the world
EXCLUDED = "a recording is not lawful any more"
TOO_MUCH = "asks for more than the claims need"
UNSEEN = "excludes nothing that was recorded"

# of claims
NEEDED = "a proof needs the stronger one"
KILLS_LESS = "kills less"
KILLS_AS_MUCH = "kills as much"
NOT_WEAKER = "not weaker"

BY_PROOF = (REFUSED, REFUTED, SEARCHED, OVERLAP, NEVER, UNPROVED, NEEDED, KILLS_LESS)
"""Fates that count as killed by a proof: the declaration is refused, a claim is refuted or no longer proved, or something is
proved impossible. For a weaker claim: a proof, or the detection of a mutant, needs the original."""
SET_ASIDE = (EQUIVALENT, CONSERVATIVE, NOT_WEAKER)
"""Fates of mutants that are not wrong, or not weaker; they are not counted."""
QUESTIONS = (SURVIVED, RECORDED, TOO_MUCH, UNSEEN, KILLS_AS_MUCH)
"""Fates that leave a question: no proof detects the mutant."""


@dataclass(frozen=True)
class Outcome:
    """The outcome of one way of making a mutant.

    fate   one of the fates above
    by     the claims that detect the mutant, or what cannot happen; for `KILLS_LESS` the mutant that escapes
    how    details as text, such as the run and its length, or how it was proved
    """

    fate: str
    by: tuple[str, ...] = ()
    how: str = ""


@dataclass(frozen=True)
class Judged:
    """A mutant with its outcomes: `everywhere` with the term wrong wherever it stands, `alone` with the machine alone wrong.

    If both ways make the same edit, both outcomes are the same.

    of         part of the declaration that is wrong
    direction  for a clause or claim: same, weaker, stronger or other, compared with the original; else ""
    """

    id: str
    machine: str
    kind: str
    words: str
    place: str
    source: str
    term: str
    becomes: str
    where: tuple[str, ...]
    shared_with: tuple[str, ...]
    requirements: tuple[str, ...]
    everywhere: Outcome
    alone: Outcome
    seconds: float
    of: Of = "machine"
    direction: str = ""

    def outcome(self, *, machine_only: bool) -> Outcome:
        """Return the outcome of one of the two ways of making the mutant."""
        return self.alone if machine_only else self.everywhere

    @property
    def proves_itself(self) -> bool:
        """A proof kills the mutant with the machine alone wrong, but not with the same error in claims and world."""
        return self.everywhere.fate in (SURVIVED, RECORDED) and self.alone.fate in BY_PROOF


@dataclass(frozen=True)
class Score:
    """The numbers of mutants by fate.

    by_property  mutants that a property was seen to detect, not only a lemma, a range or the exclusion of rows
    conservative mutants that are proved conservative
    set_aside    mutants that do not count: equivalent, conservative, or a claim that is not weaker
    """

    mutants: int
    fates: dict[str, int]
    killed_by_proof: int
    by_property: int
    equivalent: int
    conservative: int
    set_aside: int

    @property
    def asked(self) -> int:
        """The number of mutants that count: all that are not set aside."""
        return self.mutants - self.set_aside

    @property
    def share(self) -> float:
        """The share of these mutants that a proof kills; 1 if there are none."""
        return self.killed_by_proof / self.asked if self.asked else 1.0


def score(outcomes: Sequence[Outcome]) -> Score:
    """Count the fates."""
    fates = Counter(one.fate for one in outcomes)
    by_property = sum(any(claim.startswith("property ") for claim in one.by) for one in outcomes)
    killed, aside = (sum(fates[fate] for fate in some) for some in (BY_PROOF, SET_ASIDE))
    return Score(len(outcomes), dict(fates), killed, by_property, fates[EQUIVALENT], fates[CONSERVATIVE], aside)


def kills_alone(judged: Sequence[Judged]) -> dict[str, list[str]]:
    """Return for each claim the mutants of the machine that only it was seen to detect, with the term wrong everywhere."""
    found: dict[str, list[str]] = {}
    for one in of_part(judged, "machine"):
        if one.everywhere.fate in BY_PROOF and len(one.everywhere.by) == 1:
            found.setdefault(one.everywhere.by[0], []).append(one.id)
    return found


def of_part(judged: Sequence[Judged], part: Of) -> list[Judged]:
    """Return the results in which this part of the declaration is wrong."""
    return [one for one in judged if one.of == part]


def by_requirement(judged: Sequence[Judged]) -> dict[str, Score]:
    """Return for each requirement the score of the mutants of rows that implement it, with the term wrong everywhere."""
    judged = of_part(judged, "machine")
    names = sorted({name for one in judged for name in one.requirements})
    return {name: score([one.everywhere for one in judged if name in one.requirements]) for name in names}


def questions(judged: Sequence[Judged], *, machine_only: bool = False) -> list[Judged]:
    """Return the results of mutants that no proof detects."""
    return [one for one in judged if one.outcome(machine_only=machine_only).fate in QUESTIONS]


def needless(judged: Sequence[Judged], reasons: Mapping[str, str]) -> list[Judged]:
    """Return the mutants with a needless written reason: a proof kills them, or they are set aside."""
    return [one for one in judged if one.id in reasons and one.everywhere.fate not in QUESTIONS]


def as_data(
    target: str,
    judged: Sequence[Judged],
    *,
    of: int,
    seed: int,
    seconds: float,
    reasons: Mapping[str, str] = MappingProxyType({}),
) -> dict[str, Any]:
    """Return the results as data for JSON.

    of       number of all mutants, judged or not
    reasons  written reasons why no proof needs to detect a mutant, by id
    """
    machine = of_part(judged, "machine")
    others: dict[str, list[Judged]] = {part: of_part(judged, part) for part in OTHERS}
    return {
        "schema": SCHEMA,
        "target": target,
        "mutants": of,
        "judged": len(judged),
        "seed": seed,
        "seconds": round(seconds, 1),
        "everywhere": _score_data(score([one.everywhere for one in machine])),
        "machine_only": _score_data(score([one.alone for one in machine])),
        **{part: _score_data(score([one.alone for one in results])) for part, results in others.items() if results},
        "requirements": {name: _score_data(one) for name, one in by_requirement(judged).items()},
        "kills_alone": kills_alone(judged),
        "without_reason": [one.id for one in questions(judged) if one.id not in reasons],
        "needless_reasons": [one.id for one in needless(judged, reasons)],
        "results": [
            {**asdict(one), "proves_itself": one.proves_itself, "reason": reasons.get(one.id, "")} for one in judged
        ],
    }


def _score_data(one: Score) -> dict[str, Any]:
    return {**asdict(one), "share_killed_by_proof": round(one.share, 4)}


def from_data(data: dict[str, Any]) -> Judged:
    """Return a result from its data."""
    plain = {name: value for name, value in data.items() if name not in ("proves_itself", "reason")}
    for name in ("where", "shared_with", "requirements"):
        plain[name] = tuple(plain[name])
    for name in ("everywhere", "alone"):
        plain[name] = Outcome(plain[name]["fate"], tuple(plain[name]["by"]), plain[name]["how"])
    return Judged(**plain)
