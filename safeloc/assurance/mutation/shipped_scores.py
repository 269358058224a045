"""Mutation results that ship with a machine: `<name>.mutation.json` in its folder of `models/`, judged before and written down.

A file has the score of the machine and the strength of each requirement that its rows implement, with the digest of the machine that they are
about: of its terms, its claims, its figures and the code that makes it. Of a machine with another digest nothing of the file is shown. The
engine is not in the digest: what a proof noticed, it noticed, also if the prover is edited later.
"""

from __future__ import annotations

import json
from collections.abc import Iterable, Mapping
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from pydantic import BaseModel, ConfigDict

from safeloc.assurance.margins.makers import machine_digest
from safeloc.assurance.mutation.kept_score import SCORES
from safeloc.assurance.mutation.strength import Strength, kept_strengths
from safeloc.assurance.shipped_files import ShippedFile, has_shipped_figures, place_of, read_shipped, shipped_file
from safeloc.proof.cache.store import Store
from safeloc.target import Target

KIND = "mutation.json"
_SCHEMA = "safeloc-shipped-mutation/1"


class _Score(BaseModel):
    model_config = ConfigDict(extra="forbid", strict=True)
    mutants: int
    judged: int
    wrong: int
    by_proof: int
    with_reason: int
    open: int
    since: str


class _Strength(BaseModel):
    model_config = ConfigDict(extra="forbid", strict=True)
    wrong: int
    by_proof: int
    by_its_own: int
    alone: dict[str, int]


class _File(ShippedFile):
    score: _Score
    strengths: dict[str, _Strength]


@dataclass(frozen=True)
class ShippedScore:
    """The score of a machine as `kept_score` has it, and the strength of each requirement, as they ship."""

    score: Mapping[str, Any]
    strengths: Mapping[str, Strength]


def shipped_score(target: Target, path: Path | None = None) -> ShippedScore | None:
    """Return what ships with a target; None without a file, for other figures than the defaults, and for another version of the machine.

    path  the file, if it is not that in the machine's folder

    InputError for a file of another form.
    """
    if not has_shipped_figures(target):
        return None
    path = shipped_file(target, KIND) if path is None else path
    if path is None:
        return None
    content = read_shipped(path, _File, _SCHEMA, "mutation results")
    if content.digest != machine_digest(target):
        return None
    score = content.score
    found = {
        name: Strength(target.name, score.judged, score.mutants, **one.model_dump())
        for name, one in content.strengths.items()
    }
    return ShippedScore(score.model_dump(), found)


def scores_of(store: Store, targets: Iterable[Target]) -> dict[str, Any]:
    """Return the score of each target that has one, by its name: the kept one, else the one that ships, unless that judged more."""
    found = dict[str, Any]()
    for target in targets:
        ships, kept = shipped_score(target), SCORES.kept(store, target)
        some = [one for one in (kept, None if ships is None else ships.score) if one is not None]
        if some:
            found[target.name] = max(some, key=lambda one: int(one["judged"]))
    return found


def strengths_of(store: Store | None, targets: Iterable[Target]) -> dict[str, list[Strength]]:
    """Return for each requirement that these targets implement its strength in each: the kept one, else the one that ships."""
    found: dict[str, list[Strength]] = {}
    for target in targets:
        ships, kept = shipped_score(target), kept_strengths(store, target)
        some = [one for one in (kept, {} if ships is None else ships.strengths) if one]
        for name, one in max(some, key=_judged, default={}).items():
            found.setdefault(name, []).append(one)
    return found


def _judged(some: Mapping[str, Strength]) -> int:
    return max(one.judged for one in some.values())


def write_shipped_score(
    target: Target, score: Mapping[str, Any], strengths: Mapping[str, Strength], path: Path | None = None
) -> Path:
    """Write score and strengths of a machine to the file that ships with it; return its path."""
    path = place_of(target, KIND) if path is None else path
    head = {"schema": _SCHEMA, "digest": machine_digest(target), "score": {**score, "since": str(score["since"])[:10]}}
    lines = [f"{json.dumps(name)}: {json.dumps(value)}" for name, value in head.items()]
    rows = [f"{json.dumps(name)}: {json.dumps(_short(one))}" for name, one in sorted(strengths.items())]
    path.write_text(
        "{\n" + ",\n".join([*lines, '"strengths": {\n' + ",\n".join(rows) + "\n}"]) + "\n}\n", encoding="utf-8"
    )
    return path


def _short(one: Strength) -> dict[str, Any]:
    """Return a strength without what the score says of all."""
    return {name: value for name, value in asdict(one).items() if name in _Strength.model_fields}
