"""A shard: part of a campaign that is run as one, and its file, which is written whole or not at all.

    000012-DIGEST-SUM.parquet    shard 12; DIGEST of all that it depends on; SUM of the bytes of the file

So a finished shard is known by its name alone, a damaged one by its sum, and equal shards of two computers by equal names.
"""

from __future__ import annotations

import hashlib
import json
import os
import platform
import re
import tempfile
from collections.abc import Iterator
from dataclasses import dataclass
from functools import lru_cache
from importlib import metadata
from pathlib import Path

from safeloc.campaign.counted import Counted, alert_limit_mm, to_parquet
from safeloc.campaign.declaration import Campaign, Shard, Stratum, parse_campaign
from safeloc.campaign.judged import Judge, judge_of
from safeloc.campaign.scenes import drawn_runs, scene_of
from safeloc.errors import InputError
from safeloc.language.digest import full_digest
from safeloc.proof.cache.engine import source_digest
from safeloc.target import Target

_FORMAT = "safeloc-shard/3"
FOLDER = "shards"
_NAMED = re.compile(r"(\d{6,})-([0-9a-f]{16})-([0-9a-f]{16})\.parquet")
_WIDTH = 16
_PACKAGES = ("numpy", "pyarrow")


@dataclass(frozen=True)
class ShardFile:
    """A file of a shard as its name tells it."""

    path: Path
    number: int
    digest: str
    checksum: str

    @property
    def sound(self) -> bool:
        """The bytes of the file are those that were written."""
        try:
            return _sum(self.path.read_bytes()) == self.checksum
        except OSError:
            return False


def digests(campaign: Campaign) -> dict[int, str]:
    """Return the digest of every shard by number: it covers declaration, machine, simulation, versions and the number."""
    common = f"{_FORMAT}, {made_by()}"
    of_stratum = {one.number: _digest_of_stratum(campaign, one) for one in campaign.strata}
    return {
        shard.number: _sum(
            f"{common}\0{of_stratum[shard.stratum.number]}\0{shard.number}\0{shard.end - shard.first}".encode()
        )
        for shard in campaign.shards
    }


def made_by() -> str:
    """Return what else the bytes of a shard depend on: packages, the kind of processor, and the code of safeloc."""
    versions = ", ".join(f"{name} {metadata.version(name)}" for name in _PACKAGES)
    return f"{versions}, {platform.machine()}, {source_digest()}"


def _digest_of_stratum(campaign: Campaign, stratum: Stratum) -> str:
    declared, scene = campaign.declared, scene_of(campaign, stratum)
    said = {
        "situation": campaign.situation_of(stratum).model_dump(
            mode="json", include={"figures", "faults", "tilt", "tilted"}
        ),
        "figures": {name: one.model_dump(mode="json") for name, one in declared.figures.items()},
        "cycles": declared.cycles,
        "seed": declared.seed,
        "shown": [declared.alert_limit_mm, declared.place_step_mm],
        "scene": scene.content,
    }
    return f"{json.dumps(said, sort_keys=True)}\0{_target_digest(scene.target)}"


@lru_cache(maxsize=64)
def _target_digest(target: Target) -> str:
    return full_digest(target.system)


def _sum(data: bytes) -> str:
    return hashlib.sha256(data).hexdigest()[:_WIDTH]


# ------------------------------------------------------------------ files


def shard_files(folder: Path) -> Iterator[ShardFile]:
    """Yield the files of shards in a folder, sound or not."""
    for path in sorted((folder / FOLDER).glob("*.parquet")):
        if found := _NAMED.fullmatch(path.name):
            yield ShardFile(path, int(found[1]), found[2], found[3])


def write_shard(folder: Path, number: int, digest: str, data: bytes) -> Path:
    """Write the table of a shard, whole or not at all, and delete other files of this number."""
    place = folder / FOLDER
    place.mkdir(parents=True, exist_ok=True)
    path = place / f"{number:06}-{digest}-{_sum(data)}.parquet"
    handle, temporary = tempfile.mkstemp(dir=place, suffix=".partial")
    try:
        with os.fdopen(handle, "wb") as file:
            file.write(data)
            file.flush()
            os.fsync(file.fileno())
        os.replace(temporary, path)
    except BaseException:
        Path(temporary).unlink(missing_ok=True)
        raise
    for other in place.glob(f"{number:06}-*.parquet"):
        if other != path:
            other.unlink(missing_ok=True)
    return path


# ------------------------------------------------------------------ the run of a shard


def run_shard(text: str, name: str, number: int) -> bytes:
    """Run one shard of a campaign, given by its text and the name of its file; return its table as Parquet.

    The bytes are the same on every computer with the same architecture and versions.
    """
    campaign = _parsed(text, name)
    shards = campaign.shards
    if number >= len(shards):
        raise InputError(f"{name}: no shard {number}; it has {len(shards)}, from 0 on.")
    shard = shards[number]
    try:
        return _table(campaign, shard)
    except InputError as error:
        raise InputError(f"{name}: shard {number} ({campaign.words_of(shard.stratum)}): {error}") from error


def _table(campaign: Campaign, shard: Shard) -> bytes:
    scene, drawn, runs = drawn_runs(campaign, shard)
    judge = judge_of_target(scene.target)
    limit_mm = alert_limit_mm(campaign, scene.target)
    counted = Counted(shard, judge.clauses, drawn, judge.outcome(runs), limit_mm, campaign.declared.place_step_mm)
    return to_parquet(counted.groups())


@lru_cache(maxsize=4)
def _parsed(text: str, name: str) -> Campaign:
    return parse_campaign(text, name)


@lru_cache(maxsize=8)
def judge_of_target(target: Target) -> Judge:
    """Return the judge of a machine, compiled once in a process."""
    return judge_of(target)
