"""Written reasons why no proof needs to detect a mutant: one file for each target, `<name>.mutants.toml` in its folder of `models/`.

    [[machine]]                              # or world, claims: the part of the declaration that is wrong
    mutants = ["stop_point-b88ce033c1"]      # ids, as `safeloc mutate` prints them
    reason = "..."

An id is derived from the mutant's content. A reason for a mutant that no longer exists is refused, so that no reason outlives the
term that it was written for.
"""

from __future__ import annotations

import tomllib
from collections import Counter
from collections.abc import Collection, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Annotated

from pydantic import BaseModel, ConfigDict, Field, ValidationError

from safeloc.assurance.mutation.results import Of
from safeloc.errors import InputError
from safeloc.target import beside

_SHORTEST = 30
"""Least number of characters of a reason, so that a single word is refused."""


class _Entry(BaseModel):
    model_config = ConfigDict(extra="forbid", strict=True)
    mutants: Annotated[list[str], Field(min_length=1)]
    reason: Annotated[str, Field(min_length=_SHORTEST)]


class _File(BaseModel):
    model_config = ConfigDict(extra="forbid", strict=True)
    machine: list[_Entry] = []
    world: list[_Entry] = []
    claims: list[_Entry] = []


@dataclass(frozen=True)
class Reasons:
    """The reasons of one target, by part of the declaration and id of the mutant, with the file that they were read from."""

    file: str = ""
    by_part: Mapping[Of, Mapping[str, str]] = field(default_factory=dict)

    def of(self, existing: Mapping[Of, Collection[str]]) -> dict[str, str]:
        """Return the reasons of these parts by id of the mutant; InputError for the id of a mutant that does not exist.

        existing  ids of all mutants, by part
        """
        found: dict[str, str] = {}
        for part, ids in existing.items():
            written = self.by_part.get(part, {})
            gone = sorted(set(written) - set(ids))
            if gone:
                raise InputError(
                    f"{self.file}: there is no mutant {gone[0]!r} of the {part} any more. Judge the one that took its place "
                    "(--json lists all ids), or take the reason away."
                )
            found |= written
        return found


def shipped_reasons(name: str) -> Reasons:
    """Return the reasons that ship for a machine; none if it has no file."""
    path = beside(name, "mutants.toml")
    return Reasons() if path is None else read_reasons(path)


def read_reasons(path: Path) -> Reasons:
    """Read a file of reasons. InputError with file and field for anything that does not fit."""
    try:
        content = _File.model_validate(tomllib.loads(path.read_text(encoding="utf-8")))
    except OSError as error:
        raise InputError(f"{path}: cannot be read ({error.strerror}).") from error
    except (tomllib.TOMLDecodeError, UnicodeDecodeError, RecursionError) as error:
        raise InputError(f"{path}: not TOML ({error}).") from error
    except ValidationError as error:
        first = error.errors()[0]
        place = ".".join(map(str, first["loc"]))
        raise InputError(f"{path}: field {place}: {first['msg']} (got {first['input']!r}).") from error
    parts: dict[Of, list[_Entry]] = {"machine": content.machine, "world": content.world, "claims": content.claims}
    return Reasons(str(path), {part: _by_id(path, entries) for part, entries in parts.items() if entries})


def _by_id(path: Path, entries: list[_Entry]) -> dict[str, str]:
    twice = [one for one, count in Counter(one for entry in entries for one in entry.mutants).items() if count > 1]
    if twice:
        raise InputError(f"{path}: {twice[0]!r} has two reasons; leave one.")
    return {one: entry.reason for entry in entries for one in entry.mutants}
