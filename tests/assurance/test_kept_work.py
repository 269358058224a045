"""Work of which each result is kept: what was kept is not done again, and what was lost is not kept."""

from __future__ import annotations

import os
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from safeloc.assurance.kept_work import Batch, Keeping, kept_or_done
from safeloc.proof.cache.store import Store
from safeloc.proof.provers.workers import Lost, Task

NAMES = ["a", "b", "c"]


def batches(left: Sequence[str]) -> list[Batch]:
    """The first two in one process, which does them; the others in one which dies."""

    def dies() -> Any:
        os._exit(3)

    made = [Batch(tuple(left[:2]), Task("two", lambda: [(name, 1) for name in left[:2]], 60))]
    return [*made, *(Batch((name,), Task(name, dies, 60)) for name in left[2:])]


def test_results_come_by_name(tmp_path: Path) -> None:
    """New data is like data that was kept; what a process lost is told for each of its names."""
    store = Store(tmp_path)
    found = dict(kept_or_done(NAMES, batches, Keeping("k", "key", None, store), 2))
    assert {"a": ["a", 1], "b": ["b", 1]} == {name: found[name] for name in "ab"}
    assert isinstance(found["c"], Lost)


def test_what_was_kept_is_not_done_again(tmp_path: Path) -> None:
    """Only what was lost is asked for again; under another key all of it is."""
    store, asked = Store(tmp_path), list[list[str]]()

    def noted(left: Sequence[str]) -> list[Batch]:
        asked.append([*left])
        return batches(left)

    for key in ("key", "key", "other"):
        dict(kept_or_done(NAMES, noted, Keeping("k", key, store, store), 1))
    assert [["a", "b", "c"], ["c"], ["a", "b", "c"]] == asked


def test_nothing_left_to_do(tmp_path: Path) -> None:
    """Where all is kept the work is not even made."""
    store = Store(tmp_path)
    kept = Keeping("k", "key", store, store)
    kept.keep("a", {"x": 1})

    def never(_: Sequence[str]) -> list[Batch]:
        raise AssertionError

    assert {"a": {"x": 1}} == dict(kept_or_done(["a"], never, kept, 1))
