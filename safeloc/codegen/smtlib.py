"""SMT-LIB 2 text of a query, written from our own terms without z3.

A query states hypotheses and goals over free variables; a goal follows from the hypotheses exactly if the answer to its
`check-sat` is `unsat`. Shared sub-terms become definitions, numbered one by one, so the text stays as small as the terms; what has been
defined already is not defined again. Witness functions are definitions too: `|witness 1.2 of x|` is the term for x in the second witness for group 1 of the inputs.
"""

from __future__ import annotations

import re
from collections.abc import Hashable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Generic, TypeVar, assert_never

from safeloc.language.expr import Bool, BoolVar, Expr, Lit, Num, NumVar, Var
from safeloc.language.nodes import (
    Add,
    And,
    Choose,
    ChooseBool,
    Compare,
    FloorDiv,
    Max,
    Min,
    Mul,
    Node,
    Not,
    Or,
    Past,
    Sub,
    Truth,
)
from safeloc.language.terms import in_order

_TAKEN = re.compile(
    r"true|false|not|and|or|xor|distinct|ite|forall|exists|let|match|par|as|div|mod|abs|to_real|to_int|is_int"
    r"|divisible|int\..*|real\..*|t\d+|witness \d+\.\d+ of .*|[^A-Za-z0-9]+"
)


_FORMAT = "safeloc-certificate/1"
Key = TypeVar("Key", bound=Hashable)


@dataclass(frozen=True, eq=False)
class Query(Generic[Key]):
    """Hypotheses, and goals that have to follow from them.

    goals   by distinct keys (objects or numbers; their text is for people only)
    about   the context of the query (system, rule, property, ...), for a reader of the text alone
    witnesses  proposed terms for variables, one mapping for each witness; the query claims nothing about them
    """

    name: str
    hypotheses: Sequence[Bool]
    goals: Mapping[Key, Bool]
    about: Mapping[str, str] = field(default_factory=dict)
    witnesses: Mapping[str, Mapping[Var, Expr]] = field(default_factory=dict)


def to_smtlib(query: Query[Key], relies_on: Sequence[str] = ()) -> str:
    """Return the query as text with one `check-sat` for each goal; the expected answer is always `unsat`.

    relies_on  files of the certificates whose results are hypotheses of this query
    """
    names: dict[Expr, str] = {}
    defined: dict[str, str] = {}
    witnesses = {(key, var): term for key, witness in query.witnesses.items() for var, term in witness.items()}
    nodes = in_order([*query.hypotheses, *query.goals.values(), *witnesses.values()])
    logic = "QF_NIA" if any(_is_product(node) for node in nodes) else "QF_LIA"
    lines = [f"; {_comment(line)}" for line in _header(query, relies_on)]
    lines += [f"(set-logic {logic})", "(set-info :status unsat)"]
    for node in nodes:
        lines += _line(node, names, defined)
    lines += [f"(assert {names[term]})" for term in query.hypotheses]
    lines += [
        f"(define-fun |witness {key} of {var.name}| () {_sort(var)} {names[term]})"
        for (key, var), term in witnesses.items()
    ]
    for key, goal in query.goals.items():
        lines += ["(push 1)", f"; {_comment(str(key))}", f"(assert (not {names[goal]}))", "(check-sat)", "(pop 1)"]
    return "\n".join(lines) + "\n"


def _header(query: Query[Key], relies_on: Sequence[str]) -> list[str]:
    about = [f"{key}: {value}" for key, value in query.about.items()]
    return [_FORMAT, f"name: {query.name}", *about, *(f"relies on: {file}" for file in relies_on)]


def _is_product(node: Node) -> bool:
    return isinstance(node, Mul) and not node.by_constant


def _comment(text: str) -> str:
    """Return the text on one line, so that no part of it becomes a command."""
    return text if text.isprintable() else "".join(letter if letter.isprintable() else " " for letter in text)


def _line(node: Node, names: dict[Expr, str], defined: dict[str, str]) -> list[str]:
    """Register the node's name, and return its declaration or definition; none for a constant, and for what is defined already."""
    if isinstance(node, (Lit, Truth)):
        names[node] = _text(node, names)
        return []
    if isinstance(node, (NumVar, BoolVar)):
        names[node] = _symbol(node.name)
        return [f"(declare-const {_symbol(node.name)} {_sort(node)})"]
    said = f"{_sort(node)} {_text(node, names)}"
    number = len(defined)
    names[node] = defined.setdefault(said, f"t{number}")
    return [f"(define-fun t{number} () {said})"] if len(defined) > number else []


def _symbol(name: str) -> str:
    """Return a variable's symbol; names with another meaning (`|true|`, or `|t5|` for a definition) get an apostrophe."""
    taken = _TAKEN.fullmatch(name.rstrip("'"))
    return f"|{name}'|" if taken else f"|{name}|"


def _sort(node: Expr) -> str:
    return "Int" if isinstance(node, Num) else "Bool"


def _text(node: Node, of: Mapping[Expr, str]) -> str:
    match node:
        case Lit(value, _):
            return str(value) if value >= 0 else f"(- {-value})"
        case Truth(value):
            return "true" if value else "false"
        case NumVar() | BoolVar():
            return _symbol(node.name)
        case Add(a, b):
            return f"(+ {of[a]} {of[b]})"
        case Sub(a, b):
            return f"(- {of[a]} {of[b]})"
        case Mul(a, b):
            return f"(* {of[a]} {of[b]})"
        case FloorDiv(a, divisor, _):
            return f"(div {of[a]} {divisor})"
        case Min(a, b):
            return f"(ite (<= {of[a]} {of[b]}) {of[a]} {of[b]})"
        case Max(a, b):
            return f"(ite (>= {of[a]} {of[b]}) {of[a]} {of[b]})"
        case Choose(c, a, b, _) | ChooseBool(c, a, b):
            return f"(ite {of[c]} {of[a]} {of[b]})"
        case Not(inner):
            return f"(not {of[inner]})"
        case And(parts):
            return f"(and {' '.join(of[part] for part in parts)})"
        case Or(parts):
            return f"(or {' '.join(of[part] for part in parts)})"
        case Compare(op, a, b):
            return f"({'=' if op == '==' else op} {of[a]} {of[b]})"
        case Past():
            raise TypeError("a past operator has no SMT-LIB text; observe the property first")
        case _:
            assert_never(node)
