"""Facts that digests of machines need of a module: the digest of its code without words for readers, and what it imports.

It follows from the text of the module alone, and is kept under that: to parse all modules of declarations takes seconds.
"""

from __future__ import annotations

import ast
import hashlib
import io
import json
import sys
import tokenize
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass

from safeloc.proof.cache.engine import tools_digest, undisturbed
from safeloc.proof.cache.store import Store

_KIND = "modules"
_BODIES = (ast.Module, ast.ClassDef, ast.FunctionDef, ast.AsyncFunctionDef)


@dataclass(frozen=True)
class ReadModule:
    """Facts about a module, out of its text.

    code     SHA-256 over its text without words
    imports  the names that it imports, wherever it does: modules, what is taken from them, and the packages above
    """

    code: str
    imports: tuple[str, ...]


_read: dict[str, ReadModule] = {}
"""What was read, by the digest of the text."""
_taken: dict[str, ReadModule] = {}
"""What was read in an earlier process."""


def read_module(text: str) -> ReadModule:
    """Return what there is to know of the text of a module."""
    digest = hashlib.sha256(text.encode()).hexdigest()
    if digest not in _read:
        _read[digest] = _taken.get(digest) or _parsed(text)
    return _read[digest]


@contextmanager
def readings_kept_in(store: Store) -> Iterator[None]:
    """Within, modules that an earlier process has read are not parsed again; at the end, what was read is kept,
    unless a file of the package was written since this process started.

    What the process did not need is forgotten, so that the entry holds one version of each module.
    """
    key = hashlib.sha256(f"{tools_digest()} {sys.version}".encode()).hexdigest()
    entry = store.get(_KIND, key)
    if entry is not None:
        _taken.update(
            {digest: ReadModule(code, tuple(names)) for digest, (code, names) in json.loads(entry.data).items()}
        )
    yield
    if not _read.keys() <= _taken.keys() and undisturbed():
        rows = {digest: (one.code, one.imports) for digest, one in _read.items()}
        store.put(_KIND, key, json.dumps(rows).encode())


def _parsed(text: str) -> ReadModule:
    imports = tuple(dict.fromkeys(_with_packages(ast.parse(text))))
    return ReadModule(hashlib.sha256(without_words(text).encode()).hexdigest(), imports)


def _with_packages(tree: ast.Module) -> Iterator[str]:
    for node in ast.walk(tree):
        names = [alias.name for alias in node.names] if isinstance(node, ast.Import | ast.ImportFrom) else []
        if isinstance(node, ast.ImportFrom) and node.module is not None:
            names = [f"{node.module}.{name}" for name in names]
        for name in names:
            parts = name.split(".")
            yield from (".".join(parts[:length]) for length in range(1, len(parts) + 1))


def without_words(text: str) -> str:
    """Return the text of a file of Python without comments, docstrings, empty lines and spaces at the end of a line."""
    lines = text.splitlines()
    for token in tokenize.generate_tokens(io.StringIO(text).readline):
        if token.type == tokenize.COMMENT:
            row, column = token.start
            lines[row - 1] = lines[row - 1][:column]
    for first, last in _docstrings(ast.parse(text)):
        lines[first - 1 : last] = [""] * (last - first + 1)
    return "\n".join(line.rstrip() for line in lines if line.strip())


def _docstrings(tree: ast.Module) -> Iterator[tuple[int, int]]:
    """Yield the first and the last line of each string that stands alone: docstrings, and those below a name."""
    for node in ast.walk(tree):
        if isinstance(node, _BODIES):
            for one in node.body:
                alone = isinstance(one, ast.Expr) and isinstance(one.value, ast.Constant)
                if alone and isinstance(one.value.value, str) and one.end_lineno is not None:  # type: ignore[attr-defined] # it is one
                    yield one.lineno, one.end_lineno
