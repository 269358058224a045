"""Choice of the mutants to judge, by part of the declaration, number or id."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

from safeloc.assurance.mutation.clauses import clause_mutants
from safeloc.assurance.mutation.declared import Declared
from safeloc.assurance.mutation.mutants import Mutant, mutants, sample
from safeloc.assurance.mutation.places import Places
from safeloc.assurance.mutation.results import Judged, Of
from safeloc.assurance.mutation.weaker import claim_mutants
from safeloc.assurance.mutation.work import Judging
from safeloc.errors import InputError

MADE: Mapping[Of, Callable[[Declared, Places], list[Mutant]]] = {
    "machine": mutants,
    "world": clause_mutants,
    "claims": claim_mutants,
}


@dataclass(frozen=True, eq=False)
class _Chosen:
    """Mutants to judge, by part of the declaration.

    of        number of all mutants from which these were chosen
    against   mutants of the machine that a weaker claim still has to detect; none if no claim is judged
    existing  ids of all mutants, chosen or not, by part of the declaration
    """

    parts: Mapping[Of, Sequence[Mutant]]
    of: int
    against: Sequence[Mutant]
    existing: Mapping[Of, frozenset[str]]

    @property
    def number(self) -> int:
        """The number of mutants to judge, including those that are judged only for claims."""
        return len({one.id for group in (*self.parts.values(), self.against) for one in group})


def chosen(declared: Declared, places: Places, parts: Sequence[Of], *, most: int | None, seed: int) -> _Chosen:
    """Return all mutants of these parts, or a sample of at most `most` of each; claims also need those of the machine."""

    def some(part: Of) -> list[Mutant]:
        every = MADE[part](declared, places)
        existing[part] = _ids(every)
        return sample(every, len(every) if most is None else most, seed)

    existing = dict[Of, frozenset[str]]()
    made: dict[Of, Sequence[Mutant]] = {part: some(part) for part in dict.fromkeys(parts)}
    of = sum(map(len, existing.values()))
    against = made.get("machine") or some("machine") if "claims" in made else []
    return _Chosen(made, of, against, existing)


def _ids(mutants: Sequence[Mutant]) -> frozenset[str]:
    return frozenset(one.id for one in mutants)


def by_id(declared: Declared, places: Places, ids: Sequence[str], *, most: int | None, seed: int) -> _Chosen:
    """Return the mutants with these ids; `most` limits only those of the machine that claims need. InputError: unknown id."""
    every: dict[Of, list[Mutant]] = {part: make(declared, places) for part, make in MADE.items()}
    made: dict[Of, Sequence[Mutant]] = {part: [one for one in group if one.id in ids] for part, group in every.items()}
    missing = sorted(set(ids) - {one.id for group in made.values() for one in group})
    if missing:
        raise InputError(f"{declared.machine.name} has no mutant {missing[0]!r}; --json lists them, of each --of.")
    machine = every["machine"]
    against = sample(machine, len(machine) if most is None else most, seed) if made["claims"] else []
    existing: dict[Of, frozenset[str]] = {part: _ids(group) for part, group in every.items()}
    return _Chosen(
        {part: group for part, group in made.items() if group}, sum(map(len, every.values())), against, existing
    )


def judge(judging: Judging, some: _Chosen) -> list[Judged]:
    """Judge all chosen mutants; return the results in the order machine, world, claims."""
    machine = {one.id: one for one in some.parts.get("machine", ())} | {one.id: one for one in some.against}
    judged = {one.id: one for one in judging.of_machine([*machine.values()])}
    found = [judged[one.id] for one in some.parts.get("machine", ())]
    found += judging.of_world(some.parts.get("world", ()))
    against = [(one, judged[one.id]) for one in some.against]
    return [*found, *judging.of_claims(some.parts.get("claims", ()), against)]
