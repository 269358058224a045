"""Directives of the documentation site: the help of every command, and the docstrings of every public name."""

from __future__ import annotations

import inspect
import re
from collections.abc import Iterator
from importlib import import_module
from pathlib import Path
from typing import Any

from docstrings import as_rst
from docutils.nodes import Node
from sphinx.application import Sphinx
from sphinx.util.docutils import SphinxDirective
from typer.testing import CliRunner

from safeloc.cli.commands import COMMANDS
from safeloc.cli.entry import app

ROOT = Path(__file__).parents[2]
ROW = re.compile(r"^\| `(safeloc[\w.]*)` \| (.*) \|$", re.MULTILINE)
WIDTH = "100"


class Commands(SphinxDirective):
    """A section for each command: what its `--help` prints."""

    def run(self) -> list[Node]:
        """Return the sections."""
        return self.parse_text_to_nodes("\n\n".join(map(_help, COMMANDS)), allow_section_headings=True)


class Names(SphinxDirective):
    """A section for each module with public names, and the docstring of each name."""

    def run(self) -> list[Node]:
        """Return the sections."""
        page = ROOT / "docs" / "public.md"
        self.env.note_dependency(str(page))
        rows = ROW.findall(page.read_text(encoding="utf-8"))
        if not rows:
            raise self.error(f"{page} lists no public names in rows of the form | `module` | `name`, ... |")
        sections = [_module(module, re.findall(r"`(\w+)`", names)) for module, names in rows]
        return self.parse_text_to_nodes("\n\n".join(sections), allow_section_headings=True)


def _help(command: str) -> str:
    ran = CliRunner().invoke(app, [command, "--help"], env={"COLUMNS": WIDTH, "NO_COLOR": "1", "TERM": "dumb"})
    if ran.exit_code:
        raise RuntimeError(f"safeloc {command} --help ends with {ran.exit_code}: {ran.output}")
    return f"## safeloc {command}\n\n```text\n{ran.output.strip()}\n```"


def _module(module: str, names: list[str]) -> str:
    described = "\n".join(_described(module, names))
    return f"## {module}\n\n```{{eval-rst}}\n.. py:currentmodule:: {module}\n\n{described}\n```"


def _described(module: str, names: list[str]) -> Iterator[str]:
    values = []
    for name in names:
        value = getattr(import_module(module), name)
        if inspect.isclass(value):
            yield f".. autoclass:: {name}\n   :members:\n"
        elif callable(value):
            yield f".. autofunction:: {name}\n"
        else:
            values.append(f"``{name}``")
    if values:
        yield f"Constants: {', '.join(values)}.\n"


def setup(site: Sphinx) -> dict[str, bool]:
    """Register the directives, and how docstrings are read."""
    site.add_directive("safeloc-commands", Commands)
    site.add_directive("safeloc-names", Names)
    site.connect("autodoc-process-docstring", _as_rst)
    return {"parallel_read_safe": True}


def _as_rst(*event: Any) -> None:
    """Change the docstring's lines, the last argument of the event, in place."""
    lines: list[str] = event[-1]
    lines[:] = as_rst(lines)
