"""Streams packed with gzip: what comes out is what went in, and a file that is not whole is refused by name."""

from __future__ import annotations

import gzip
import tracemalloc
from collections import deque
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from safeloc.errors import StreamError
from safeloc.runtime import outside
from safeloc.runtime.streams.files import lines_of, streaming
from safeloc.runtime.streams.gzipped import created, kind_of, name_of
from safeloc.runtime.streams.record_files import read_raw, write_records
from safeloc.runtime.streams.records import TruthRecord
from safeloc.runtime.streams.steps import StepStream, read_steps, write_steps

STEPS = [{"speed": number // 3, "closed": number % 7 == 0} for number in range(40)]


def packed(path: Path) -> bytes:
    """A packed stream of some steps, written there."""
    write_steps(path, STEPS, machine="door", first={"truth_nm": 5})
    return path.read_bytes()


def refused(path: Path) -> str:
    """What a person reads; as steps and as records the same."""
    told = set[str]()
    for read in (read_steps, read_raw):
        with pytest.raises(StreamError) as error:
            read(path)
        told.add(str(error.value).removeprefix(str(path)))
    (message,) = told
    return message


@pytest.mark.parametrize(
    ("file", "kind", "name"),
    [
        ("a.jsonl", ".jsonl", "a"),
        ("a.jsonl.gz", ".jsonl", "a"),
        ("a.b.csv.gz", ".csv", "a.b"),
        ("a.csv.csv", ".csv", "a.csv"),
        ("a.parquet", ".parquet", "a"),
        ("a.parquet.gz", ".gz", "a.parquet"),
        ("a.gz", ".gz", "a"),
    ],
)
def test_a_packed_stream_has_the_name_of_a_plain_one(file: str, kind: str, name: str) -> None:
    """So that findings are called the same."""
    assert (kind, name) == (kind_of(Path(file)), name_of(Path(file)))


@given(text=st.text(alphabet=st.characters(exclude_categories=["Cs"])))
def test_any_text_comes_back(tmp_path_factory: pytest.TempPathFactory, text: str) -> None:
    """To the byte, and the same as in a plain file."""
    plain, path = (tmp_path_factory.getbasetemp() / name for name in ("any.jsonl", "any.jsonl.gz"))
    for one in (plain, path):
        with created(one) as file:
            file.write(text)
    assert text.encode() == gzip.decompress(path.read_bytes()) == plain.read_bytes()


def test_equal_streams_are_equal_files(tmp_path: Path) -> None:
    """Whatever they are called and whenever they are written: no name, no time, no system in the file's head."""
    first, second = packed(tmp_path / "one.jsonl.gz"), packed(tmp_path / "two.jsonl.gz")
    assert first == second
    assert bytes.fromhex("1f8b 08 00 00000000 02 ff") == first[:10]


def test_a_packed_stream_says_what_a_plain_one_says(tmp_path: Path) -> None:
    """Machine, first state, steps, lines and columns."""
    for name in ("run.jsonl", "run.jsonl.gz"):
        packed(tmp_path / name)
    plain, found = (read_steps(tmp_path / name) for name in ("run.jsonl", "run.jsonl.gz"))
    assert isinstance(found, StepStream)
    assert plain == found
    assert len(STEPS) == len(found.steps)


def test_a_flaw_within_is_told_with_its_line(tmp_path: Path) -> None:
    """Of what is packed."""
    path = tmp_path / "run.jsonl.gz"
    path.write_bytes(gzip.compress(b'{"a": 1}\n{"a": 1.5}\n'))
    with pytest.raises(StreamError, match=r"run\.jsonl\.gz:2: a is 1\.5; steps hold whole numbers"):
        read_steps(path)


def test_files_that_were_joined_are_read_to_the_end(tmp_path: Path) -> None:
    """As gzip itself does: `cat one.gz two.gz`."""
    path = tmp_path / "run.jsonl.gz"
    path.write_bytes(gzip.compress(b'{"a": 1}\n') + gzip.compress(b'{"a": 2}\n'))
    assert read_steps(path).steps == ({"a": 1}, {"a": 2})


def test_every_cut_is_noticed(tmp_path: Path) -> None:
    """A file that ends anywhere before its end, also one with nothing left."""
    path = tmp_path / "cut.jsonl.gz"
    whole = packed(path)
    for end in range(len(whole)):
        path.write_bytes(whole[:end])
        with pytest.raises(
            StreamError, match=r"cut\.jsonl\.gz: damaged, it cannot be unpacked \(.+\); copy it again, "
        ):
            read_steps(path)


def test_every_changed_byte_is_noticed(tmp_path: Path) -> None:
    """By gzip's check sum, or by the flaw that it makes; bytes 4 to 9 are its time, effort and system, which say nothing."""
    path = tmp_path / "changed.jsonl.gz"
    whole, sound = packed(path), read_steps(path)
    for at in range(len(whole)):
        path.write_bytes(whole[:at] + bytes([whole[at] ^ 0xFF]) + whole[at + 1 :])
        if 4 <= at < 10:
            assert sound == read_steps(path)
            continue
        with pytest.raises(StreamError, match=r"changed\.jsonl\.gz"):
            read_steps(path)


@pytest.mark.parametrize("content", [b'{"a": 1}\n', b"", b"\x1f"])
def test_what_is_not_packed_at_all(tmp_path: Path, content: bytes) -> None:
    """A plain file under that name, and an empty one, which Python would take for an empty stream."""
    path = tmp_path / "plain.jsonl.gz"
    path.write_bytes(content)
    assert refused(path).startswith(": damaged, it cannot be unpacked (")


def test_something_after_the_end(tmp_path: Path) -> None:
    """Nothing is left unread in silence."""
    path = tmp_path / "longer.jsonl.gz"
    path.write_bytes(packed(path) + b"more")
    with pytest.raises(StreamError, match="damaged, it cannot be unpacked"):
        read_steps(path)


def test_a_small_file_that_stands_for_much(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """It is unpacked line by line up to the bound, no further, and no line of it is taken whole."""
    monkeypatch.setattr(outside, "LARGEST_FILE", 4_000_000)
    path = tmp_path / "large.jsonl.gz"
    for line, told in (
        (
            b"{}" + b" " * 997 + b"\n",
            ": more than 4000000 bytes when unpacked; this is too large to be read at once, split it.",
        ),
        (b"[" * 1_000, ":1: a line of more than 1000000 bytes; break it up."),
    ):
        with gzip.open(path, "wb", 1) as file:
            for _ in range(8_000_000 // (1_000 * len(line))):
                file.write(line * 1_000)
        assert path.stat().st_size < 500_000
        tracemalloc.start()
        with pytest.raises(StreamError) as error, streaming(path):
            deque(lines_of(path), 0)
        assert tracemalloc.get_traced_memory()[1] < 10_000_000
        tracemalloc.stop()
        assert told == str(error.value).removeprefix(str(path))


def test_parquet_is_not_packed_once_more(tmp_path: Path) -> None:
    """Neither way."""
    path, told = tmp_path / "run.parquet.gz", r"unknown kind of file '\.gz'; use \.jsonl, "
    with pytest.raises(StreamError, match=told):
        write_steps(path, STEPS)
    with pytest.raises(StreamError, match=told):
        write_records(path, [TruthRecord(time_ms=1, position_nm=2)])
    path.write_bytes(gzip.compress(b"PAR1"))
    with pytest.raises(StreamError, match=told):
        read_steps(path)
