"""The strength of the evidence for a requirement: the number of mutants of its rows that its own properties detect.

The label of a property only declares that it verifies a requirement. The requirement counts as shown if one of these properties
detects at least one mutant of the rows that implement it.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, field

from safeloc.assurance.kept_results import KeptResults
from safeloc.assurance.mutation.results import BY_PROOF, Judged, kills_alone, of_part, score
from safeloc.proof.cache.store import Store
from safeloc.target import Target

STRENGTHS = KeptResults("mutation strength")
Strengths = Mapping[str, Sequence["Strength"]]
"""For each requirement, its strength in each target."""


@dataclass(frozen=True)
class Strength:
    """The results of mutants of the rows that implement a requirement, with the term wrong wherever it stands.

    target     name of the target
    judged, of number of judged mutants of the target, and of all its mutants
    wrong      mutants of these rows that are not equivalent or conservative
    by_proof   those that a proof detects
    by_its_own those that a property of this requirement was seen to detect
    alone      for each such property, number of mutants of the target that only it was seen to detect
    """

    target: str
    judged: int
    of: int
    wrong: int
    by_proof: int
    by_its_own: int
    alone: Mapping[str, int] = field(default_factory=dict)

    @property
    def is_shown(self) -> bool:
        """A property of the requirement detects at least one wrong row of it."""
        return self.by_its_own > 0

    def __str__(self) -> str:
        """Return the strength as one line of text."""
        sample = "" if self.judged == self.of else f" (a sample of {self.judged} of {self.of})"
        text = f"{self.target}: of {self.wrong} wrong rules {self.by_its_own} noticed by its properties, {self.by_proof} by any proof{sample}"
        alone = ", ".join(f"{name!r} {count}" for name, count in self.alone.items())
        return f"{text}; alone by {alone}" if alone else text


def strengths(target: Target, judged: Sequence[Judged], of: int) -> dict[str, Strength]:
    """Return the strength of each requirement that rows of the target implement."""
    machine = of_part(judged, "machine")
    by_label: dict[str, set[str]] = {}
    for prop in (*target.properties, *(prop for names in target.members.values() for prop in names)):
        for name in prop.requirements:
            by_label.setdefault(name, set()).add(f"property {prop.name}")
    alone = {claim: len(noticed) for claim, noticed in kills_alone(machine).items()}
    carried = sorted({name for one in machine for name in one.requirements})
    return {
        name: _strength(target.name, name, machine, by_label.get(name, set()), alone, len(machine), of)
        for name in carried
    }


def _strength(
    target: str,
    requirement: str,
    machine: Sequence[Judged],
    names: set[str],
    alone: Mapping[str, int],
    judged: int,
    of: int,
) -> Strength:
    rows = [one.everywhere for one in machine if requirement in one.requirements]
    text = score(rows)
    noticed = sum(one.fate in BY_PROOF and not names.isdisjoint(one.by) for one in rows)
    counted = Counter({name.removeprefix("property "): alone[name] for name in names if name in alone})
    return Strength(target, judged, of, text.asked, text.killed_by_proof, noticed, dict(counted.most_common()))


def keep_strengths(store: Store, target: Target, judged: Sequence[Judged], of: int) -> None:
    """Store the strengths for reports and lists; a smaller sample does not replace a greater one."""
    found = strengths(target, judged, of)
    had = kept_strengths(store, target)
    if found and max((one.judged for one in had.values()), default=0) <= len(of_part(judged, "machine")):
        STRENGTHS.keep(store, target, {name: asdict(one) for name, one in found.items()})


def kept_strengths(store: Store | None, target: Target) -> dict[str, Strength]:
    """Return the strengths stored for this target; none if it was never judged, or has changed since."""
    data = None if store is None else STRENGTHS.kept(store, target)
    return {} if data is None else {name: Strength(**one) for name, one in data.items()}


def as_text(found: Sequence[Strength]) -> list[str]:
    """Return the lines about one requirement, one for each target; the last says so if no target shows it."""
    if not found:
        return ["not measured: no run of `safeloc mutate` on the present state of the machines that implement it"]
    text = list(map(str, found))
    return (
        text
        if any(one.is_shown for one in found)
        else [*text, "NOT SHOWN: none of its properties notices a wrong rule of it"]
    )


def as_data(found: Sequence[Strength]) -> list[dict[str, object]]:
    """Return the strengths as data for JSON."""
    return [{**asdict(one), "shown": one.is_shown} for one in found]
