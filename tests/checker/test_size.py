"""The checker's kernel is short enough to be read: what decides what a certificate establishes."""

from __future__ import annotations

import ast
import io
import tokenize
from pathlib import Path

import safeloc.checker

KERNEL = ("dag", "text", "terms", "rules")
LAYOUT = {tokenize.COMMENT, tokenize.NL, tokenize.NEWLINE, tokenize.INDENT, tokenize.DEDENT, tokenize.ENDMARKER}


def lines_of_code(source: str) -> int:
    """Count the lines that hold code: no imports, docstrings, comments or empty lines."""
    left_out = set[int]()
    for node in ast.walk(ast.parse(source)):
        said = isinstance(node, ast.Expr) and isinstance(node.value, ast.Constant) and isinstance(node.value.value, str)
        if said or isinstance(node, (ast.Import, ast.ImportFrom)):
            left_out.update(range(node.lineno, (node.end_lineno or node.lineno) + 1))
    code = set[int]()
    for token in tokenize.generate_tokens(io.StringIO(source).readline):
        if token.type not in LAYOUT:
            code.update(range(token.start[0], token.end[0] + 1))
    return len(code - left_out)


def test_the_kernel_is_short() -> None:
    """Below 500 lines of code."""
    folder = Path(safeloc.checker.__file__).parent
    assert sum(lines_of_code((folder / f"{name}.py").read_text(encoding="utf-8")) for name in KERNEL) < 500


def test_lines_are_counted() -> None:
    """One line of code, one of an expression that goes over two."""
    assert 3 == lines_of_code('"""What it is."""\n\nimport os\n\nx = 1  # one\ny = (\n    os)\n')
