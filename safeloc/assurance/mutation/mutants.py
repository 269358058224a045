"""The mutants of a machine: each has one wrong term or one wrong row.

A mutant is made in two ways. With the machine alone wrong, the question is whether claims and world detect the error. With the term
wrong wherever it stands, as after an edit of the expression that wrote it, they may contain the same error, and the question is
whether they still detect it. For a term that stands in the machine only, both ways are the same.
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

    id            derived from the content: edits elsewhere do not change it
    of            part of the declaration that is wrong
    machine       name of the machine, or of the composition if a wire is wrong
    kind, words   kind of the change, and description of this one
    place         file and line of the term or row; "" if not recorded
    source        the expression as it is written there; "" if not recorded
    term, becomes original and replacement, as text
    where         rows, outputs, clauses, claims or wires in which the change is made
    shared_with   claims, clauses and lemmas that have the same term
    requirements  ids of the requirements that those rows implement, or that the claim verifies
    alone         returns a declaration with the machine (the world, the claim) alone wrong
    everywhere    returns a declaration with the term wrong wherever it stands; None if that is the same
    claim         name of the changed claim; "" for other mutants
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


def mutants(declared: Declared, places: Places) -> list[Mutant]:
    """Return all mutants of the machine: wrong terms, then wrong rows, each in the order of the declaration."""
    return numbered([*_of_terms(declared, places), *_of_rows(declared)])


def numbered(made: Iterable[Mutant]) -> list[Mutant]:
    """Return the mutants with their ids."""
    seen = Counter[str]()
    return [_numbered(one, seen) for one in made]


def _numbered(one: Mutant, seen: Counter[str]) -> Mutant:
    """Return the mutant with its id: a digest of its content, and a number from the second of equal content on."""
    content = "\0".join([one.machine, one.kind, one.words, one.term, one.becomes, *one.where])
    digest = hashlib.sha256(content.encode()).hexdigest()[:10]
    seen[digest] += 1
    number = "" if seen[digest] == 1 else f"-{seen[digest]}"
    return replace(one, id=f"{one.machine}-{digest}{number}")


def sample(made: Sequence[Mutant], most: int, seed: int) -> list[Mutant]:
    """Return at most `most` mutants in order: of each machine and kind its share, and one at least while there is room."""
    if most >= len(made):
        return list(made)
    strata: dict[tuple[str, str], list[int]] = defaultdict(list)
    for number, one in enumerate(made):
        strata[one.machine, one.kind].append(number)
    draw, chosen = random.Random(seed), list[int]()
    ranked = [(rank / len(stratum), number) for stratum in strata.values() for rank, number in _shuffled(stratum, draw)]
    chosen = [number for _, number in sorted(ranked)[:most]]
    return [made[number] for number in sorted(chosen)]


def _shuffled(numbers: list[int], draw: random.Random) -> Iterator[tuple[int, int]]:
    return enumerate(draw.sample(numbers, len(numbers)))


# ------------------------------------------------------------------ wrong terms


def _of_terms(declared: Declared, places: Places) -> Iterator[Mutant]:
    forms = Forms(places)
    terms = (term for term in terms_of(declared.roots, places, forms) if term.on_board)
    for term, change, becomes in wrong_terms(terms, changes, other_variables(declared.machine), forms):
        yield _of_term(declared, term, change, becomes)


def wrong_terms(
    terms: Iterable[Term], changes_of: Callable[[Expr, Others], Iterable[Change]], others: Others, forms: Forms
) -> Iterator[tuple[Term, Change, str]]:
    """Return each term with each of its changes and the changed text; changes of a term with equal results only once."""
    for term in terms:
        seen: set[int] = {forms.of(term.node)}
        for change in changes_of(term.node, others):
            wrong = change.make(children(term.node))
            form = forms.of(wrong)
            if form not in seen:
                seen.add(form)
                yield term, change, infix(wrong, LONGEST)


def _of_term(declared: Declared, term: Term, change: Change, becomes: str) -> Mutant:
    def made(of: Declared, *, everywhere: bool) -> Declared:
        return exchanged(of, substitution(term, change), substitution(term, change) if everywhere else None)

    return Mutant(
        machine=declared.machine.name,
        kind=change.kind,
        words=change.words,
        place=place_text(term.place),
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
    """Return a substitution that changes every node of the term."""
    return Substitution({}, [(node, change.make(children(node))) for node in term.nodes])


def place_text(place: Place | None) -> str:
    """Return file and line as text; "" if the place was not recorded."""
    return "" if place is None else str(place)


def written_at(place: Place | None) -> str:
    """Return the expression as it is written there; "" if the place was not recorded."""
    return "" if place is None else place.text


def _requirements(roots: Sequence[Root]) -> tuple[str, ...]:
    rows = [root.row for root in roots if root.row is not None]
    return tuple(dict.fromkeys(one for row in rows for one in row.requirements))


def other_variables(machine: Machine) -> Others:
    """Return a function that gives the next variable of the same unit, among inputs or among state; None if there is none."""
    following: dict[Var, Var] = {}
    for stratum in (_inputs(machine), list(machine.state)):
        alike: dict[object, list[Var]] = defaultdict(list)
        for var in stratum:
            alike[var.unit if isinstance(var, NumVar) else BoolVar].append(var)
        for group in alike.values():
            following |= dict(zip(group, [*group[1:], group[0]], strict=True))
    return lambda var: None if following.get(var, var) is var else following[var]


def _inputs(machine: Machine) -> list[Var]:
    """Return the inputs without the flags of presence, which the kind `absence ignored` changes."""
    return [item.value if isinstance(item, Optional) else item for item in machine.inputs]


# ------------------------------------------------------------------ wrong rows


def _of_rows(declared: Declared) -> Iterator[Mutant]:
    for edit in row_edits(declared.machine, other_variables(declared.machine)):
        yield Mutant(
            machine=declared.machine.name,
            kind=edit.kind,
            words=edit.words,
            place=edit.place,
            term=edit.term,
            becomes=edit.becomes,
            where=edit.where,
            requirements=edit.requirements,
            alone=partial(_with_row, edit),
        )


def _with_row(edit: RowEdit, declared: Declared) -> Declared:
    return replace(declared, machine=edit.make())
