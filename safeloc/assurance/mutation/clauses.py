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


def clause_mutants(whole: Declared, places: Places) -> list[Mutant]:
    """Return all mutants of the world's clauses: those left out, then those with a changed term, each result of a term once."""
    roots = [root for root in whole.roots if root.part is Part.CLAUSE]
    return numbered([*_left_out(whole, roots, places), *_bare(whole, roots, places), *_of_terms(whole, roots, places)])


def _of_terms(whole: Declared, roots: list[Root], places: Places) -> Iterator[Mutant]:
    forms = Forms(places)
    terms = terms_of(roots, places, forms)
    for term, change, becomes in wrong_terms(terms, changes, other_variables(whole.machine), forms):
        made = partial(_exchanged, term, change)
        yield _mutant(whole, term.roots, term.node, (change.kind, change.words, becomes), made, term.place)


def _exchanged(term: Term, change: Change, whole: Declared) -> Declared:
    return _with_clauses(whole, substitution(term, change))


def _with_clauses(whole: Declared, change: Substitution) -> Declared:
    return replace(whole, machine=remade(whole.machine, **world.with_clauses(whole.machine, change)))


def _left_out(whole: Declared, roots: list[Root], places: Places) -> Iterator[Mutant]:
    for root in roots:
        done = (_LEFT_OUT, f"{root.name} is left out", "true")
        yield _mutant(whole, (root,), root.term, done, partial(_without, root.name), places.of(root.term))


def _without(name: str, whole: Declared) -> Declared:
    return replace(whole, machine=remade(whole.machine, **world.without_clause(whole.machine, name)))


def _bare(whole: Declared, roots: list[Root], places: Places) -> Iterator[Mutant]:
    """Return the mutants of clauses that are a single variable; `terms_of` lists only terms that have parts."""
    others = other_variables(whole.machine)
    for root in roots:
        for change in of_operand(root.term, others) if not children(root.term) else ():
            now = change.make((root.term,))
            done = (change.kind, change.words, infix(now, LONGEST))
            yield _mutant(whole, (root,), root.term, done, partial(_instead, root.term, now), places.of(root.term))


def _instead(was: Expr, now: Expr, whole: Declared) -> Declared:
    return _with_clauses(whole, Substitution({}, [(was, now)]))


def _mutant(
    whole: Declared,
    roots: tuple[Root, ...],
    term: Expr,
    done: tuple[str, str, str],
    made: Callable[[Declared], Declared],
    place: Place | None,
) -> Mutant:
    """Return a mutant of the world. `done` is the kind of change, its description, and the new text."""
    kind, words, becomes = done
    return Mutant(
        machine=whole.machine.name,
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
