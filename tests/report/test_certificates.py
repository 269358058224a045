"""The files of certificates in a report folder: those of this version, and those of earlier ones."""

from __future__ import annotations

import io
import tarfile
from pathlib import Path

import pytest

from safeloc.report.certificates import packed_texts, read_archives
from safeloc.runtime.packed import packed

TEXTS = {"a-1.smt2": "; a\n(check-sat)\n", "a-2.smt2": "; b\n(check-sat)\n"}


def archive(texts: dict[str, str]) -> bytes:
    """Return what a report of an earlier version has: an archive of the whole texts, packed."""
    content = io.BytesIO()
    with tarfile.open(fileobj=content, mode="w") as found:
        for name, text in texts.items():
            member = tarfile.TarInfo(name)
            member.size = len(text)
            found.addfile(member, io.BytesIO(text.encode()))
    return packed(content.getvalue())


def test_files_of_this_version_and_of_earlier_ones_are_read(tmp_path: Path) -> None:
    """Side by side, the texts of both."""
    (tmp_path / "new.texts.xz").write_bytes(packed_texts(TEXTS))
    (tmp_path / "old.tar.xz").write_bytes(archive({"old.smt2": "(exit)\n"}))
    read = read_archives(tmp_path, {"new.texts.xz": [*TEXTS], "old.tar.xz": ["old.smt2"]})
    assert (read.texts, read.damaged) == ({**TEXTS, "old.smt2": "(exit)\n"}, {})


@pytest.mark.parametrize(
    ("file", "content", "why"),
    [
        ("a.texts.xz", packed(b"safeloc-certificates/3\n"), "damaged, no certificates (ValueError: no safeloc-certificates/2)"),
        ("a.texts.xz", archive(TEXTS), "damaged, no certificates (ValueError"),
        ("a.tar.xz", packed(b"safeloc-certificates/2\n" * 99), "damaged, no archive of certificates"),
        ("a.texts.xz", b"", "damaged, it ends too early"),
    ],
    ids=["a later version", "an archive", "not an archive", "nothing"],
)  # fmt: skip
def test_a_damaged_file_is_refused_by_name(tmp_path: Path, file: str, content: bytes, why: str) -> None:
    """With the reason, and none of its texts is read."""
    (tmp_path / file).write_bytes(content)
    read = read_archives(tmp_path, {file: [*TEXTS]})
    assert read.texts == {}
    assert read.damaged[file].startswith(f"{tmp_path / file}: {why}")
