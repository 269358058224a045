"""What the proofs of a folder's certificates leave to be trusted."""

from __future__ import annotations

from pathlib import Path

import pytest

from safeloc.checker.unsat import survey
from safeloc.errors import InputError
from safeloc.provers.kinduction import kinduction
from safeloc.provers.limits import Limits
from safeloc.verdict import require_proved
from tests.provers.small import LEVEL, counter, goal


def certificates(folder: Path) -> list[Path]:
    """Those of a small proof, in a folder as reports have it."""
    texts = require_proved(kinduction(goal(counter(), LEVEL <= 10), Limits())).certificates
    (folder / "certificates").mkdir()
    for name, text in texts.items():
        (folder / "certificates" / name).write_text(text, encoding="utf-8")
    return sorted((folder / "certificates").iterdir())


def test_of_a_small_proof_nothing_is_left_to_trust(tmp_path: Path) -> None:
    """Every step of every goal is checked, and each certificate is told of as it is done."""
    files, told = certificates(tmp_path), list[tuple[int, int]]()
    found = survey(tmp_path, jobs=2, seconds=30, told=lambda *count: told.append(count))
    assert [file.name for file in files] == sorted(found.sure)
    assert (found.trusted, found.unproved, dict(found.rules)) == ({}, {}, {})
    assert told[-1] == (len(files), len(files))


def test_what_does_not_follow_or_cannot_be_read_is_named(tmp_path: Path) -> None:
    """A goal that is not unsat has no proof; a file that is no certificate says so."""
    first, second, *_ = certificates(tmp_path)
    text = first.read_text(encoding="utf-8")
    first.write_text(
        "".join(line for line in text.splitlines(keepends=True) if "(assert t" not in line), encoding="utf-8"
    )
    second.write_bytes(b"\xff")
    found = survey(tmp_path, jobs=1, seconds=30, told=lambda *_: None)
    assert {first.name, second.name} == set(found.unproved)


def test_a_folder_without_certificates_is_refused(tmp_path: Path) -> None:
    """Nothing to look at is no good news."""
    with pytest.raises(InputError, match="no certificates; write a report with"):
        survey(tmp_path, jobs=1, seconds=1, told=lambda *_: None)
