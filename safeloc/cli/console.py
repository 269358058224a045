"""The outputs of the command line: standard output and standard error, and JSON on demand."""

from __future__ import annotations

import json

from rich.console import Console


class _Console(Console):
    """A console that raises BrokenPipeError for a closed pipe; the caller turns it into an exit code."""

    def on_broken_pipe(self) -> None:
        """Raise BrokenPipeError; rich itself would end the process."""
        raise BrokenPipeError


out = _Console(highlight=False, soft_wrap=True)
err = _Console(stderr=True, highlight=False, soft_wrap=True)


def print_json(data: object) -> None:
    """Print data as JSON on standard output."""
    print(json.dumps(data, indent=2))
