"""Witnesses that ship with a machine: short runs to events that a solver or many drawn runs would have to find anew each time.

A run counts for what it shows when it is run again, and for nothing else: after an edit a run that no longer reaches an event
shows nothing, and the event is searched for.

The file is packed JSON (xz), one object a line: first {"schema": "safeloc-witnesses/1"}, then each run as {"system": name of the
composition or of one of its machines alone, "first": open initial values, "steps": inputs of each step}.
"""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from pathlib import Path

from safeloc.errors import InputError, StreamError
from safeloc.language.nodes import Value
from safeloc.proof.provers.recorded_witnesses import Recording
from safeloc.runtime.packed import packed, read_packed

SCHEMA = "safeloc-witnesses/1"


def read_witnesses(path: Path | None) -> dict[str, list[Recording]]:
    """Return the runs of a file by the name of their system; none without a file. StreamError for a file of another form."""
    if path is None:
        return {}
    try:
        head, *lines = [json.loads(line) for line in read_packed(path).splitlines()]
        if head != {"schema": SCHEMA}:
            raise ValueError(f"it begins with {head}")
        found: dict[str, list[Recording]] = {}
        for line in lines:
            found.setdefault(line["system"], []).append(Recording(line["first"], line["steps"]))
    except (InputError, ValueError, TypeError, KeyError) as error:
        raise StreamError(f"{path}: no file of witnesses ({SCHEMA}): {error}. Make it anew: CONTRIBUTING.md") from error
    return found


def write_witnesses(path: Path, runs: Sequence[tuple[str, Mapping[str, Value], Sequence[Mapping[str, Value]]]]) -> None:
    """Write runs, each with the name of its system, its open initial values and its inputs; the same runs give the same bytes."""
    lines: list[object] = [{"schema": SCHEMA}]
    lines += [
        {"system": system, "first": dict(first), "steps": list(map(dict, steps))} for system, first, steps in runs
    ]
    text = "".join(f"{json.dumps(line, separators=(',', ':'))}\n" for line in lines)
    path.write_bytes(packed(text.encode()))
