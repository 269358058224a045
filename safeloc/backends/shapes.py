"""Shapes of terms that a back end can write in a better way.

Of a chain of choices: in a transition table many rows leave a variable alone, so its chain names the same value again
and again. Back ends that compute both branches of every choice want fewer of them; conditions are cheap there, and
the same ones serve all variables:

    ite(c, a, a)             =  a
    ite(c, a, ite(d, a, b))  =  ite(c or d, a, b)
    ite(c, a, ite(d, b, a))  =  ite(not c and d, b, a)
"""

from __future__ import annotations

from collections.abc import Sequence

from safeloc.expr import Expr, Lit, all_of, any_of
from safeloc.nodes import Choose, ChooseBool, Max, Node, Sub
from safeloc.terms import Sharing, children, in_order, rebuilt


def is_magnitude(term: Expr) -> bool:
    """max(x, 0 - x), as `abs_` builds it."""
    match term:
        case Max(a, Sub(Lit(0, _), b), _):
            return a is b
        case _:
            return False


def merged(terms: Sequence[Expr]) -> list[Expr]:
    """Terms of equal value in which neighbouring choices of one value are one choice; shared parts stay shared."""
    share = Sharing()
    done: dict[Expr, Expr] = {}
    for node in in_order(terms):
        done[node] = share(_merged(rebuilt(node, tuple(done[part] for part in children(node)))))
    return [done[term] for term in terms]


def _merged(term: Expr) -> Expr:
    assert isinstance(term, Node)
    match term:
        case Choose(_, a, b, _) | ChooseBool(_, a, b) if a is b:
            return a
        case Choose(c, a, Choose(d, b, e, _), unit):
            if a is b:
                return Choose(any_of([c, d]), a, e, unit)
            return Choose(all_of([~c, d]), b, a, unit) if a is e else term
        case ChooseBool(c, a, ChooseBool(d, b, e)):
            if a is b:
                return ChooseBool(any_of([c, d]), a, e)
            return ChooseBool(all_of([~c, d]), b, a) if a is e else term
        case _:
            return term
