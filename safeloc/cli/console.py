"""The outputs of the command line: standard output and standard error, and JSON on demand."""

from __future__ import annotations

import json

from rich.console import Console


class _Console(Console):
    """Leaves a closed pipe to the caller, who knows the exit code for it."""

    def on_broken_pipe(self) -> None:
        """Called where rich meets it."""
        raise BrokenPipeError


out = _Console(highlight=False, soft_wrap=True)
err = _Console(stderr=True, highlight=False, soft_wrap=True)


def print_json(data: object) -> None:
    """JSON and nothing else on standard output."""
    print(json.dumps(data, indent=2))
