"""All mutants of a declaration: one wrong term, or one wrong row, each.

Every mutant is made in two ways. With the machine alone wrong it asks whether claims and world notice. With the term wrong
wherever it stands (an edit of the expression that wrote it) it asks whether they still would, or are wrong along with
the machine. Where a term stands in the machine only, both are one.
"""

from __future__ import annotations

import hashlib
import random
from collections import Counter, defaultdict
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import partial

from safeloc.assurance.mutation.declared import Declared, Root, exchanged
from safeloc.assurance.mutation.kinds import Change, Others, changes
from safeloc.assurance.mutation.places import Places
from safeloc.assurance.mutation.results import Of
from safeloc.assurance.mutation.rows import RowEdit, row_edits
from safeloc.assurance.mutation.same import Forms, Term, terms_of
from safeloc.assurance.source_places import Place
from safeloc.language.expr import Expr, Optional, Var
from safeloc.language.machine import Machine
from safeloc.language.nodes import BoolVar, NumVar
from safeloc.language.render import infix
from safeloc.language.terms import Substitution, children

LONGEST = 160


@dataclass(frozen=True, eq=False, kw_only=True)
class Mutant:
    """One mutant.

    id            of its content: the same after edits elsewhere
    of            what of the declaration is wrong
    machine       the machine that is wrong
    kind, words   what is done, in general and here
    place         file and line of the term or row; "" where that was not noted
    source        the expression as it is written there
    term, becomes what stands there, and what is written instead
    where         rows and outputs that it is part of
    shared_with   claims, clauses and lemmas that have the same term
    requirements  ids that those rows answer for, or that the claim verifies
    alone         makes of a declaration one with the machine (the world, the claim) alone wrong
    everywhere    makes of a declaration one with the term wrong wherever it stands; None where that is the same
    claim         name of the claim that is weaker; "" of any other mutant
    """

    id: str = ""
    machine: str
    kind: str
    words: str
    place: str = ""
    source: str = ""
    term: str
    becomes: str
    where: tuple[str, ...]
    shared_with: tuple[str, ...] = ()
    requirements: tuple[str, ...] = ()
    alone: Callable[[Declared], Declared]
    everywhere: Callable[[Declared], Declared] | None = None
    of: Of = "machine"
    claim: str = ""


def mutants(whole: Declared, places: Places) -> list[Mutant]:
    """All mutants of the machine, in the order of the declaration; each form of a wrong term once."""
    return numbered([*_of_terms(whole, places), *_of_rows(whole)])


def numbered(made: Iterable[Mutant]) -> list[Mutant]:
    """The mutants with their ids."""
    seen = Counter[str]()
    return [_numbered(one, seen) for one in made]


def _numbered(one: Mutant, seen: Counter[str]) -> Mutant:
    """With the id of its content, and which of several with that content it is."""
    content = "\0".join([one.machine, one.kind, one.words, one.term, one.becomes, *one.where])
    digest = hashlib.sha256(content.encode()).hexdigest()[:10]
    seen[digest] += 1
    number = "" if seen[digest] == 1 else f"-{seen[digest]}"
    return replace(one, id=f"{one.machine}-{digest}{number}")


def sample(made: Sequence[Mutant], most: int, seed: int) -> list[Mutant]:
    """At most so many mutants, of each kind in its share and at least one; the same for the same seed, in order."""
    if most >= len(made):
        return list(made)
    strata: dict[tuple[str, str], list[int]] = defaultdict(list)
    for number, one in enumerate(made):
        strata[one.machine, one.kind].append(number)
    draw, chosen = random.Random(seed), list[int]()
    ranked = [(rank / len(own), number) for own in strata.values() for rank, number in _shuffled(own, draw)]
    chosen = [number for _, number in sorted(ranked)[:most]]
    return [made[number] for number in sorted(chosen)]


def _shuffled(numbers: list[int], draw: random.Random) -> Iterator[tuple[int, int]]:
    return enumerate(draw.sample(numbers, len(numbers)))


# ------------------------------------------------------------------ wrong terms


def _of_terms(whole: Declared, places: Places) -> Iterator[Mutant]:
    forms = Forms(places)
    terms = (term for term in terms_of(whole.roots, places, forms) if term.on_board)
    for term, change, becomes in wrong_terms(terms, changes, other_variables(whole.machine), forms):
        yield _of_term(whole, term, change, becomes)


def wrong_terms(
    terms: Iterable[Term], changes_of: Callable[[Expr, Others], Iterable[Change]], others: Others, forms: Forms
) -> Iterator[tuple[Term, Change, str]]:
    """Each term with each change of it, and what is written then; each form of a wrong term once."""
    for term in terms:
        seen: set[int] = {forms.of(term.node)}
        for change in changes_of(term.node, others):
            wrong = change.make(children(term.node))
            form = forms.of(wrong)
            if form not in seen:
                seen.add(form)
                yield term, change, infix(wrong, LONGEST)


def _of_term(whole: Declared, term: Term, change: Change, becomes: str) -> Mutant:
    def made(of: Declared, *, everywhere: bool) -> Declared:
        return exchanged(of, substitution(term, change), substitution(term, change) if everywhere else None)

    return Mutant(
        machine=whole.machine.name,
        kind=change.kind,
        words=change.words,
        place=told_place(term.place),
        source=written_at(term.place),
        term=infix(term.node, LONGEST),
        becomes=becomes,
        where=tuple(dict.fromkeys(map(str, term.on_board))),
        shared_with=tuple(dict.fromkeys(map(str, term.beyond))),
        requirements=_requirements(term.on_board),
        alone=lambda of: made(of, everywhere=False),
        everywhere=(lambda of: made(of, everywhere=True)) if term.beyond else None,
    )


def substitution(term: Term, change: Change) -> Substitution:
    """Rewrites every node of a term into what is written instead."""
    return Substitution({}, [(node, change.make(children(node))) for node in term.nodes])


def told_place(place: Place | None) -> str:
    """A place for people; "" where it was not noted."""
    return "" if place is None else str(place)


def written_at(place: Place | None) -> str:
    """The expression as it is written there; "" where that was not noted."""
    return "" if place is None else place.text


def _requirements(roots: Sequence[Root]) -> tuple[str, ...]:
    rows = [root.row for root in roots if root.row is not None]
    return tuple(dict.fromkeys(one for row in rows for one in row.requirements))


def other_variables(machine: Machine) -> Others:
    """Of a variable the next one of its unit, among inputs or among state."""
    following: dict[Var, Var] = {}
    for own in (_inputs(machine), list(machine.state)):
        alike: dict[object, list[Var]] = defaultdict(list)
        for var in own:
            alike[var.unit if isinstance(var, NumVar) else BoolVar].append(var)
        for group in alike.values():
            following |= dict(zip(group, [*group[1:], group[0]], strict=True))
    return lambda var: None if following.get(var, var) is var else following[var]


def _inputs(machine: Machine) -> list[Var]:
    """Values and flags; which input is present is told by kind `absence ignored`."""
    return [item.value if isinstance(item, Optional) else item for item in machine.inputs]


# ------------------------------------------------------------------ wrong rows


def _of_rows(whole: Declared) -> Iterator[Mutant]:
    for edit in row_edits(whole.machine, other_variables(whole.machine)):
        yield Mutant(
            machine=whole.machine.name,
            kind=edit.kind,
            words=edit.words,
            place=edit.place,
            term=edit.term,
            becomes=edit.becomes,
            where=edit.where,
            requirements=edit.requirements,
            alone=partial(_with_row, edit),
        )


def _with_row(edit: RowEdit, whole: Declared) -> Declared:
    return replace(whole, machine=edit.make())
