"""Terms compiled to plain Python, one statement per node: quick to make and quick to run.

A mutant is run for some hundred steps and discarded, so the time to make the code matters as much as the time to run it. A broken
claim that this code finds is confirmed by the interpreter (`playing`).
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

from safeloc.codegen.python_terms import PythonTerms
from safeloc.language.nodes import Expr, Value, Var

Row = tuple[Value, ...]
_Rows = tuple[Sequence[Var], Sequence[Var]]
"""The variables of two rows of values, such as state and inputs."""
Step = Callable[[Row, Row], Row]


def stepped(rows: _Rows, terms: Sequence[Expr]) -> Step:
    """Return a function that computes the terms from two rows of values."""
    python, lines = _named(rows, terms)
    code = "".join(f"{python.code(term)}, " for term in terms)
    made: Step = _loaded(["def made(first, second):", *lines, f"return ({code})"])
    return made


def _loaded(lines: Sequence[str]) -> Any:
    """Compile the function `made` and return it: the first line is its head, the others are its body."""
    space: dict[str, Any] = {}
    text = "\n".join([lines[0], *(f" {line}" for line in lines[1:])])
    exec(compile(text, "<safeloc mutant>", "exec"), space)  # our own text, made from checked terms
    return space["made"]


def _named(rows: _Rows, terms: Sequence[Expr]) -> tuple[PythonTerms, list[str]]:
    """Return a translator in which every node of the terms has a name, and the statements that assign these names."""
    known = {
        var: f"{row}[{number}]"
        for row, row_after in zip(("first", "second"), rows, strict=True)
        for number, var in enumerate(row_after)
    }
    python, lines = PythonTerms({}), list[str]()
    for number, node in enumerate(python.unnamed(terms)):
        lines.append(f"n{number} = {known[node] if isinstance(node, Var) else python.code(node)}")
        python.named[node] = f"n{number}"
    return python, lines
