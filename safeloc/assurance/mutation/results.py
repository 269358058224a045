"""What became of a mutant, as plain data with a stable form (safeloc-mutation/1)."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from typing import Any

SCHEMA = "safeloc-mutation/1"

REFUSED = "refused at birth"
REFUTED = "refuted by a run"
SEARCHED = "refuted by bounded search"
OVERLAP = "rows overlap"
NEVER = "something never happens"
UNPROVED = "no longer proved"
RECORDED = "a recording comes out otherwise"
EQUIVALENT = "equivalent"
SURVIVED = "survived"

BY_PROOF = (REFUSED, REFUTED, SEARCHED, OVERLAP, NEVER, UNPROVED)
"""What counts as killed by a proof: a claim is refuted, no longer proved, or the declaration is none."""


@dataclass(frozen=True)
class Outcome:
    """What became of one way of making a mutant.

    fate   one of the words above
    by     the claims that notice it; of a recording what comes out otherwise
    how    in words: the run and its length, what was proved
    """

    fate: str
    by: tuple[str, ...] = ()
    how: str = ""


@dataclass(frozen=True)
class Judged:
    """A mutant with what became of it: `everywhere` is the edit of the term wherever it stands, `alone` of the machine only.

    Where both are the same edit, both are the same outcome.
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

    @property
    def proves_itself(self) -> bool:
        """Whether claims notice the wrong machine only as long as they are not wrong along with it."""
        return self.everywhere.fate in (SURVIVED, RECORDED) and self.alone.fate in BY_PROOF


@dataclass(frozen=True)
class Score:
    """How many mutants came to which end.

    by_property  those of the killed ones that some property was seen to notice, and not only a lemma, a range, a row
    """

    mutants: int
    fates: dict[str, int]
    killed_by_proof: int
    by_property: int
    equivalent: int

    @property
    def share(self) -> float:
        """Killed by a proof, of those that are not equivalent; 1 where there is none."""
        asked = self.mutants - self.equivalent
        return self.killed_by_proof / asked if asked else 1.0


def score(outcomes: Sequence[Outcome]) -> Score:
    """Count the fates."""
    fates = Counter(one.fate for one in outcomes)
    by_property = sum(any(claim.startswith("property ") for claim in one.by) for one in outcomes)
    return Score(len(outcomes), dict(fates), sum(fates[fate] for fate in BY_PROOF), by_property, fates[EQUIVALENT])


def kills_alone(judged: Sequence[Judged]) -> dict[str, list[str]]:
    """Of each claim the mutants that no other claim was seen to notice, with the term wrong everywhere."""
    found: dict[str, list[str]] = {}
    for one in judged:
        if one.everywhere.fate in BY_PROOF and len(one.everywhere.by) == 1:
            found.setdefault(one.everywhere.by[0], []).append(one.id)
    return found


def by_requirement(judged: Sequence[Judged]) -> dict[str, Score]:
    """The score of the rows that answer for each requirement."""
    names = sorted({name for one in judged for name in one.requirements})
    return {name: score([one.everywhere for one in judged if name in one.requirements]) for name in names}


def as_data(target: str, judged: Sequence[Judged], *, of: int, seed: int, seconds: float) -> dict[str, Any]:
    """The result as JSON has it; `of` is how many mutants there are in all."""
    return {
        "schema": SCHEMA,
        "target": target,
        "mutants": of,
        "judged": len(judged),
        "seed": seed,
        "seconds": round(seconds, 1),
        "everywhere": _score_data(score([one.everywhere for one in judged])),
        "machine_only": _score_data(score([one.alone for one in judged])),
        "requirements": {name: _score_data(one) for name, one in by_requirement(judged).items()},
        "kills_alone": kills_alone(judged),
        "results": [{**asdict(one), "proves_itself": one.proves_itself} for one in judged],
    }


def _score_data(one: Score) -> dict[str, Any]:
    return {**asdict(one), "share_killed_by_proof": round(one.share, 4)}


def from_data(data: dict[str, Any]) -> Judged:
    """One result, read back."""
    plain = {name: value for name, value in data.items() if name != "proves_itself"}
    for name in ("where", "shared_with", "requirements"):
        plain[name] = tuple(plain[name])
    for name in ("everywhere", "alone"):
        plain[name] = Outcome(plain[name]["fate"], tuple(plain[name]["by"]), plain[name]["how"])
    return Judged(**plain)
