"""Translation of z3 terms back into our own terms, such as an invariant that a solver has found.

Such terms carry no units (all numbers have unit 1) and are for proofs only.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import cast

import z3

from safeloc.language.expr import Bool, Expr, Lit, Num, Var
from safeloc.language.nodes import Add, And, Choose, ChooseBool, Compare, FloorDiv, Mul, Or, Sub, Truth
from safeloc.language.terms import logical, numeric
from safeloc.language.units import ONE


class UnreadableError(Exception):
    """The z3 term uses an operator that our language does not have."""


def read_bool(term: z3.ExprRef, variables: Mapping[str, Var]) -> Bool:
    """Return the term, whose constants are `variables` by name. UnreadableError for operators that our language does
    not have.
    """
    done: dict[int, Expr] = {}
    for node in _parts_first(term):
        done[node.get_id()] = _read(node, [done[child.get_id()] for child in node.children()], variables)
    return logical(done[term.get_id()])


def _parts_first(term: z3.ExprRef) -> list[z3.ExprRef]:
    order: list[z3.ExprRef] = []
    seen: set[int] = set()
    stack = [(term, False)]
    while stack:
        node, done = stack.pop()
        if not z3.is_app(node):
            raise UnreadableError("a quantifier")
        if done:
            order.append(node)
        elif node.get_id() not in seen:
            seen.add(node.get_id())
            stack.append((node, True))
            stack.extend((child, False) for child in node.children())
    return order


def _read(node: z3.ExprRef, parts: Sequence[Expr], variables: Mapping[str, Var]) -> Expr:
    kind = node.decl().kind()
    if z3.is_int_value(node):
        return Lit(cast(z3.IntNumRef, node).as_long(), ONE)
    if kind == z3.Z3_OP_UNINTERPRETED and not parts and node.decl().name() in variables:
        return variables[node.decl().name()]
    if kind in (z3.Z3_OP_TRUE, z3.Z3_OP_FALSE):
        return Truth(kind == z3.Z3_OP_TRUE)
    if kind in _CONNECTIVES:
        return _connective(kind, [logical(part) for part in parts])
    if kind in _COMPARISONS:
        return _comparison(kind, numeric(parts[0]), numeric(parts[1]))
    if kind == z3.Z3_OP_EQ:
        return _equal(parts[0], parts[1])
    if kind == z3.Z3_OP_ITE:
        return _choice(logical(parts[0]), parts[1], parts[2])
    if kind in _ARITHMETIC:
        return _arithmetic(kind, [numeric(part) for part in parts])
    raise UnreadableError(f"operator {node.decl().name()} of {len(parts)} parts")


_CONNECTIVES = (z3.Z3_OP_AND, z3.Z3_OP_OR, z3.Z3_OP_NOT, z3.Z3_OP_IMPLIES)
_COMPARISONS = (z3.Z3_OP_LE, z3.Z3_OP_LT, z3.Z3_OP_GE, z3.Z3_OP_GT)
_ARITHMETIC = (z3.Z3_OP_ADD, z3.Z3_OP_SUB, z3.Z3_OP_UMINUS, z3.Z3_OP_MUL, z3.Z3_OP_IDIV, z3.Z3_OP_MOD)


def _connective(kind: int, parts: list[Bool]) -> Bool:
    if kind == z3.Z3_OP_NOT:
        return ~parts[0]
    if kind == z3.Z3_OP_IMPLIES:
        return Or((~parts[0], parts[1]))
    return And(tuple(parts)) if kind == z3.Z3_OP_AND else Or(tuple(parts))


def _comparison(kind: int, left: Num, right: Num) -> Bool:
    if kind in (z3.Z3_OP_GE, z3.Z3_OP_GT):
        left, right = right, left
    return Compare("<=" if kind in (z3.Z3_OP_LE, z3.Z3_OP_GE) else "<", left, right)


def _equal(left: Expr, right: Expr) -> Bool:
    if isinstance(left, Num) and isinstance(right, Num):
        return Compare("==", left, right)
    return logical(left).iff(logical(right))


def _choice(condition: Bool, then: Expr, other: Expr) -> Expr:
    if isinstance(then, Num):
        return Choose(condition, then, numeric(other), ONE)
    return ChooseBool(condition, logical(then), logical(other))


def _arithmetic(kind: int, parts: list[Num]) -> Num:
    first, *rest = parts
    if kind == z3.Z3_OP_UMINUS:
        return Sub(Lit(0, ONE), first, ONE)
    if kind in (z3.Z3_OP_IDIV, z3.Z3_OP_MOD):
        return _division(kind, first, rest[0])
    node = {z3.Z3_OP_ADD: Add, z3.Z3_OP_SUB: Sub, z3.Z3_OP_MUL: Mul}[kind]
    for part in rest:
        first = node(first, part, ONE)
    return first


def _division(kind: int, left: Num, right: Num) -> Num:
    if not (isinstance(right, Lit) and right.value > 0):
        raise UnreadableError("division by something else than a positive constant")
    quotient = FloorDiv(left, right.value, ONE)
    return quotient if kind == z3.Z3_OP_IDIV else Sub(left, Mul(quotient, right, ONE), ONE)
