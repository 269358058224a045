"""The recordings that ship: in the folder of their machine, small, packed so that they come out the same again."""

from __future__ import annotations

from collections import defaultdict
from pathlib import Path

from safeloc.models.guard.positions import FOLDER
from safeloc.runtime.streams.gzipped import name_of
from safeloc.runtime.streams.steps import read_steps
from safeloc.shipped_machines import ENTRIES
from safeloc.target import MODELS, recorded

MOST_BYTES = 3_000_000
"""All of them together, as they are installed."""
HEAD = bytes.fromhex("1f8b 08 00 00000000 02 ff")
"""gzip without name and time, packed as small as can be."""
RECEIVER = {FOLDER / f"junction.{kind}" for kind in ("toml", "csv", "nmea")}
"""Positions of the guard's receiver and the line that they lie on: records, no steps."""


def files() -> set[Path]:
    """Every file in a folder of recordings."""
    return {path for folder in MODELS.glob("**/recordings") for path in folder.iterdir()}


def test_together_they_are_small() -> None:
    """The wheel installs them all."""
    assert sum(path.stat().st_size for path in files()) < MOST_BYTES


def test_nothing_else_stands_there() -> None:
    """Packed recordings of a shipped machine, and what the picture of one is drawn from, which is no stream and stays text."""
    packed = {path for name in ENTRIES for path in recorded(name)}
    pictures = {path.with_name(f"{name_of(path)}.waterfall.json") for path in packed}
    assert packed | RECEIVER <= files() <= packed | RECEIVER | pictures
    assert all(path.read_bytes().startswith(HEAD) for path in packed)


def test_each_stands_in_the_folder_of_its_machine() -> None:
    """So a machine is moved, copied or taken away with its folder."""
    for name, entry in ENTRIES.items():
        assert {MODELS / entry.folder / "recordings"} >= {path.parent for path in recorded(name)}


def test_each_name_is_given_once() -> None:
    """A recording is found by its name alone, and so is its picture."""
    places: dict[str, list[Path]] = defaultdict(list)
    for path in files():
        places[path.name].append(path)
    assert [] == [found for found in places.values() if len(found) > 1]


def test_each_has_steps_for_its_machine() -> None:
    """Every line of every one of them is read."""
    for name in ENTRIES:
        for path in recorded(name):
            stream = read_steps(path)
            assert stream.machine == name, path.name
            assert stream.steps, path.name
