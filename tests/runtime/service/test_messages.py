"""Lines that are read in the short way are those that the standard library reads, to the same values."""

from __future__ import annotations

import json
from typing import Any

import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from safeloc.errors import InputError
from safeloc.runtime.service.messages import json_object

VALUE = st.recursive(
    st.none() | st.booleans() | st.integers() | st.floats(allow_nan=False, allow_infinity=False) | st.text(max_size=8),
    lambda one: st.lists(one, max_size=3) | st.dictionaries(st.text(max_size=4), one, max_size=3),
    max_leaves=5,
)
PIECES = [
    '"',
    "\\",
    ":",
    ",",
    "{",
    "}",
    "[",
    "]",
    " ",
    "\n",
    "-",
    "0",
    "9",
    ".",
    "e",
    "é",
    "\\u00e9",
    "\\ud800",
    "1e999",
    '"a": 1, ',
]


def once(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    """An object without a name that comes twice."""
    assert len(dict(pairs)) == len(pairs)
    return dict(pairs)


def as_the_library(text: bytes) -> object:
    """What the standard library reads; None if that is no object, or a name comes twice in one."""
    try:
        found = json.loads(text.decode(), object_pairs_hook=once)
    except (ValueError, AssertionError, RecursionError):
        return None
    return found if isinstance(found, dict) else None


def read(text: bytes) -> object:
    """What a process reads; None if it refuses the line."""
    try:
        return json_object(text)
    except InputError:
        return None


@given(
    st.dictionaries(st.text(max_size=8), VALUE, max_size=5),
    st.lists(st.tuples(st.integers(0, 99), st.sampled_from(PIECES)), max_size=3),
)
@example({"a": 2**64, "b": -(2**63) - 1, "c": 10**4_299}, [])
@example({"a": -0.0, "b": 1.7976931348623157e308, "c": 5e-324, "d": 9007199254740993.0}, [])
def test_a_line_is_read_as_by_the_standard_library(fields: dict[str, Any], damage: list[tuple[int, str]]) -> None:
    """Also where something was put into it; types and digits are compared as well."""
    text = json.dumps(fields)
    for place, piece in damage:
        text = text[:place] + piece + text[place:]
    for line in (text.encode(), json.dumps(fields, ensure_ascii=False).encode("utf-8", "surrogatepass")):
        assert repr(read(line)) == repr(as_the_library(line))


@pytest.mark.parametrize(
    "line",
    [
        b'{"a": 1, "a": 1}', b'{"a" : 1, "a": 1}', b'{"a": 1, "b": ":", "a": 1}', b'{"a": {"b": 1, "b": 1}}',
        b'{"a": 1, "\\u0061": 1}', b'{"a": [{"b": 1, "b": 2}]}',
    ],
)  # fmt: skip
def test_a_name_that_comes_twice(line: bytes) -> None:
    """It is refused, however it is written, and whatever other colons there are."""
    with pytest.raises(InputError, match="a name is given twice"):
        json_object(line)


@pytest.mark.parametrize(
    "line",
    [
        b'{"a": 01}',
        b'{"a": 1}x',
        b'{"a": "\xff"}',
        b"\xef\xbb\xbf{}",
        b'{"a": ' + b"9" * 4_301 + b"}",
        b"[1]",
        b"",
        b'{"a": "\x01"}',
    ],
)
def test_what_is_no_object(line: bytes) -> None:
    """It is refused."""
    with pytest.raises(InputError):
        json_object(line)


def test_more_names_than_a_line_may_have() -> None:
    """They are refused, as few bytes as they need."""
    with pytest.raises(InputError, match="names in one line"):
        json_object(json.dumps({str(number): 1 for number in range(1_001)}).encode())
