"""What was compared, what disagreed, and what stayed undecided. Nothing here is safeloc's."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from typing import Any

# Ways of declaring that once led to a wrong verdict or to back ends that diverge. Where one was drawn, and is refused
# with a ModelError or PropertyError, that is right; accepted, it must be judged rightly.
TRAPS = frozenset(
    {
        "ghost input shared with an input",
        "ghost shared with an input",
        "helper reads inputs",
        "inherited over a wire",
        "initially over ghosts",
        "optional shared",
        "range lies",
        "source named twice",
        "wire reads a ghost",
    }
)


@dataclass(frozen=True)
class Expect:
    """What is required besides sound verdicts; each stands for a defect until it is mended.

    vacuous            nothing is Proved whose trigger never occurs, or whose assumption no run keeps for ever
    dead_ends          `dead ends` is Proved only where every lawful run can go on
    overlap_happens    overlap and absence are Violated only where a run shows it
    falsifier_starts   a falsifier that finds no first state is Unknown
    """

    vacuous: bool = False
    dead_ends: bool = False
    overlap_happens: bool = False
    falsifier_starts: bool = False


@dataclass
class Tally:
    """Counts of one case or of many."""

    compared: Counter[str] = field(default_factory=Counter)
    undecided: Counter[str] = field(default_factory=Counter)
    refused: Counter[str] = field(default_factory=Counter)
    wrong: list[str] = field(default_factory=list)

    def judge(self, what: str, complaint: str) -> None:
        """One comparison; an empty complaint is agreement."""
        self.compared[what] += 1
        if complaint:
            self.wrong.append(f"{what}: {complaint}")

    def open(self, what: str) -> None:
        """One comparison of something undecided: no disagreement."""
        self.compared[what] += 1
        self.undecided[what] += 1

    def add(self, other: Tally) -> None:
        """Another one's counts as well."""
        self.compared += other.compared
        self.undecided += other.undecided
        self.refused += other.refused
        self.wrong += other.wrong

    def data(self) -> dict[str, Any]:
        """As plain data."""
        counts = {name: dict(getattr(self, name)) for name in ("compared", "undecided", "refused")}
        return {**counts, "wrong": self.wrong}


def tally(data: Mapping[str, Any]) -> Tally:
    """From plain data."""
    counts = {name: Counter(data[name]) for name in ("compared", "undecided", "refused")}
    return Tally(**counts, wrong=list(data["wrong"]))


def total(tallies: Iterable[Tally]) -> Tally:
    """All together."""
    all_ = Tally()
    for one in tallies:
        all_.add(one)
    return all_
