"""The next reflector in a telegram: there and back, into the balise machine, and what is refused."""

from __future__ import annotations

from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from safeloc.errors import InputError
from safeloc.railway.telegrams.layout import BitReader
from safeloc.railway.telegrams.next_reflector import FARTHEST_MM, NextReflector, next_reflector, packet_of, told_by
from safeloc.railway.telegrams.packets import decode_packet, encode_packet

USER = 300
DISTANCES = st.integers(0, FARTHEST_MM)


@st.composite
def reflectors(draw: st.DrawFn) -> NextReflector:
    """Any reflector, with and without a place of search before it."""
    reflector = draw(DISTANCES)
    return NextReflector(reflector, draw(st.none() | st.integers(0, reflector)))


@given(reflectors(), st.sampled_from([0, 1]))
def test_a_reflector_there_and_back(reflector: NextReflector, q_dir: int) -> None:
    """Through the bits of packet 44: 32 bits of header and user, 33 of data, 24 more with a place of search."""
    bits = encode_packet(packet_of(reflector, nid_xuser=USER, q_dir=q_dir), "track")
    assert len(bits) == 65 + (0 if reflector.search_mm is None else 24)
    found = decode_packet(BitReader(bits), "track")
    assert found["Q_DIR"] == q_dir
    assert next_reflector(found, nid_xuser=USER) == reflector


def test_the_bits_are_those_of_the_table() -> None:
    """Layout 1, 150 000 mm, search from 120 000 mm."""
    packet = packet_of(NextReflector(150_000, 120_000), nid_xuser=USER, q_dir=1)
    assert packet["bits"] == "00000001" + "000000100100100111110000" + "1" + "000000011101010011000000"


def test_other_packets_and_other_users_tell_nothing() -> None:
    """Nothing is read into data whose layout is not ours."""
    packet = packet_of(NextReflector(1), nid_xuser=USER, q_dir=1)
    assert next_reflector(packet, nid_xuser=USER + 1) is None
    assert next_reflector({**packet, "NID_PACKET": 5}, nid_xuser=USER) is None
    assert told_by([], nid_xuser=USER) is None


@pytest.mark.parametrize(
    ("bits", "why"),
    [
        ("00000010" + "0" * 25, "packet 44 of user 300: layout 2 is not known; give layout 1"),
        ("00000001" + "0" * 23, "bit 8: 24 bits are announced, 23 are left"),
        ("00000001" + "0" * 24, "bit 32: 1 bits are announced, 0 are left"),
        ("00000001" + "0" * 24 + "1" + "0" * 23, "bit 33: 24 bits are announced, 23 are left"),
        ("00000001" + "0" * 26, "packet 44 of user 300: 1 bits more than its layout has"),
        ("00000001" + "0" * 24 + "1" + "0" * 23 + "1", "the search begins at 1 mm, behind the reflector at 0 mm"),
    ],
)
def test_data_that_are_damaged_are_refused(bits: str, why: str) -> None:
    """By what is wrong with them."""
    packet: dict[str, Any] = {"NID_PACKET": 44, "Q_DIR": 1, "NID_XUSER": USER, "bits": bits}
    with pytest.raises(InputError, match=f"^{why}"):
        next_reflector(packet, nid_xuser=USER)


def test_wrong_values_are_refused() -> None:
    """Distances that the layout does not hold, both directions at once, and telegrams that contradict each other."""
    for wrong in (-1, FARTHEST_MM + 1, True):
        with pytest.raises(InputError, match=r"^reflector_mm is "):
            NextReflector(wrong)
    with pytest.raises(InputError, match=r"^search_mm is -1"):
        NextReflector(5, -1)
    with pytest.raises(InputError, match=r"^Q_DIR is 2"):
        packet_of(NextReflector(1), nid_xuser=USER, q_dir=2)
    both = [packet_of(NextReflector(mm), nid_xuser=USER, q_dir=1) for mm in (1, 2)]
    assert told_by(both[:1] * 2, nid_xuser=USER) == NextReflector(1)
    with pytest.raises(InputError, match=r"^the telegrams of the group tell 2 different next reflectors"):
        told_by(both, nid_xuser=USER)
