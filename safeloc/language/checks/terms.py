"""Rules for terms: a node built directly must satisfy the same rules as one built by the language's functions."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from typing import Any, TypeGuard, assert_never, get_args

from safeloc.language.nodes import (
    INT64_MAX,
    INT64_MIN,
    Add,
    And,
    Bool,
    BoolVar,
    Choose,
    ChooseBool,
    Compare,
    FloorDiv,
    Lit,
    Max,
    Min,
    Mul,
    Node,
    Not,
    Num,
    NumVar,
    Or,
    Past,
    Sub,
    Truth,
)
from safeloc.language.terms import children
from safeloc.language.units import Enumeration, Unit

_PARTS = {"previous": 1, "once": 1, "since": 2}
_KINDS = frozenset(get_args(Node))


def malformed(roots: Iterable[object]) -> Iterator[str]:
    """Yield the errors of all nodes below `roots`, one sentence each; none if the language's functions built them."""
    seen: set[int] = set()
    stack: list[Any] = list(roots)
    while stack:
        node = stack.pop()
        if id(node) in seen:
            continue
        seen.add(id(node))
        plainly_right = _PLAINLY_RIGHT.get(type(node))
        if plainly_right is not None and plainly_right(node):
            stack += children(node)
        elif not _is_node(node):
            yield f"{node!r} of type {type(node).__name__} is no term; build terms with the functions of safeloc.language.expr."
        elif wrong := _wrong(node):
            yield f"{type(node).__name__}: {wrong}; build terms with the functions of safeloc.language.expr."
        else:
            stack += children(node)


def _plain_arithmetic(node: Add | Sub | Min | Max) -> bool:
    a, b = node.left, node.right
    return isinstance(a, Num) and isinstance(b, Num) and a.unit is b.unit and isinstance(a.unit, Unit)


def _plain_comparison(node: Compare) -> bool:
    a, b = node.left, node.right
    alike = isinstance(a, Num) and isinstance(b, Num) and a.unit is b.unit
    return alike and (node.op == "==" or (node.op in ("<", "<=") and isinstance(a.unit, Unit)))


def _plain_choice(node: Choose) -> bool:
    a, b = node.then, node.other
    return isinstance(node.condition, Bool) and isinstance(a, Num) and isinstance(b, Num) and a.unit is b.unit


def _plain_choice_of_truth(node: ChooseBool) -> bool:
    return isinstance(node.condition, Bool) and isinstance(node.then, Bool) and isinstance(node.other, Bool)


def _plain_connective(node: And | Or) -> bool:
    return not [part for part in node.parts if not isinstance(part, Bool)]  # no generator: there are very many parts


_PLAINLY_RIGHT: dict[type, Callable[[Any], bool]] = {
    **dict.fromkeys((Add, Sub, Min, Max), _plain_arithmetic),
    **dict.fromkeys((And, Or), _plain_connective),
    Compare: _plain_comparison,
    Choose: _plain_choice,
    ChooseBool: _plain_choice_of_truth,
    Not: lambda node: isinstance(node.inner, Bool),
}
"""Of the most frequent kinds: whether a node is right at a glance. One that is not may still be; `_wrong` decides."""


def _is_node(found: object) -> TypeGuard[Node]:
    """Return whether an object is one of the language's nodes; the lookup of its class is the fast path."""
    return type(found) in _KINDS or isinstance(found, Node)


def _wrong(node: Node) -> str:
    """Return the error of one node, or "" if there is none; the most frequent kinds come first."""
    match node:
        case Choose(c, a, b):
            return _no_truth(c) or _no_number(a) or _no_number(b) or _other_unit(a, b)
        case ChooseBool(c, a, b):
            return _no_truth(c) or _no_truth(a) or _no_truth(b)
        case Compare(op, a, b):
            return _wrong_comparison(op, a, b)
        case And(parts) | Or(parts):
            return _first(map(_no_truth, parts))
        case Add(a, b) | Sub(a, b) | Min(a, b) | Max(a, b):
            return _wrong_arithmetic(a, b)
        case Lit(value, unit):
            return _wrong_constant(value, unit)
        case NumVar():
            return _wrong_variable(node)
        case Not(inner):
            return _no_truth(inner)
        case BoolVar(before=before):
            return "" if before is None or isinstance(before, BoolVar) else "its value before is no truth value"
        case Mul(a, b):
            return _no_number(a) or _no_number(b) or _enumerated(a) or _enumerated(b)
        case Truth(value):
            return "" if isinstance(value, bool) else f"{value!r} is no truth value"
        case FloorDiv(a, divisor):
            wrong = "" if _is_integer(divisor) and divisor > 0 else f"divisor {divisor!r}"
            return _no_number(a) or _enumerated(a) or wrong
        case Past(op, parts):
            right = _PARTS.get(op) == len(parts)
            return _first(map(_no_truth, parts)) if right else f"operator {op!r} of {len(parts)} parts"
        case _:
            assert_never(node)


def _first(complaints: Iterable[str]) -> str:
    return next((one for one in complaints if one), "")


def _is_integer(value: object) -> bool:
    return isinstance(value, int) and not isinstance(value, bool)


def _wrong_constant(value: object, unit: object) -> str:
    if not isinstance(value, int) or isinstance(value, bool):
        return f"{value!r} is no whole number"
    if isinstance(unit, Enumeration):
        return "" if 0 <= value < len(unit.members) else f"{value} is no member of {unit.name}"
    return "" if isinstance(unit, Unit) else f"{unit!r} is no unit"


def _wrong_variable(var: NumVar) -> str:
    if not (_is_integer(var.low) and _is_integer(var.high) and INT64_MIN <= var.low <= var.high <= INT64_MAX):
        return f"range {var.low!r}..{var.high!r} of {var.name!r}; it must be non-empty and fit 64 bits"
    if isinstance(var.unit, Enumeration) and not 0 <= var.low <= var.high < len(var.unit.members):
        return f"range {var.low}..{var.high} of {var.name!r} is not of {var.unit.name}"
    twin = var.before
    if twin is None or (isinstance(twin, NumVar) and twin.unit.same(var.unit) and twin.before is None):
        return ""
    return f"{var.name!r} is the value before the step of another kind of variable"


def _no_number(term: object) -> str:
    return "" if isinstance(term, Num) else f"{term!r} is no number"


def _no_truth(term: object) -> str:
    return "" if isinstance(term, Bool) else f"{term!r} is no truth value"


def _enumerated(term: Num) -> str:
    return f"arithmetic on {term.unit.name}" if isinstance(term.unit, Enumeration) else ""


def _other_unit(left: Num, right: Num) -> str:
    return "" if left.unit.same(right.unit) else f"units {left.unit.name} and {right.unit.name}"


def _wrong_arithmetic(left: Num, right: Num) -> str:
    """Return the error of a sum, or ""; adding zero of another unit is allowed, since `with_unit` converts that way."""
    wrong = _no_number(left) or _no_number(right) or _enumerated(left) or _enumerated(right)
    converts = isinstance(right, Lit) and right.value == 0
    return wrong or ("" if converts else _other_unit(left, right))


def _wrong_comparison(op: str, left: Num, right: Num) -> str:
    wrong = _no_number(left) or _no_number(right)
    if wrong or op not in ("<", "<=", "=="):
        return wrong or f"operator {op!r}"
    if op != "==" and isinstance(left.unit, Enumeration):
        return f"members of {left.unit.name} have no order"
    return _other_unit(left, right)
