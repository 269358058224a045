"""Mutants of the world: each clause with one term changed, and each clause left out.

The machine and its claims stay as they are, and terms are changed as in a machine. When a mutant is judged, a proof decides
whether its world allows more or less than the original.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import replace
from functools import partial

from safeloc.assurance.mutation import world
from safeloc.assurance.mutation.declared import Declared, Part, Root, remade
from safeloc.assurance.mutation.kinds import Change, changes, of_operand
from safeloc.assurance.mutation.mutants import (
    LONGEST,
    Mutant,
    numbered,
    other_variables,
    place_text,
    substitution,
    written_at,
    wrong_terms,
)
from safeloc.assurance.mutation.places import Places
from safeloc.assurance.mutation.same import Forms, Term, terms_of
from safeloc.assurance.source_places import Place
from safeloc.language.expr import Expr
from safeloc.language.render import infix
from safeloc.language.terms import Substitution, children

_LEFT_OUT = "clause left out"


def clause_mutants(declared: Declared, places: Places) -> list[Mutant]:
    """Return all mutants of the world's clauses: those left out, then those with a changed term, each result of a term once."""
    roots = [root for root in declared.roots if root.part is Part.CLAUSE]
    return numbered(
        [*_left_out(declared, roots, places), *_bare(declared, roots, places), *_of_terms(declared, roots, places)]
    )


def _of_terms(declared: Declared, roots: list[Root], places: Places) -> Iterator[Mutant]:
    forms = Forms(places)
    terms = terms_of(roots, places, forms)
    for term, change, becomes in wrong_terms(terms, changes, other_variables(declared.machine), forms):
        made = partial(_exchanged, term, change)
        yield _mutant(declared, term.roots, term.node, (change.kind, change.words, becomes), made, term.place)


def _exchanged(term: Term, change: Change, declared: Declared) -> Declared:
    return _with_clauses(declared, substitution(term, change))


def _with_clauses(declared: Declared, change: Substitution) -> Declared:
    return replace(declared, machine=remade(declared.machine, **world.with_clauses(declared.machine, change)))


def _left_out(declared: Declared, roots: list[Root], places: Places) -> Iterator[Mutant]:
    for root in roots:
        done = (_LEFT_OUT, f"{root.name} is left out", "true")
        yield _mutant(declared, (root,), root.term, done, partial(_without, root.name), places.of(root.term))


def _without(name: str, declared: Declared) -> Declared:
    return replace(declared, machine=remade(declared.machine, **world.without_clause(declared.machine, name)))


def _bare(declared: Declared, roots: list[Root], places: Places) -> Iterator[Mutant]:
    """Return the mutants of clauses that are a single variable; `terms_of` lists only terms that have parts."""
    others = other_variables(declared.machine)
    for root in roots:
        for change in of_operand(root.term, others) if not children(root.term) else ():
            now = change.make((root.term,))
            done = (change.kind, change.words, infix(now, LONGEST))
            yield _mutant(declared, (root,), root.term, done, partial(_instead, root.term, now), places.of(root.term))


def _instead(was: Expr, now: Expr, declared: Declared) -> Declared:
    return _with_clauses(declared, Substitution({}, [(was, now)]))


def _mutant(
    declared: Declared,
    roots: tuple[Root, ...],
    term: Expr,
    done: tuple[str, str, str],
    made: Callable[[Declared], Declared],
    place: Place | None,
) -> Mutant:
    """Return a mutant of the world. `done` is the kind of change, its description, and the new text."""
    kind, words, becomes = done
    return Mutant(
        machine=declared.machine.name,
        kind=kind,
        words=words,
        place=place_text(place),
        source=written_at(place),
        term=infix(term, LONGEST),
        becomes=becomes,
        where=tuple(dict.fromkeys(map(str, roots))),
        alone=made,
        of="world",
    )
