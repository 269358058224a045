"""What a proxy says of a connection: the vehicle of the certificate that it checked, or nothing is heard."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from safeloc.errors import InputError
from safeloc.runtime.service.introduction import LONGEST, SIGNATURE, Introduction
from tests.runtime.service.introducing import header, part, tls


def introduced(data: bytes) -> tuple[str | None, bytes]:
    """Who it is, and what stands behind the header."""
    made = Introduction()
    rest = made.after(data)
    return made.vehicle, rest


@pytest.mark.parametrize(("family", "size"), [(0x00, 0), (0x11, 12), (0x21, 36), (0x31, 216)])
def test_the_name_in_the_certificate(family: int, size: int) -> None:
    """Whatever the addresses before it, and other parts beside it."""
    told = header(part(0x04, b"\0\0") + tls(b"train-12") + part(0xE0, b"x"), family=family, addresses=b"\7" * size)
    assert introduced(told + b"line\n") == ("train-12", b"line\n")


def test_a_session_that_goes_on() -> None:
    """Its certificate was checked when it began."""
    assert introduced(header(tls(b"12", client=0x05))) == ("12", b"")


@given(st.lists(st.integers(1, 40), max_size=8), st.binary(max_size=30))
def test_in_pieces(sizes: list[int], lines: bytes) -> None:
    """However it comes, the same is heard."""
    whole, made, heard = header(tls(b"12")) + lines, Introduction(), b""
    for size in sizes:
        heard += made.after(whole[:size])
        whole = whole[size:]
    heard += made.after(whole)
    assert (made.vehicle, heard) == ("12", lines)


NOT_GOOD = "the proxy got no valid certificate"


@pytest.mark.parametrize(
    ("told", "why"),
    [
        (b'{"vehicle": "12"}\n', "no PROXY header of version 2"),
        (b"PROXY TCP4 127.0.0.1 127.0.0.1 1 2\r\n", "no PROXY header of version 2"),
        (SIGNATURE[:5] + b"x", "no PROXY header of version 2"),
        (header(tls(b"12"), command=0x20), "connects for itself"),
        (header(tls(b"12"), command=0x11), "connects for itself"),
        (header(tls(b"12"), family=0x41), "addresses of unknown kind 4"),
        (SIGNATURE + b"\x21\x11" + (LONGEST + 1).to_bytes(2, "big"), "4097 bytes; at most 4096"),
        (header(b""), "0 times a TLS part"),
        (header(tls(b"12") + tls(b"13")), "2 times a TLS part"),
        (header(tls(b"12")[:-1]), "ends within one of its parts"),
        (header(tls(b"12") + b"\x20"), "ends within one of its parts"),
        (header(part(0x20, b"")), NOT_GOOD),
        (header(part(0x20, b"\x07\0\0\0")), NOT_GOOD),
        (header(tls(b"12", client=0x06)), NOT_GOOD),
        (header(tls(b"12", client=0x01)), NOT_GOOD),
        (header(tls(b"12", verified=10)), NOT_GOOD),
        (header(tls()), "0 times a common name"),
        (header(tls(b"12", b"13")), "2 times a common name"),
        (header(tls(b"")), "the certificate is of ''"),
        (header(tls(b"12\n")), "which cannot be the name of a vehicle"),
        (header(tls(b"\xc3\xa4")), "which cannot be the name of a vehicle"),
        (header(tls(b"x" * 65)), "which cannot be the name of a vehicle"),
    ],
)
def test_who_is_not_introduced(told: bytes, why: str) -> None:
    """Nothing is heard of it, and the reason is told."""
    with pytest.raises(InputError, match=why):
        introduced(told + b"line\n")


@given(st.binary(max_size=100) | st.binary(max_size=60).map(header) | st.binary(max_size=60).map(tls).map(header))
def test_anything_else(told: bytes) -> None:
    """Is refused in words, or waited for; and who is taken has a name."""
    try:
        vehicle, rest = introduced(told)
    except InputError:
        return
    assert vehicle is not None or rest == b""


def test_half_a_header_is_waited_for() -> None:
    """Nobody is taken before its last byte."""
    whole = header(tls(b"12"))
    assert {introduced(whole[:size]) for size in range(len(whole))} == {(None, b"")}
    assert introduced(whole) == ("12", b"")
