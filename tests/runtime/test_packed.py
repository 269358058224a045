"""Packed files: what comes out is what went in, and a file that is not whole is refused by name."""

from __future__ import annotations

import lzma
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from safeloc.errors import InputError
from safeloc.runtime.packed import packed, read_packed

CONTENT = b"a text of some length " * 40


@given(st.binary(max_size=3000))
def test_it_comes_back(tmp_path_factory: pytest.TempPathFactory, data: bytes) -> None:
    """Whatever it is; equal data give equal files."""
    path = tmp_path_factory.getbasetemp() / "packed.xz"
    path.write_bytes(packed(data))
    assert data == read_packed(path)
    assert packed(data) == path.read_bytes()


def test_every_cut_is_noticed(tmp_path: Path) -> None:
    """A file that ends anywhere before its end."""
    whole, path = packed(CONTENT), tmp_path / "cut.xz"
    for end in range(len(whole)):
        path.write_bytes(whole[:end])
        with pytest.raises(InputError, match=r"cut\.xz: damaged, it "):
            read_packed(path)


def test_every_changed_byte_is_noticed(tmp_path: Path) -> None:
    """By xz's own check sums."""
    whole, path = packed(CONTENT), tmp_path / "changed.xz"
    for at in range(len(whole)):
        path.write_bytes(whole[:at] + bytes([whole[at] ^ 1]) + whole[at + 1 :])
        with pytest.raises(InputError, match=r"changed\.xz: (damaged, |more than )"):
            read_packed(path)


def test_something_after_the_end(tmp_path: Path) -> None:
    """Nothing is left unread in silence."""
    path = tmp_path / "longer.xz"
    path.write_bytes(packed(CONTENT) + lzma.compress(b"more"))
    with pytest.raises(InputError, match=r"longer\.xz: damaged, something follows after its end\."):
        read_packed(path)


def test_a_small_file_that_stands_for_much(tmp_path: Path) -> None:
    """It is unpacked up to the bound, no further."""
    path = tmp_path / "large.xz"
    path.write_bytes(packed(bytes(10_000_000)))
    with pytest.raises(InputError, match=r"large\.xz: more than 1000000 bytes when unpacked"):
        read_packed(path, 1_000_000)
