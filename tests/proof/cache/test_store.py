"""The folder of what is kept: what was put there comes back, and nothing else ever does."""

from __future__ import annotations

import os
import threading
from pathlib import Path

import pytest

from safeloc.proof.cache.store import Store, usual_folder

KEY, OTHER = "ab" * 32, "cd" * 32


def only_file(store: Store) -> Path:
    """The one file that is kept."""
    [(path, _)] = store.entries()
    return path


def test_what_was_put_comes_back_with_its_time(tmp_path: Path) -> None:
    """And under no other kind or key."""
    store = Store(tmp_path)
    assert store.get("findings", KEY) is None
    store.put("findings", KEY, b"found\nin two lines")
    entry = store.get("findings", KEY)
    assert entry is not None
    assert b"found\nin two lines" == entry.data
    assert entry.since.endswith("Z")
    assert store.get("answers", KEY) is None
    assert store.get("findings", OTHER) is None


def test_a_damaged_file_is_as_good_as_none(tmp_path: Path) -> None:
    """Every byte of it changed, one at a time, and every length that it may be cut to; put again, it is there again."""
    store = Store(tmp_path)
    store.put("answers", KEY, b"proved")
    path = only_file(store)
    whole = path.read_bytes()
    damaged = [bytes([*whole[:at], whole[at] ^ 1, *whole[at + 1 :]]) for at in range(len(whole))]
    cut = [whole[:length] for length in range(len(whole))]
    for content in (*damaged, *cut, whole + b"x", b"[]\nproved", b"{}\nproved", b"\xff\n"):
        path.write_bytes(content)
        assert store.get("answers", KEY) is None
    store.put("answers", KEY, b"proved")
    assert store.get("answers", KEY) is not None


def test_a_foreign_file_is_as_good_as_none(tmp_path: Path) -> None:
    """One that was put under another key, moved to where it does not belong; or that is a folder."""
    store = Store(tmp_path)
    store.put("answers", OTHER, b"proved")
    foreign = only_file(store)
    wanted = tmp_path / "kept" / "answers" / KEY[:2] / KEY[2:]
    wanted.parent.mkdir(parents=True)
    foreign.rename(wanted)
    assert store.get("answers", KEY) is None
    wanted.unlink()
    wanted.mkdir()
    assert store.get("answers", KEY) is None
    store.put("answers", KEY, b"proved")
    assert store.get("answers", KEY) is None
    assert [wanted] == list(wanted.parent.iterdir())


def test_what_cannot_be_written_is_not_kept(tmp_path: Path) -> None:
    """The folder is a file: nothing is kept, and nothing fails."""
    (tmp_path / "kept").write_text("in the way")
    store = Store(tmp_path)
    store.put("answers", KEY, b"proved")
    assert store.get("answers", KEY) is None


def test_several_may_write_at_once(tmp_path: Path) -> None:
    """Whoever reads meanwhile finds a whole entry or none; no temporary file is left."""
    store, content = Store(tmp_path), [bytes([number]) * 200_000 for number in range(4)]
    threads = [
        threading.Thread(target=lambda data=data: [store.put("runs", KEY, data) for _ in range(20)]) for data in content
    ]
    for thread in threads:
        thread.start()
    read = [store.get("runs", KEY) for _ in range(200)]
    for thread in threads:
        thread.join()
    assert all(entry is None or entry.data in content for entry in read)
    assert only_file(store).name == KEY[2:]


def test_the_longest_unused_goes_first(tmp_path: Path) -> None:
    """Being read counts as being used."""
    store = Store(tmp_path)
    keys = [letter * 64 for letter in "abc"]
    for number, key in enumerate(keys):
        store.put("runs", key, b"x" * 1000)
        [path] = [path for path, _ in store.entries() if path.parent.name == key[:2]]
        os.utime(path, (number, number))
    assert store.get("runs", keys[0]) is not None
    store.trim(most_bytes=store.bytes - 1)
    assert [True, False, True] == [store.get("runs", key) is not None for key in keys]


def test_clean_takes_away_what_is_kept_and_nothing_else(tmp_path: Path) -> None:
    """Other files in the folder stay."""
    (tmp_path / "mine.txt").write_text("mine")
    store = Store(tmp_path)
    store.clean()
    store.put("runs", KEY, b"x")
    store.clean()
    assert [] == list(store.entries())
    assert ["mine.txt"] == [path.name for path in tmp_path.iterdir()]


def test_the_usual_folder_is_the_users_own(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    """Where the system says that such things belong."""
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    assert usual_folder().name == "safeloc"
