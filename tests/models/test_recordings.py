"""The recordings that ship: small, packed so that they come out the same again, and each found by its machine."""

from __future__ import annotations

from safeloc.runtime.streams.gzipped import name_of
from safeloc.runtime.streams.steps import read_steps
from safeloc.shipped import ENTRIES
from safeloc.target import STREAMS, recorded

MOST_BYTES = 3_000_000
"""All of them together, as they are installed."""
HEAD = bytes.fromhex("1f8b 08 00 00000000 02 ff")
"""gzip without name and time, packed as small as can be."""


def test_together_they_are_small() -> None:
    """The wheel installs them all."""
    assert sum(path.stat().st_size for path in STREAMS.iterdir()) < MOST_BYTES


def test_nothing_else_stands_there() -> None:
    """Packed recordings of a shipped machine, and what the picture of one is drawn from, which is no stream and stays text."""
    packed = {path for name in ENTRIES for path in recorded(name)}
    pictures = {STREAMS / f"{name_of(path)}.waterfall.json" for path in packed}
    found = set(STREAMS.iterdir())
    assert packed <= found <= packed | pictures
    assert all(path.read_bytes().startswith(HEAD) for path in packed)


def test_each_has_steps_for_its_machine() -> None:
    """Every line of every one of them is read."""
    for name in ENTRIES:
        for path in recorded(name):
            stream = read_steps(path)
            assert stream.machine == name, path.name
            assert stream.steps, path.name
