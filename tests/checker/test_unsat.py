"""Survey of the proof steps in a folder's certificates that remain to be trusted."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from safeloc.checker.unsat import survey
from safeloc.errors import InputError
from safeloc.language.verdict import require_proved
from safeloc.proof.provers.kinduction import kinduction
from safeloc.proof.provers.limits import Limits
from safeloc.report.certificates import packed_texts
from safeloc.report.data import SCHEMA
from tests.proof.provers.small import LEVEL, counter, goal


def certificates() -> dict[str, str]:
    """Those of a small proof."""
    return dict(require_proved(kinduction(goal(counter(), LEVEL <= 10), Limits())).certificates)


def kept(folder: Path, texts: dict[str, str]) -> Path:
    """A folder as reports have it."""
    (folder / "certificates").mkdir()
    files = {"proof.texts.xz": texts} if texts else {}
    for file, own in files.items():
        (folder / "certificates" / file).write_bytes(packed_texts(own))
    data = {"certificates": {file: list(own) for file, own in files.items()}, "results": [], "requirements": []}
    (folder / "report.json").write_text(json.dumps({"schema": SCHEMA, **data}), encoding="utf-8")
    return folder


def test_of_a_small_proof_nothing_is_left_to_trust(tmp_path: Path) -> None:
    """Every step of every goal is checked, and each certificate is told of as it is done."""
    texts, told = certificates(), list[tuple[int, int]]()
    found = survey(kept(tmp_path, texts), jobs=2, seconds=30, progress=lambda *count: told.append(count))
    assert sorted(texts) == sorted(found.sure)
    assert (found.trusted, found.unproved, dict(found.rules)) == ({}, {}, {})
    assert told[-1] == (len(texts), len(texts))


def test_what_does_not_follow_or_cannot_be_read_is_named(tmp_path: Path) -> None:
    """A goal that is not unsat has no proof; a text that is no certificate says so."""
    texts = certificates()
    first, second, *_ = texts
    lines = texts[first].splitlines(keepends=True)
    texts |= {first: "".join(line for line in lines if "(assert t" not in line), second: "\ufffd"}
    found = survey(kept(tmp_path, texts), jobs=1, seconds=30, progress=lambda *_: None)
    assert {first, second} == set(found.unproved)


def test_a_damaged_file_is_named(tmp_path: Path) -> None:
    """Its proofs are not made."""
    path = kept(tmp_path, certificates()) / "certificates" / "proof.texts.xz"
    path.write_bytes(path.read_bytes()[:-4])
    found = survey(tmp_path, jobs=1, seconds=1, progress=lambda *_: None)
    assert {"proof.texts.xz": f"{path}: damaged, it ends too early. Write the report again."} == found.unproved


def test_a_folder_without_certificates_is_refused(tmp_path: Path) -> None:
    """Nothing to look at is no good news."""
    with pytest.raises(InputError, match="no certificates; write a report with"):
        survey(kept(tmp_path, {}), jobs=1, seconds=1, progress=lambda *_: None)
