"""The project's requirements: one entry a claim, or a statement that a claim leans on, with its source.

`requirements.toml` beside this file holds them; transitions and properties carry their ids in `trace`.
"""

from __future__ import annotations

import tomllib
from dataclasses import dataclass
from functools import cache
from pathlib import Path

from safeloc.errors import ModelError

FILE = Path(__file__).with_name("requirements.toml")
STATUSES = ("done", "planned")


@dataclass(frozen=True)
class Requirement:
    """One requirement. `carried_by` says what answers for it beside transitions and properties (a named test)."""

    id: str
    kind: str
    machine: str
    status: str
    text: str
    source: str
    carried_by: str = ""


@cache
def requirements() -> tuple[Requirement, ...]:
    """All requirements in order; ModelError where the file is wrong."""
    content = tomllib.loads(FILE.read_text(encoding="utf-8"))
    sources = {key: value["publication"] for key, value in content["sources"].items()}
    found = []
    for row in content["requirement"]:
        family = row["id"].partition("-")[0]
        if family not in sources or row["status"] not in STATUSES or not row["text"].strip():
            raise ModelError(f"{FILE.name}: requirement {row['id']} has no source, an unknown status or no text.")
        found.append(Requirement(source=sources[family], **row))
    names = [one.id for one in found]
    if len(set(names)) != len(names):
        raise ModelError(f"{FILE.name}: ids are not distinct.")
    return tuple(found)


def requirement(name: str) -> Requirement:
    """One requirement by id; KeyError for an unknown one."""
    for one in requirements():
        if one.id == name:
            return one
    raise KeyError(f"no requirement {name!r} in {FILE.name}")
