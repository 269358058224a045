"""The documentation site shows docstrings as they stand; `make docs` itself fails on a broken link or a page in no list."""

from __future__ import annotations

import importlib.util
from pathlib import Path

import pytest

SITE = Path(__file__).parents[1] / "packaging" / "site"
_spec = importlib.util.spec_from_file_location("docstrings", SITE / "docstrings.py")
assert _spec is not None
assert _spec.loader is not None
docstrings = importlib.util.module_from_spec(_spec)
_spec.loader.exec_module(docstrings)


@pytest.mark.parametrize(
    ("docstring", "shown"),
    [
        (["Return a `name` of two."], ["Return a ``name`` of two."]),
        (["Return low_ * high|.", "", "Errors."], ["Return low\\_ \\* high\\|.", "", "Errors."]),
        (["A `span over", "two lines_` and on_"], ["A ``span over", "two lines_`` and on\\_"]),
        (
            ["depth  number of steps", "stuck  the reason"],
            ["::", "", "    depth  number of steps", "    stuck  the reason"],
        ),
        (["    [low, high]"], ["::", "", "        [low, high]"]),
        (["One backquote ` alone"], ["One backquote \\` alone"]),
    ],
)
def test_docstrings_are_shown_as_they_stand(docstring: list[str], shown: list[str]) -> None:
    """Names in backquotes become literals, aligned paragraphs become blocks, and nothing else is markup."""
    assert docstrings.as_rst(docstring) == shown
