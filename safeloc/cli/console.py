"""The outputs of the command line: standard output and standard error, lines for a narrow terminal, and JSON on demand."""

from __future__ import annotations

import json
import textwrap

from rich.console import Console

_INDENT = "    "


class _Console(Console):
    """A console that raises BrokenPipeError for a closed pipe; the caller turns it into an exit code."""

    def on_broken_pipe(self) -> None:
        """Raise BrokenPipeError; rich itself would end the process."""
        raise BrokenPipeError


# without emoji: `line.toml:100: ...` is a place in a file
out = _Console(highlight=False, soft_wrap=True, emoji=False)
err = _Console(stderr=True, highlight=False, soft_wrap=True, emoji=False)


def folded(text: str, width: int, indent: str = _INDENT) -> list[str]:
    """Return the lines of a text that is broken between words; no word is cut, so that every name can be typed.

    indent  begins each line but the first
    """
    wrapping = textwrap.TextWrapper(
        width, subsequent_indent=indent, break_long_words=False, break_on_hyphens=False, replace_whitespace=False
    )
    return wrapping.wrap(text) or [""]


def print_line(text: str) -> None:
    """Print a line of a listing; a terminal gets it broken between words, a pipe in one piece."""
    if not out.is_terminal:
        out.print(text, markup=False)
        return
    start = text[: len(text) - len(text.lstrip())]
    for line in folded(text, out.width, start + _INDENT):
        out.print(line, markup=False)


def print_json(data: object) -> None:
    """Print data as JSON on standard output."""
    print(json.dumps(data, indent=2))
