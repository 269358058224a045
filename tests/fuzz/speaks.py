"""Of which cases a claim requires something at all; our own statement of the rule (docs/decisions/proof.md, 6).

    within         its trigger
    always         of each part of a conjunction: `p implies q` speaks of p, `p or q` of the failing of p
    no case        an equivalence, and one variable that is one of several constants, however they are written
    by constants   a part that no variable decides is no part: what is left without it counts
    reachable      none

Nothing here is safeloc's.
"""

from __future__ import annotations

from collections.abc import Iterator

from tests.fuzz.judge import Claim, has_past, requires_first
from tests.fuzz.terms import FALSE, LEAVES, PAST, TRUE, Term, parts, reads, value

CONSTANT = ("lit", "member")
COMPARISONS = ("lt", "le", "gt", "ge", "eq", "ne", "among")


def cases(claim: Claim) -> list[Term]:
    """The cases of a claim, in order; it says nothing where one of them never holds."""
    if claim.kind == "within":
        return [claim.term]
    return list(_of_parts(plain(claim.term))) if claim.kind == "always" else []


def comes(claim: Claim, case: Term, state_names: tuple[str, ...]) -> Claim:
    """The claim that some run comes to the case where the claim looks at it: one about steps does not see the first state."""
    seen = case if requires_first(claim, state_names) else ("once", case)
    return Claim(
        "case", "reachable", seen, further_assumption=claim.further_assumption, unconditional=claim.unconditional
    )


def _of_parts(term: Term) -> Iterator[Term]:
    if term[0] == "and":
        for part in term[1:]:
            yield from _of_parts(part)
    elif term[0] == "or" and not _is_equivalence(term) and not _is_choice(term):
        yield negated(term[1])


def _is_equivalence(term: Term) -> bool:
    """Both of two truths, or neither."""
    if len(term) != 3 or any(part[0] != "and" or len(part) != 3 for part in term[1:]):
        return False
    (_, *both), (_, *neither) = term[1:]
    return all("var" in (p[0], q[0]) and negated(p) == q for p, q in zip(both, neither, strict=True))


def _is_choice(term: Term) -> bool:
    """One variable, and constants that it may be."""
    equal = [part for part in term[1:] if part[0] == "eq" and part[1][0] == "var" and part[2][0] in CONSTANT]
    return len(equal) == len(term) - 1 and len({part[1] for part in equal}) == 1


# ------------------------------------------------------------------ one way to write it


def negated(term: Term) -> Term:
    """What holds where the term does not; never negated twice."""
    return TRUE if term == FALSE else FALSE if term == TRUE else term[1] if term[0] == "not" else ("not", term)


def plain(term: Term) -> Term:
    """A truth with and, or and not only, as far as it is made of truths; constants are gone."""
    if term[0] in PAST or (term[0] in LEAVES and term not in (TRUE, FALSE)):
        return term
    if term[0] in COMPARISONS:
        term = _of_numbers(term)
    if not reads(term) and not has_past(term):
        return TRUE if value(term, {}) else FALSE
    match term:
        case ("not", inner):
            return negated(plain(inner))
        case ("and" | "or", *inner):
            return _joined(term[0], *map(plain, inner))
        case ("implies", before, after):
            return _joined("or", negated(plain(before)), plain(after))
        case ("ne", one, other):
            return ("not", ("eq", one, other))
        case ("among", inner, number):
            return ("eq", inner, ("lit", number))
        case ("iff", one, other):
            return _same(plain(one), plain(other))
        case ("ite", condition, then, other):
            return _either(plain(condition), plain(then), plain(other))
    return term


def _of_numbers(term: Term) -> Term:
    """The term with those of its numbers that are left where constants choose between some."""
    match term:
        case ("ite", condition, then, other):
            chosen = plain(condition)
            if chosen in (TRUE, FALSE):
                return _of_numbers(then if chosen == TRUE else other)
            return ("ite", condition, _of_numbers(then), _of_numbers(other))
    inner = tuple(map(_of_numbers, parts(term)))
    return (term[0], *inner, *term[1 + len(inner) :])


def _joined(operator: str, *inner: Term) -> Term:
    """A conjunction or disjunction without what decides nothing in it."""
    idle, decisive = (TRUE, FALSE) if operator == "and" else (FALSE, TRUE)
    left = [part for part in inner if part != idle]
    if decisive in left or not left:
        return decisive if left else idle
    return left[0] if len(left) == 1 else (operator, *left)


def _same(one: Term, other: Term) -> Term:
    for first, second in ((one, other), (other, one)):
        if first in (TRUE, FALSE):
            return second if first == TRUE else negated(second)
    return ("iff", one, other)


def _either(condition: Term, then: Term, other: Term) -> Term:
    if condition in (TRUE, FALSE):
        return then if condition == TRUE else other
    if then in (TRUE, FALSE):
        return _joined("or", condition, other) if then == TRUE else _joined("and", negated(condition), other)
    if other in (TRUE, FALSE):
        return _joined("or", negated(condition), then) if other == TRUE else _joined("and", condition, then)
    return ("ite", condition, then, other)
