"""Packets of SUBSET-026: published ones, any values there and back, and what is refused."""

from __future__ import annotations

import json
from collections.abc import Mapping
from typing import Any

import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from safeloc.errors import InputError
from safeloc.railway.telegrams.balise_telegram import covered, decode_telegram, encode_telegram
from safeloc.railway.telegrams.layout import BitReader
from safeloc.railway.telegrams.packets import Sender, decode_packet, encode_packet
from safeloc.railway.telegrams.variables import VARIABLES, group_identity, length_mm
from tests.railway.telegrams.made import packets

REPORT: Mapping[str, tuple[int, int]] = {
    "NID_PACKET": (0, 8), "L_PACKET": (8, 13), "Q_SCALE": (21, 2), "NID_LRBG": (23, 24), "D_LRBG": (47, 15),
    "Q_DIRLRBG": (62, 2), "Q_DLRBG": (64, 2), "L_DOUBTOVER": (66, 15), "L_DOUBTUNDER": (81, 15), "Q_LENGTH": (96, 2),
    "V_TRAIN": (98, 7), "Q_DIRTRAIN": (105, 2), "M_MODE": (107, 4), "M_LEVEL": (111, 3),
}  # fmt: skip
"""First bit and number of bits in packet 0 without train length and national system (SUBSET-026 7.4.3.1)."""
NATIONAL_BITS: Mapping[str, int] = {
    "Q_SCALE": 23, "D_VALIDNV": 25, "NID_C": 40, "V_NVSHUNT": 65, "V_NVSTFF": 72, "V_NVONSIGHT": 79,
    "V_NVLIMSUPERV": 86, "V_NVUNFIT": 93, "V_NVREL": 100, "D_NVROLL": 107, "Q_NVSBTSMPERM": 122, "Q_NVEMRRLS": 123,
    "Q_NVGUIPERM": 124, "Q_NVSBFBPERM": 125, "Q_NVINHSMICPERM": 126, "V_NVALLOWOVTRP": 127,
}  # fmt: skip
"""First bits in packet 3 with one further country, as openETCS's formalisation of 7.4.2.1.1 has them."""


def link(distance: int, group: int) -> dict[str, int]:
    """A linked group as the published linking has it: same country, seen in reverse, train trip, 2 m."""
    return {
        "D_LINK": distance, "Q_NEWCOUNTRY": 0, "NID_BG": group, "Q_LINKORIENTATION": 0, "Q_LINKREACTION": 0, "Q_LOCACC": 2,
    }  # fmt: skip


PUBLISHED: dict[str, Any] = {
    "NID_PACKET": 5, "Q_DIR": 1, "L_PACKET": 1_200, "Q_SCALE": 1, **link(172, 365),
    "D_LINK(k)": [link(55, 366), link(152, 367), *(link(100, group) for group in range(368, 395))],
}  # fmt: skip
"""Linking of a real line as its recorder told it (openETCS/modeling, issue 434): 1200 bits, N_ITER 29, first three groups."""


def test_the_published_linking_has_its_length() -> None:
    """1200 bits with 29 groups behind the first, as recorded; back again it is the same."""
    bits = encode_packet(PUBLISHED, "track")
    assert 1_200 == len(bits)
    assert (
        "00000101"
        + "01"
        + f"{1200:013b}"
        + "01"
        + f"{172:015b}"
        + "0"
        + f"{365:014b}"
        + "0"
        + "00"
        + "000010"
        + "11101"
        == bits[:69]
    )
    assert PUBLISHED == decode_packet(BitReader(bits), "track")
    assert 172_000 == length_mm(PUBLISHED["D_LINK"], PUBLISHED["Q_SCALE"])


def test_a_packet_that_is_not_known_keeps_its_bits() -> None:
    """The level transition order of the same line (packet 41, 89 bits) is read, kept and written as it was."""
    bits = (
        f"{41:08b}"
        + "01"
        + f"{89:013b}"
        + "01"
        + f"{801:015b}"
        + "011"
        + f"{210:015b}"
        + "00001"
        + "001"
        + "0" * 8
        + f"{210:015b}"
    )
    found = decode_packet(BitReader(bits + "0101"), "track")
    assert (41, 1, 89, bits[23:]) == tuple(found[name] for name in ("NID_PACKET", "Q_DIR", "L_PACKET", "bits"))
    assert bits == encode_packet(found, "track")


def test_data_of_another_application_keep_their_bits_behind_its_user() -> None:
    """Packet 44: the user, for a national system its number as well, then the user's own bits; without them the packet is whole too."""
    cases: tuple[tuple[dict[str, Any], int], ...] = (
        ({"NID_XUSER": 5, "bits": "0110"}, 36),
        ({"NID_XUSER": 102, "NID_NTC": 7, "bits": ""}, 40),
        ({"NID_XUSER": 102, "NID_NTC": 7, "bits": "1"}, 41),
    )
    for packet, size in cases:
        bits = encode_packet({"NID_PACKET": 44, "Q_DIR": 1, **packet}, "track")
        assert size == len(bits)
        assert {"NID_PACKET": 44, "Q_DIR": 1, "L_PACKET": size, **packet} == decode_packet(
            BitReader(bits + "1"), "track"
        )
    assert f"{44:08b}" + "01" + f"{36:013b}" + f"{5:09b}" + "0110" == encode_packet(
        {"NID_PACKET": 44, "Q_DIR": 1, "NID_XUSER": 5, "bits": "0110"}, "track"
    )
    with pytest.raises(InputError, match=r"^packet 44: NID_NTC: no place for this here"):
        encode_packet({"NID_PACKET": 44, "Q_DIR": 1, "NID_XUSER": 5, "NID_NTC": 7, "bits": ""}, "track")
    with pytest.raises(InputError, match=r"^bit 0: packet 44 is said to have 31 bits, fewer than its header"):
        decode_packet(BitReader(f"{44:08b}" + "01" + f"{31:013b}" + f"{5:09b}"), "track")


def test_values_beside_the_bits_of_a_packet_are_refused() -> None:
    """A packet that is given as bits takes no values: they would be lost."""
    with pytest.raises(InputError, match=r"^packet 5: Q_SCALE: no place for this here"):
        encode_packet({"NID_PACKET": 5, "Q_DIR": 1, "Q_SCALE": 1, "bits": "0"}, "track")


@given(packets("train", 0), st.sampled_from([0, 3]), st.sampled_from([0, 2, 3, 4]))
def test_every_value_of_a_report_stands_where_the_table_has_it(packet: dict[str, Any], length: int, level: int) -> None:
    """Cut out of the bits by first bit and length; 114 bits in all without a train length and a national system."""
    packet |= {"Q_LENGTH": length, "M_LEVEL": level}
    packet = {name: value for name, value in packet.items() if name not in ("L_TRAININT", "NID_NTC")}
    bits = encode_packet(packet, "train")
    assert 114 == len(bits)
    assert packet | {"L_PACKET": 114} == {name: int(bits[at : at + size], 2) for name, (at, size) in REPORT.items()}


@given(packets("track", 3))
def test_national_values_stand_where_the_table_has_them(packet: dict[str, Any]) -> None:
    """By first bit, with one further country."""
    packet["NID_C(k)"] = [{"NID_C": 426}]
    bits = encode_packet(packet, "track")
    assert "00001" + f"{426:010b}" == bits[50:65]  # N_ITER, then the country
    for name, at in NATIONAL_BITS.items():
        assert packet[name] == int(bits[at : at + VARIABLES[name].bits], 2), name


@pytest.mark.parametrize("sender", ["track", "train"])
@given(data=st.data())
def test_any_packet_there_and_back(sender: Sender, data: st.DataObject) -> None:
    """Bits to values to bits, through JSON; a bit less is refused, a bit more is left."""
    packet = data.draw(packets(sender))
    bits = encode_packet(json.loads(json.dumps(packet)), sender)
    reader = BitReader(bits + "1")
    found = decode_packet(reader, sender)
    assert packet | {"L_PACKET": len(bits)} == found and 1 == reader.left
    assert bits == encode_packet(found, sender)
    with pytest.raises(InputError, match=r"^bit \d+: "):
        decode_packet(BitReader(bits[:-1]), sender)


@pytest.mark.parametrize("sender", ["track", "train"])
@given(bits=st.text("01", max_size=400))
@example(bits=f"{5:08b}")
@example(bits=f"{255:08b}")
@example(bits=f"{41:08b}" + "01" + f"{3:013b}")
def test_any_bits_are_read_or_refused(sender: Sender, bits: str) -> None:
    """What is read is written as the same bits; everything else is an InputError that names the bit."""
    reader, message = BitReader(bits), ""
    try:
        found = decode_packet(reader, sender)
    except InputError as error:
        message = str(error)
    assert message.startswith("bit ") if message else bits[: reader.at] == encode_packet(found, sender)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"Q_SCALE": 3}, "packet 5: Q_SCALE is 3, which is spare."),
        ({"D_LINK": 40_000}, "packet 5: D_LINK is 40000; give a whole number from 0 to 32767."),
        ({"D_LINK": True}, "packet 5: D_LINK is True; give a whole number from 0 to 32767."),
        ({"NID_C": 9}, "packet 5: NID_C: no place for this here."),
        ({"L_PACKET": 99}, "packet 5: L_PACKET is 99, but it has 1200 bits."),
        ({"D_LINK(k)": 3}, "packet 5: D_LINK(k): give a list of at most 31 members, each with its values by name."),
        (
            {"D_LINK(k)": [{**link(1, 2), "Q_LOCACC": 64}]},
            "packet 5: D_LINK(k) 1: Q_LOCACC is 64; give a whole number from 0 to 63.",
        ),
        ({"NID_PACKET": None}, "a packet needs its NID_PACKET."),
        ({"NID_PACKET": 41}, "packet 41: is not known here; give its content as bits."),
    ],
)
def test_wrong_values_are_refused_by_name(change: dict[str, Any], message: str) -> None:
    """With packet, member of a list, variable and what to give."""
    with pytest.raises(InputError) as refused:
        encode_packet({**PUBLISHED, **change}, "track")
    assert message == str(refused.value)


def test_what_is_missing_or_contradicts_itself_is_refused() -> None:
    """A variable left out, a length that is not the packet's, and a text that is no bits."""
    with pytest.raises(InputError, match=r"^packet 5: Q_DIR is missing"):
        encode_packet({name: value for name, value in PUBLISHED.items() if name != "Q_DIR"}, "track")
    bits = encode_packet(PUBLISHED, "track")
    with pytest.raises(InputError, match=r"^bit 0: packet 5 has 1200 bits, its L_PACKET says 1201"):
        decode_packet(BitReader(bits[:10] + f"{1201:013b}" + bits[23:] + "0"), "track")
    with pytest.raises(InputError, match=r"^bit 8: Q_DIR is 3, which is spare"):
        decode_packet(BitReader(bits[:8] + "11" + bits[10:]), "track")
    with pytest.raises(InputError, match=r"^bit 2 is 'x'"):
        BitReader("01x")


# ------------------------------------------------------------------ telegrams

HEADER = {
    "Q_UPDOWN": 1, "M_VERSION": 33, "Q_MEDIA": 0, "N_PIG": 0, "N_TOTAL": 1, "M_DUP": 0, "M_MCOUNT": 255, "NID_C": 426,
    "NID_BG": 21, "Q_LINK": 1,
}  # fmt: skip


def test_a_telegram_there_and_back() -> None:
    """50 bits of header, the packets, 8 bits of end; filled up to a short telegram of 210 bits."""
    cover = {"NID_PACKET": 0, "NID_VBCMK": 5}
    telegram: dict[str, Any] = {**HEADER, "packets": [cover, {**PUBLISHED, "D_LINK(k)": []}]}
    del telegram["packets"][1]["L_PACKET"]
    bits = encode_telegram(telegram, 210)
    assert (210, 50 + 14 + 69 + 8) == (len(bits), len(encode_telegram(telegram)))
    found = decode_telegram(bits)
    assert {name: found[name] for name in HEADER} == HEADER
    assert [0, 5] == [packet["NID_PACKET"] for packet in found["packets"]]
    assert "1" + f"{33:07b}" + "0" + "000" + "001" + "00" + "1" * 8 + f"{426:010b}" + f"{21:014b}" + "1" == bits[:50]
    with pytest.raises(InputError, match="has 141 bits, 100 are there"):
        encode_telegram(telegram, 100)
    with pytest.raises(InputError, match=r"^header: N_PIG is 8"):
        encode_telegram({**HEADER, "N_PIG": 8})
    with pytest.raises(InputError, match=r"^bit 133: NID_PACKET needs 8 bits"):
        decode_telegram(bits[:133])


def test_packets_of_another_system_version_keep_their_bits() -> None:
    """Packet 3 of version 1 has other variables: nothing is read into it."""
    packet = {"NID_PACKET": 3, "Q_DIR": 1, "bits": "0110"}
    first = {**HEADER, "M_VERSION": 16, "packets": [packet]}
    [found] = decode_telegram(encode_telegram(first))["packets"]
    assert packet | {"L_PACKET": 27} == found
    with pytest.raises(InputError):
        decode_telegram(encode_telegram({**first, "M_VERSION": 32}))


def test_a_virtual_cover_hides_its_own_telegrams() -> None:
    """By country and marker; the marker has to come first."""
    marker, other = {"NID_PACKET": 0, "NID_VBCMK": 5}, {"NID_PACKET": 41, "Q_DIR": 1, "L_PACKET": 24, "bits": "1"}
    marked, late, bare = ({**HEADER, "packets": each} for each in ([marker, other], [other, marker], []))
    assert covered(marked, [(426, 5)])
    assert not covered(marked, [(426, 6), (84, 5)])
    assert not covered(late, [(426, 5)]) and not covered(bare, [(426, 5)])


def test_identities_are_country_and_number() -> None:
    """NID_LRBG has ten bits of country, then fourteen of the group."""
    assert int("0110101010" + "00000000010101", 2) == group_identity(426, 21)
    with pytest.raises(InputError, match="NID_BG is 16384"):
        group_identity(426, 16_384)
