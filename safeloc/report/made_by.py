"""The making of a report: the command, its limits and seed, and the commit of the folder in which it ran."""

from __future__ import annotations

import shlex
import subprocess
from collections.abc import Mapping, Sequence
from typing import Any

_SECONDS = 10


def made_by(arguments: Sequence[str], limits: Mapping[str, float]) -> dict[str, Any]:
    """Return the command as it can be typed again, the limits of the searches with their seed, and the commit."""
    return {"command": shlex.join(["safeloc", *arguments]), "limits": dict(limits), "commit": commit()}


def commit() -> str:
    """Return the commit of the working folder, and whether files differ from it; or why there is none."""
    try:
        head, changed = _git("rev-parse", "HEAD"), _git("status", "--porcelain", "--untracked-files=no")
    except (OSError, subprocess.SubprocessError):
        return "none: the working folder is in no git repository, or git cannot be asked"
    return f"{head}, with changed files" if changed else head


def _git(*arguments: str) -> str:
    done = subprocess.run(
        ["git", *arguments], capture_output=True, text=True, check=True, timeout=_SECONDS, encoding="utf-8"
    )
    return done.stdout.strip()
