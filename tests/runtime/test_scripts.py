"""Scripts with packed data: what comes out is what went in, and a file that is not whole is refused by name."""

from __future__ import annotations

import base64
import gzip
import json
import re
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from safeloc.errors import InputError
from safeloc.runtime.scripts import quoted, read_script, script

CONTENT = b"a text of some length " * 40


@given(st.binary(max_size=3000), st.lists(st.text(), max_size=3))
def test_it_comes_back(tmp_path_factory: pytest.TempPathFactory, data: bytes, words: list[str]) -> None:
    """Whatever it is, and whatever words stand before it; equal data give equal texts."""
    path = tmp_path_factory.getbasetemp() / "packed.js"
    text = script("safelocPart", *words, data=data)
    path.write_text(text, encoding="utf-8")
    assert data == read_script(path, "safelocPart")
    assert text == script("safelocPart", *words, data=data)


@given(st.text())
def test_words_cannot_end_the_script(word: str) -> None:
    """A word that holds the end of a script is a string like any other."""
    text = quoted(f"</script><script>{word}")
    assert "<" not in text
    assert f"</script><script>{word}" == json.loads(text)


def test_every_cut_is_noticed(tmp_path: Path) -> None:
    """A file that ends anywhere before its end."""
    whole, path = script("safelocPart", "a", data=CONTENT), tmp_path / "cut.js"
    for end in range(len(whole)):
        path.write_text(whole[:end])
        with pytest.raises(InputError, match=r"cut\.js: damaged, it is no complete call of safelocPart\."):
            read_script(path, "safelocPart")


@pytest.mark.parametrize("place", ["begin", "middle", "end"])
def test_changed_data_are_noticed(tmp_path: Path, place: str) -> None:
    """By the checksum of gzip, wherever they were changed, and what follows after their end."""
    packed = gzip.compress(CONTENT)
    changes = {
        "begin": packed[:12] + bytes([packed[12] ^ 1]) + packed[13:],
        "middle": packed[:-6] + bytes([packed[-6] ^ 1]) + packed[-5:],
        "end": packed + b"more",
    }
    path = tmp_path / "changed.js"
    path.write_text(f'safelocPart("{base64.b64encode(changes[place]).decode()}");\n')
    with pytest.raises(InputError, match=r"changed\.js: damaged, (it cannot be unpacked|its data do not end)"):
        read_script(path, "safelocPart")


def test_another_script(tmp_path: Path) -> None:
    """One that calls another function is none."""
    path = tmp_path / "other.js"
    path.write_text(script("safelocPart", data=CONTENT))
    with pytest.raises(InputError, match=re.escape("other.js: damaged, it is no complete call of safelocRuns.")):
        read_script(path, "safelocRuns")


def test_a_small_file_that_stands_for_much(tmp_path: Path) -> None:
    """It is unpacked up to the bound, no further."""
    path = tmp_path / "large.js"
    path.write_text(script("safelocPart", data=bytes(10_000_000)))
    with pytest.raises(InputError, match=r"large\.js: more than 1000000 bytes when unpacked"):
        read_script(path, "safelocPart", 1_000_000)
