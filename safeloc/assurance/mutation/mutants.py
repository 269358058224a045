"""All mutants of a declaration: one wrong term, or one wrong row, each.

Every mutant is made in two ways. With the machine alone wrong it asks whether claims and world notice. With the term wrong
wherever it stands (an edit of the expression that wrote it) it asks whether they still would, or are wrong along with
the machine. Where a term stands in the machine only, both are one.
"""

from __future__ import annotations

import hashlib
import random
from collections import Counter, defaultdict
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import partial

from safeloc.assurance.mutation.declared import Declared, Root, exchanged
from safeloc.assurance.mutation.kinds import Change, Others, changes
from safeloc.assurance.mutation.places import Place, Places
from safeloc.assurance.mutation.rows import RowEdit, row_edits
from safeloc.assurance.mutation.same import Forms, Term, terms_of
from safeloc.language.expr import Optional, Var
from safeloc.language.machine import Machine
from safeloc.language.nodes import BoolVar, NumVar
from safeloc.language.render import infix
from safeloc.language.terms import Substitution, children

LONGEST = 160


@dataclass(frozen=True, eq=False)
class Mutant:
    """One mutant.

    id            of its content: the same after edits elsewhere
    machine       the machine that is wrong
    kind, words   what is done, in general and here
    place         file and line of the term or row; "" where that was not noted
    source        the expression as it is written there
    term, becomes what stands there, and what is written instead
    where         rows and outputs that it is part of
    shared_with   claims, clauses and lemmas that have the same term
    requirements  ids that those rows answer for
    alone         makes the declaration with the machine alone wrong
    everywhere    makes the declaration with the term wrong wherever it stands; None where that is the same
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
    alone: Callable[[], Declared]
    everywhere: Callable[[], Declared] | None


def mutants(whole: Declared, places: Places) -> list[Mutant]:
    """All mutants, in the order of the declaration; each form of a wrong term once."""
    made = [*_of_terms(whole, places), *_of_rows(whole)]
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
    others, forms = other_variables(whole.machine), Forms(places)
    for term in terms_of(whole.roots, places, forms):
        if term.on_board:
            seen: set[int] = {forms.of(term.node)}
            for change in changes(term.node, others):
                wrong = change.make(children(term.node))
                form = forms.of(wrong)
                if form not in seen:
                    seen.add(form)
                    yield _of_term(whole, term, change, infix(wrong, LONGEST))


def _of_term(whole: Declared, term: Term, change: Change, becomes: str) -> Mutant:
    def made(*, everywhere: bool) -> Declared:
        pairs = [(node, change.make(children(node))) for node in term.nodes]
        return exchanged(whole, Substitution({}, pairs), Substitution({}, pairs) if everywhere else None)

    return Mutant(
        id="",
        machine=whole.machine.name,
        kind=change.kind,
        words=change.words,
        place=_told(term.place),
        source="" if term.place is None else term.place.text,
        term=infix(term.node, LONGEST),
        becomes=becomes,
        where=tuple(dict.fromkeys(map(str, term.on_board))),
        shared_with=tuple(dict.fromkeys(map(str, term.beyond))),
        requirements=_requirements(term.on_board),
        alone=lambda: made(everywhere=False),
        everywhere=(lambda: made(everywhere=True)) if term.beyond else None,
    )


def _told(place: Place | None) -> str:
    return "" if place is None else str(place)


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
            id="",
            machine=whole.machine.name,
            kind=edit.kind,
            words=edit.words,
            place=edit.place,
            source="",
            term=edit.term,
            becomes=edit.becomes,
            where=edit.where,
            shared_with=(),
            requirements=edit.requirements,
            alone=partial(_with_row, whole, edit),
            everywhere=None,
        )


def _with_row(whole: Declared, edit: RowEdit) -> Declared:
    return replace(whole, machine=edit.make())
