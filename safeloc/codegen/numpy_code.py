"""Terms as straight-line numpy code: one call for each term, shared terms once, memory released after the last use."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any, assert_never

import numpy as np
from numpy.typing import NDArray

from safeloc.codegen.merge_choices import is_magnitude, merged, operands, operations
from safeloc.codegen.simplify_under_facts import Known
from safeloc.language.expr import BoolVar, Expr, Lit, NumVar, Var
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

Array = NDArray[Any]
Function = Callable[..., tuple[list[Array], ...]]


def to_function(name: str, arguments: Mapping[str, Sequence[Var]], results: Sequence[Sequence[Expr]]) -> str:
    """Return the source of a function over lists of arrays, with one array for each variable.

    The function returns one list of arrays for each group of `results`. The first argument must have at least one variable,
    since constant results get their length from its first array.
    """
    names: dict[Expr, str] = {}
    lines: list[str] = []
    for argument, variables in arguments.items():
        for number, var in enumerate(variables):
            names[var] = f"{argument[0]}{number}"
            lines.append(f"{names[var]} = {argument}[{number}]")
    lean = iter(merged(list(map(Known({}), (term for group in results for term in group)))))
    results = [[next(lean) for _ in group] for group in results]
    lines += _statements(names, [term for group in results for term in group])
    length = f"len({next(iter(arguments))}[0])"
    groups = ", ".join(f"[{', '.join(_array(term, names, length) for term in group)}]" for group in results)
    body = "".join(f"    {line}\n" for line in [*lines, f"return ({groups},)"])
    return f"def {name}({', '.join(arguments)}):\n{body}"


def load(source: str, name: str) -> Function:
    """Return the function `name` that the source defines."""
    space: dict[str, Any] = {"np": np}
    exec(compile(source, f"<safeloc numpy {name}>", "exec"), space)  # our own text, made from checked terms
    function: Function = space[name]
    return function


def _statements(names: dict[Expr, str], results: Sequence[Expr]) -> list[str]:
    order = operations(results)
    last = _last_uses(order, results)
    lines: list[str] = []
    for number, node in enumerate(order):
        if isinstance(node, (Lit, Truth)):
            names[node] = repr(node.value)
            continue
        names[node] = f"x{number}"
        lines.append(f"x{number} = {_call(node, names)}")
        spent = [names[part] for part in dict.fromkeys(operands(node)) if last.get(part) == number]
        if spent:
            lines.append(f"del {', '.join(spent)}")
    return lines


def _array(term: Expr, names: Mapping[Expr, str], length: str) -> str:
    """Return the array of a result; a constant becomes an array of the given length."""
    return f"np.full({length}, {names[term]})" if isinstance(term, (Lit, Truth)) else names[term]


def _last_uses(order: Sequence[Node], results: Sequence[Expr]) -> dict[Expr, int]:
    """Return the position of the last use of every computed term that is no result: its memory is released there."""
    last: dict[Expr, int] = {}
    for number, node in enumerate(order):
        for part in operands(node):
            if not isinstance(part, (Lit, Truth, NumVar, BoolVar)):
                last[part] = number
    for term in results:
        last.pop(term, None)
    return last


def _call(node: Node, of: Mapping[Expr, str]) -> str:
    match node:
        case Add(a, b):
            return f"{of[a]} + {of[b]}"
        case Sub(a, b):
            return f"{of[a]} - {of[b]}"
        case Mul(a, b):
            return f"{of[a]} * {of[b]}"
        case FloorDiv(a, divisor, _):
            return f"{of[a]} // {divisor}"
        case Min(a, b):
            return f"np.minimum({of[a]}, {of[b]})"
        case Max(a, _) if is_magnitude(node):
            return f"np.abs({of[a]})"
        case Max(a, b):
            return f"np.maximum({of[a]}, {of[b]})"
        case Choose(c, a, b, _) | ChooseBool(c, a, b):
            return f"np.where({of[c]}, {of[a]}, {of[b]})"
        case Not(inner):
            return f"np.logical_not({of[inner]})"
        case And(parts):
            return _folded("np.logical_and", [of[part] for part in parts])
        case Or(parts):
            return _folded("np.logical_or", [of[part] for part in parts])
        case Compare(op, a, b):
            return f"{of[a]} {op} {of[b]}"
        case Past() | NumVar() | BoolVar() | Lit() | Truth():
            raise KeyError(f"{node!r} is no call")
        case _:
            assert_never(node)


def _folded(function: str, parts: list[str]) -> str:
    text = f"{function}({parts[0]}, {parts[1]})"
    for part in parts[2:]:
        text = f"{function}({text}, {part})"
    return text
