"""Answers of yices to the text of a query, by its program `yices-smt2` in a process of its own.

yices is optional (extra `yices`). It is a program of another licence (GPL), which safeloc runs and does not contain.
"""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import sys
from collections.abc import Sequence
from contextlib import suppress
from functools import cache

UNSAT, SAT, UNKNOWN = "unsat", "sat", "unknown"
CLOCK = 20.0
"""Multiple of a limit after which the clock ends the work, whatever the process has counted."""
LOOK_S = 10.0
"""Time in which the program has to say its version."""
_GROUP, _ENDS = "\n(push 1)\n", "\n(pop 1)\n"


def program() -> str | None:
    """Return the path of yices' program for SMT-LIB, beside Python or on the search path; None if there is none that runs."""
    found = _installed(os.environ.get("PATH", ""))
    return found and found[0]


def version() -> str | None:
    """Return the version of that program, such as `2.6.5`; None if there is none that runs."""
    found = _installed(os.environ.get("PATH", ""))
    return found and found[1]


@cache
def _installed(search_path: str) -> tuple[str, str] | None:
    """Return path and version; None for a program that does not say its version, as one made for another system."""
    path = shutil.which("yices-smt2", path=os.pathsep.join([os.path.dirname(sys.executable), search_path]))
    if path is None:
        return None
    try:
        printed = subprocess.run([path, "--version"], capture_output=True, text=True, errors="replace", timeout=LOOK_S)
    except (OSError, subprocess.TimeoutExpired):
        return None
    number = re.search(r"\d+(\.\d+)+", printed.stdout)
    return None if printed.returncode or number is None else (path, number.group())


def _goals_of(text: str) -> tuple[str, list[str]]:
    """Split a certificate into what all its goals share, and the text of each goal up to its `check-sat`."""
    start, *groups = text.split(_GROUP)
    return start, [group.split(_ENDS)[0] for group in groups]


def answers(text: str, seconds: float, alone_seconds: float) -> list[str]:
    """Return yices' answer to each goal of a certificate: together at first, then each that is left alone.

    seconds        processor time for the goals together. Where the system cannot limit a process by its processor time, the
                   clock ends it, after CLOCK times as much
    alone_seconds  processor time for a goal that is asked alone

    An answer is `unsat`, `sat` or `unknown`, or the message by which yices refuses the text. yices must be installed.
    """
    start, groups = _goals_of(text)
    found = _fitting(_run(text, seconds, together=True), len(groups)) if len(groups) > 1 else [UNKNOWN] * len(groups)
    for goal, answer in enumerate(found):
        if answer == UNKNOWN:
            [found[goal]] = _fitting(_run(f"{start}\n{groups[goal]}\n", alone_seconds, together=False), 1)
    return found


def _fitting(found: Sequence[str], goals: int) -> list[str]:
    """Return one answer for each goal; the message of an error, or the wrong number of answers, for all of them."""
    refused = next((one for one in found if one not in (UNSAT, SAT, UNKNOWN)), None)
    if refused is None and len(found) > goals:
        refused = f"{len(found)} answers to {goals} goals"
    return [refused] * goals if refused else [*found, *[UNKNOWN] * (goals - len(found))]


def _run(text: str, seconds: float, *, together: bool) -> list[str]:
    """Return the lines that yices prints. A single goal is asked without the option for several, which many need 100 times as
    long with.
    """
    path = program()
    assert path is not None
    asked = [path, f"--timeout={max(1, round(CLOCK * seconds))}", *(["--incremental"] if together else [])]
    with subprocess.Popen(
        asked, stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True
    ) as process:
        _limit(process.pid, seconds)
        printed, _ = process.communicate(text)
    return [line for line in printed.splitlines() if line]


def _limit(pid: int, seconds: float) -> None:
    """Let the system end the process after so much processor time, where it can."""
    with suppress(ImportError, AttributeError, ProcessLookupError):
        import resource  # not on every system

        limit_s = max(1, round(seconds))
        resource.prlimit(pid, resource.RLIMIT_CPU, (limit_s, limit_s))
