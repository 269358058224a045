"""Mutants of claims: each claim left out, not asked in one mode, answered one step later, or with one term changed.

Only mutants that are weaker are judged further. A claim is weaker if it follows from the original for any machine; that is proved
from the terms, over values in range. For this proof each past operator is a flag, of which only this is known: the operators are
monotone, so an implication between parts carries over to the operators.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from functools import partial
from itertools import product
from typing import Literal

from safeloc.assurance.mutation.claims import Canon
from safeloc.assurance.mutation.declared import Declared, Part, Root, claimed
from safeloc.assurance.mutation.kinds import Change, changes
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
from safeloc.assurance.source_places import shown
from safeloc.language.expr import FALSE, TRUE, Bool, BoolVar, Expr, NumVar, Var
from safeloc.language.nodes import Past
from safeloc.language.render import infix
from safeloc.language.spec import Property
from safeloc.language.system import in_range
from safeloc.language.terms import Substitution, in_order, variables

_LATER = "one step later"
_LEFT_OUT = "claim left out"
_NOT_ASKED = "not asked in a mode"
Relation = Literal["same", "weaker", "stronger", "other"]


def claim_mutants(declared: Declared, places: Places) -> list[Mutant]:
    """Return all mutants of the claims, claim by claim; changes of a term with equal results only once."""
    made: list[Mutant] = []
    for prop in declared.properties:
        made += _of_claim(declared, prop, places)
    return numbered(made)


def _of_claim(declared: Declared, prop: Property, places: Places) -> Iterator[Mutant]:
    forms = Forms(places)
    terms = terms_of(_roots(prop), places, forms)
    for term, change, becomes in wrong_terms(terms, changes, other_variables(declared.machine), forms):
        yield _of_term(declared, prop, term, change, becomes)
    yield from _weakened(declared, prop)


def _weakened(declared: Declared, prop: Property) -> Iterator[Mutant]:
    """Return the mutants that weaken a claim as a whole: left out, one step later, not asked in a mode."""
    one, term_text = replace(_mutant(declared, prop), place=shown(prop.src)), infix(prop.term, LONGEST)
    left_out = partial(_with, prop.name, _nothing)
    yield replace(one, kind=_LEFT_OUT, words=f"{prop.name} is left out", term=term_text, becomes="", alone=left_out)
    if prop.kind == "within":
        steps = prop.steps + 1
        steps_text, now = f"within {prop.steps} steps", f"within {steps} steps"
        slower = partial(_with, prop.name, partial(_slower, steps))
        yield replace(one, kind=_LATER, words=now, term=steps_text, becomes=now, alone=slower)
    machine = declared.machine
    for label in machine.modes if prop.kind != "reachable" and len(machine.modes) > 1 else ():
        words = f"not asked in {label.label}"
        elsewhere = partial(_with, prop.name, partial(_elsewhere, machine.mode.eq(label)))
        yield replace(one, kind=_NOT_ASKED, words=words, term=term_text, becomes=words, alone=elsewhere)


def _nothing(prop: Property) -> Property:
    """Return a claim of this name that requires nothing."""
    return replace(prop, term=FALSE if prop.kind == "within" else TRUE, response=TRUE, helper=None)


def _slower(steps: int, prop: Property) -> Property:
    return replace(prop, steps=steps)


def _elsewhere(where: Bool, prop: Property) -> Property:
    return replace(prop, term=prop.term & ~where if prop.kind == "within" else prop.term | where)


def _roots(prop: Property) -> list[Root]:
    return [Root(Part.CLAIM, prop.name, term) for term in (prop.term, prop.response, prop.further_assumption)]


def _of_term(declared: Declared, prop: Property, term: Term, change: Change, becomes: str) -> Mutant:
    one = _mutant(declared, prop)
    return replace(
        one,
        kind=change.kind,
        words=change.words,
        place=place_text(term.place),
        source=written_at(term.place),
        term=infix(term.node, LONGEST),
        becomes=becomes,
        alone=partial(_with, prop.name, partial(_exchanged, term, change)),
    )


def _mutant(declared: Declared, prop: Property) -> Mutant:
    """Return a mutant of the claim without the fields that describe the change."""
    return Mutant(
        machine=declared.machine.name,
        kind="",
        words="",
        term="",
        becomes="",
        where=(f"claim {prop.name}",),
        requirements=prop.requirements,
        alone=lambda of: of,
        of="claims",
        claim=prop.name,
    )


def _exchanged(term: Term, change: Change, prop: Property) -> Property:
    return claimed(prop, substitution(term, change))


def _with(name: str, change: Callable[[Property], Property], declared: Declared) -> Declared:
    return replace(
        declared, properties=tuple(change(prop) if prop.name == name else prop for prop in declared.properties)
    )


# ------------------------------------------------------------------ which of two claims is weaker


def relation(old: Property, new: Property, canon: Canon, seconds: float) -> Relation:
    """Return the relation of a claim to its original; what is not decided within the limit counts as not following."""
    follows, returns = (_follows(*pair, canon, seconds) for pair in ((old, new), (new, old)))
    if follows:
        return "same" if returns else "weaker"
    return "stronger" if returns else "other"


def _follows(strong: Property, weak: Property, canon: Canon, seconds: float) -> bool:
    """Return whether the second claim follows from the first, for any machine."""
    if strong.steps > weak.steps:
        return False
    wanted = [(strong.response, weak.response)]
    wanted.append((weak.term, strong.term) if strong.kind == "within" else (strong.term, weak.term))
    more, less = weak.further_assumption, strong.further_assumption
    wanted.append((less, more) if strong.kind == "reachable" else (more, less))
    flat = _Flat(canon, [term for pair in wanted for term in pair], seconds)
    return all(flat.follows(one, other) for one, other in wanted)


class _Flat:
    """Terms of claims with a flag for each past operator, and the known implications between these flags."""

    def __init__(self, canon: Canon, terms: Sequence[Bool], seconds: float) -> None:
        self._canon, self._seconds = canon, seconds
        self._twins = Substitution(_by_name(terms))
        flags: dict[Expr, BoolVar] = {}
        for node in in_order([self._settled(term) for term in terms]):
            if isinstance(node, Past):
                flags[node] = BoolVar(f"past {len(flags)}")
        self._flags = flags
        self._known: list[Bool] = []
        for one, other in product(flags, flags):
            if one is not other and self._carries_over(one, other):
                self._known.append(flags[one].implies(flags[other]))

    def follows(self, one: Bool, other: Bool) -> bool:
        """Return whether the first term is proved to imply the second."""
        return self._implied(self._plain(self._settled(one)), self._plain(self._settled(other)))

    def _settled(self, term: Bool) -> Bool:
        return self._canon.share.bool(self._twins.bool(term))

    def _plain(self, term: Bool) -> Bool:
        return Substitution({}, self._flags.items()).bool(term)

    def _carries_over(self, one: Expr, other: Expr) -> bool:
        """Return whether one past operator implies another: each of its parts implies the other's, and operators are monotone."""
        assert isinstance(one, Past) and isinstance(other, Past)
        return one.op == other.op and all(
            self._implied(self._plain(first), self._plain(second))
            for first, second in zip(one.parts, other.parts, strict=True)
        )

    def _implied(self, one: Bool, other: Bool) -> bool:
        if one is other:
            return True
        hypotheses = [in_range(variables([one, other])), one, *self._known]
        return not self._canon.asked.failures(hypotheses, {"": other}, self._seconds)


def _by_name(terms: Sequence[Bool]) -> dict[Var, Expr]:
    """Return for each variable the first one of its name, since each call of `before` makes a new variable."""
    first: dict[tuple[str, bool], Var] = {}
    return {var: first.setdefault((var.name, isinstance(var, NumVar)), var) for var in variables(terms)}
