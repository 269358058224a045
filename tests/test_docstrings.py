"""Docstrings are sentences for a stranger: none begins with a free relative clause, and functions say with a verb what they do."""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator
from pathlib import Path

from tests.rooms import ROOT, parsed

QUESTIONS = frozenset(("What", "Which", "Whether", "Where", "When", "Who", "Whose", "How", "Why"))
"""With these a noun phrase begins that names nothing: `What is asked around a stream` is a question about it."""
NO_VERBS = QUESTIONS | frozenset(
    ("A", "All", "An", "Each", "Every", "Fresh", "From", "In", "No", "One", "Properties", "The")
)
OF_VALUES = frozenset(("cached_property", "derived", "property"))
"""What they mark is read as a value, and named as one."""
_ANY = "|".join(sorted(NO_VERBS))
SUSPECT = re.compile(
    rf'"({"|".join(sorted(QUESTIONS))})\b|(?<!property\n)    def [^_].*\s+"+({_ANY})\b|\ndef [^_].*\s+"+({_ANY})\b|\n *\) -> .*\s+"+({_ANY})\b'
)
"""A beginning that may be wrong; what may begin so, such as the docstring of a class, is found as well."""
Documented = ast.Module | ast.ClassDef | ast.FunctionDef | ast.AsyncFunctionDef


def sources() -> Iterator[Path]:
    """Every Python file of the package, the templates' own projects apart."""
    for folder in ("safeloc", "models", "properties"):
        found = (path for path in sorted((ROOT / folder).rglob("*.py")) if path.resolve() == path)
        yield from (path for path in found if "templates" not in path.parts)


def is_called(node: Documented) -> bool:
    """Whether it is a public function that is called, and no value."""
    if not isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef) or node.name.startswith("_"):
        return False
    marks = [one.func if isinstance(one, ast.Call) else one for one in node.decorator_list]
    return not OF_VALUES & {one.attr if isinstance(one, ast.Attribute) else getattr(one, "id", "") for one in marks}


def documented(node: Documented) -> Iterator[Documented]:
    """The node itself, and what stands at the top of a module or class."""
    yield node
    if isinstance(node, ast.Module | ast.ClassDef):
        for one in node.body:
            if isinstance(one, Documented):
                yield from documented(one)


def misleading(text: str) -> Iterator[str]:
    """The first lines of docstrings of a module that begin with a wrong word."""
    if SUSPECT.search(text) is None:  # spares the reading of most modules
        return
    for node in documented(parsed(text)):
        if said := ast.get_docstring(node):
            first = said.split(maxsplit=1)[0].rstrip(".,:;")
            if first in (NO_VERBS if is_called(node) else QUESTIONS):
                yield said.partition("\n")[0]


def test_docstrings_begin_with_what_they_are_about() -> None:
    found = {path: list(misleading(path.read_text(encoding="utf-8"))) for path in sources()}
    assert {} == {path.relative_to(ROOT).as_posix(): lines for path, lines in found.items() if lines}


def test_wrong_beginnings_are_found() -> None:
    text = '''
"""What it is."""
def f(): "The sum."
def _g(): "The sum."
def h(): "Whether it holds."
def i(): "Return whether it holds."
class C:
    "How far."
    @property
    def v(self): "The value."
    @derived("mm")
    def w(self): "All of it."
    def m(self): "Every value."
'''
    assert ["What it is.", "The sum.", "Whether it holds.", "How far.", "Every value."] == list(misleading(text))
