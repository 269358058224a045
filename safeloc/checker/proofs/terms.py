"""Terms of a proof, in our own representation: each exists once, so that equal terms are the same object."""

from __future__ import annotations

from collections.abc import Set
from fractions import Fraction
from typing import Literal
from weakref import WeakValueDictionary

Sort = Literal["Bool", "Int", "Real", "list"]

_LOGICAL = frozenset({"not", "and", "or", "=>", "xor"})
_RELATIONS = frozenset({"<", "<=", ">=", ">"})
_WHOLE = frozenset({"div", "mod", "div_total", "mod_total", "to_int"})
_SUMS = frozenset({"+", "-", "*", "neg", "abs"})


class Term:
    """An operator with arguments, or a constant or variable with a value. Only the functions of this module make terms."""

    __slots__ = ("__weakref__", "args", "op", "sort", "value")
    op: str
    args: tuple[Term, ...]
    value: str | Fraction | None
    sort: Sort

    def __repr__(self) -> str:
        return _shown(self)


_Key = tuple[str, tuple[Term, ...], str | Fraction | None, Sort]
_KNOWN: WeakValueDictionary[_Key, Term] = WeakValueDictionary()


def _term(op: str, args: tuple[Term, ...], value: str | Fraction | None, sort: Sort) -> Term:
    key = (op, args, value, sort)
    known = _KNOWN.get(key)
    if known is None:
        known = Term()
        known.op, known.args, known.value, known.sort = key
        _KNOWN[key] = known
    return known


def make(op: str, *args: Term) -> Term:
    """Return the term with this operator and arguments. TypeError if the operator is unknown or the sorts do not fit."""
    return _term(op, args, None, _sort(op, args))


def number(value: Fraction | int, sort: Sort = "Int") -> Term:
    """Return a constant. TypeError if its sort is Int and its value is no whole number."""
    exact = Fraction(value)
    if sort not in ("Int", "Real") or (sort == "Int" and exact.denominator != 1):
        raise TypeError(f"{exact} is no {sort}.")
    return _term("number", (), exact, sort)


def variable(name: str, sort: Sort) -> Term:
    """Return a free variable."""
    return _term("variable", (), name, sort)


TRUE = _term("true", (), None, "Bool")
FALSE = _term("false", (), None, "Bool")


def no(term: Term) -> Term:
    """Return the negation of a term."""
    return make("not", term)


def same(left: Term, right: Term) -> Term:
    """Return the equation of two terms."""
    return make("=", left, right)


def clause(literals: tuple[Term, ...]) -> Term:
    """Return the disjunction of literals: false for none, the literal itself for one."""
    return FALSE if not literals else literals[0] if len(literals) == 1 else make("or", *literals)


def _sort(op: str, args: tuple[Term, ...]) -> Sort:
    sorts: set[Sort] = {arg.sort for arg in args}
    if op in _LOGICAL:
        return _required(op, bool(sorts) and sorts <= {"Bool"} and _arity(op, len(args)), "Bool")
    if op in _RELATIONS:
        return _required(op, len(args) == 2 and sorts <= {"Int", "Real"}, "Bool")
    if op in ("=", "distinct"):
        return _required(op, len(args) == 2 and _comparable(sorts), "Bool")
    if op in _WHOLE:
        return _required(op, len(args) == (1 if op == "to_int" else 2) and sorts <= {"Int", "Real"}, "Int")
    if op in _SUMS:
        fits = bool(sorts) and sorts <= {"Int", "Real"} and (op not in ("neg", "abs") or len(args) == 1)
        return _required(op, fits, "Int" if sorts == {"Int"} else "Real")
    return _sort_of_rest(op, args, sorts)


def _sort_of_rest(op: str, args: tuple[Term, ...], sorts: set[Sort]) -> Sort:
    if op == "ite":
        fits = len(args) == 3 and args[0].sort == "Bool" and args[1].sort == args[2].sort != "list"
        return _required(op, fits, args[1].sort if fits else "Bool")
    if op in ("/", "to_real"):
        return _required(op, len(args) == (2 if op == "/" else 1) and sorts <= {"Int", "Real"}, "Real")
    if op == "purify":
        return _required(op, len(args) == 1 and "list" not in sorts, args[0].sort)
    if op == "list":
        return "list"
    raise TypeError(f"the operator {op!r} is not known.")


def _arity(op: str, arguments: int) -> bool:
    return arguments == 1 if op == "not" else arguments == 2 if op in ("=>", "xor") else True


def _comparable(sorts: Set[Sort]) -> bool:
    return sorts <= {"Int", "Real"} or sorts == {"Bool"}


def _required(op: str, fits: bool, sort: Sort) -> Sort:
    if not fits:
        raise TypeError(f"the arguments of {op!r} are of the wrong number or sort.")
    return sort


def _shown(term: Term, depth: int = 4) -> str:
    """Return the term as text for people, cut below this depth: in full, a term with shared parts may be too long to print."""
    if not term.args:
        return term.op if term.value is None else str(term.value)
    if not depth:
        return "..."
    parts = [_shown(arg, depth - 1) for arg in term.args[:6]]
    return f"({term.op} {' '.join(parts)}{' ...' if len(term.args) > 6 else ''})"


def exact(term: Term) -> Fraction:
    """Return the value of a constant. TypeError for any other term."""
    if not isinstance(term.value, Fraction):
        raise TypeError(f"{term.op!r} is no constant.")
    return term.value
