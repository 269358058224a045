"""Position reports promise no more than the interval that they are made from."""

from __future__ import annotations

from dataclasses import replace
from typing import Literal

import pytest
from hypothesis import given
from hypothesis import strategies as st

from safeloc.errors import InputError
from safeloc.railway.telegrams.layout import BitReader
from safeloc.railway.telegrams.packets import decode_packet, encode_packet
from safeloc.railway.telegrams.position_report import (
    CONFIRMED_BY_DEVICE,
    INTEGRITY_LOST,
    NOMINAL,
    REVERSE,
    UNKNOWN,
    Front,
    Lrbg,
    Train,
    position_report,
    reported_interval,
    unknown_position_report,
)
from safeloc.railway.telegrams.variables import UNKNOWN_GROUP, UNKNOWN_LENGTH, group_identity, scale_mm

LRBG = Lrbg(426, 21, 1_000_000, "along")
TRAIN = Train(speed_mm_s=27_778, moves="along", m_mode=0, m_level=2)
SENSES = st.sampled_from(["along", "against"])


def test_a_worked_report() -> None:
    """Front 512.34 m behind balise 1, 5.05 m and 3 m of doubt: 10 cm units, the position rounded, the doubts up."""
    report = position_report(Front(1_512_340, 5_050, 3_000), LRBG, TRAIN)
    assert {"Q_SCALE": 0, "D_LRBG": 5_123, "L_DOUBTUNDER": 51, "L_DOUBTOVER": 30} == {
        name: report[name] for name in ("Q_SCALE", "D_LRBG", "L_DOUBTUNDER", "L_DOUBTOVER")
    }
    assert (NOMINAL, NOMINAL, NOMINAL, 20) == tuple(
        report[n] for n in ("Q_DIRLRBG", "Q_DLRBG", "Q_DIRTRAIN", "V_TRAIN")
    )
    assert {**report, "L_PACKET": 114} == decode_packet(BitReader(encode_packet(report, "train")), "train")


def test_directions_are_seen_in_the_groups_nominal_direction() -> None:
    """Against the group's direction, behind it, backing up, at an unknown orientation."""
    front = Front(900_000, 1_000, 2_000, faces="against")
    over, under = (position_report(front, LRBG, TRAIN)[name] for name in ("L_DOUBTOVER", "L_DOUBTUNDER"))
    assert (10, 20) == (over, under)  # facing against the route, `above` is behind the front
    seen = [
        tuple(
            position_report(front, replace(LRBG, sense=sense), TRAIN)[n] for n in ("Q_DIRLRBG", "Q_DLRBG", "Q_DIRTRAIN")
        )
        for sense in ("along", "against", None)
    ]
    assert [(REVERSE, REVERSE, NOMINAL), (NOMINAL, NOMINAL, REVERSE), (UNKNOWN, UNKNOWN, UNKNOWN)] == seen
    assert UNKNOWN == position_report(front, LRBG, replace(TRAIN, moves=None))["Q_DIRTRAIN"]


def test_a_single_group_is_reported_with_the_one_before() -> None:
    """Packet 1, whose nominal direction leads from the previous group to this one."""
    report = position_report(Front(1_500_000, 0, 0), replace(LRBG, previous=(426, 20)), TRAIN)
    assert (1, group_identity(426, 20)) == (report["NID_PACKET"], report["NID_PRVLRBG"])
    assert 138 == len(encode_packet(report, "train"))


@given(
    st.integers(-300_000_000, 300_000_000), st.integers(0, 500_000), st.integers(0, 500_000), SENSES, SENSES,
    st.integers(0, 1_000_000),
)  # fmt: skip
def test_the_reported_interval_holds_the_interval(
    position: int,
    above: int,
    below: int,
    faces: Literal["along", "against"],
    sense: Literal["along", "against"],
    length: int,
) -> None:
    """And is no wider than two units; the safe length still reaches the min safe rear end."""
    front, lrbg = Front(position, above, below, faces), replace(LRBG, sense=sense)
    train = replace(TRAIN, q_length=CONFIRMED_BY_DEVICE, safe_length_mm=length)
    report = position_report(front, lrbg, train)
    low, high = reported_interval(decode_packet(BitReader(encode_packet(report, "train")), "train"), lrbg)
    unit = scale_mm(report["Q_SCALE"])
    assert low <= position - below and position + above <= high
    assert high - low <= above + below + 2 * unit
    away = abs(position - lrbg.position_mm)
    assert report["Q_SCALE"] == 0 or max(away, above, below, length) >= (UNKNOWN_LENGTH - 2) * unit // 10
    reported = lrbg.position_mm + (1 if position >= lrbg.position_mm else -1) * report["D_LRBG"] * unit
    rear = position - length if faces == "along" else position + length
    reach = report["L_TRAININT"] * unit
    assert (reported - reach <= rear) if faces == "along" else (reported + reach >= rear)


def test_what_cannot_be_reported_is_refused() -> None:
    """Negative margins, too fast, too far; and a report that says too little for an interval."""
    with pytest.raises(InputError, match="not negative"):
        position_report(Front(0, -1, 0), LRBG, TRAIN)
    with pytest.raises(InputError, match=r"above 600 km/h"):
        position_report(Front(0, 0, 0), LRBG, replace(TRAIN, speed_mm_s=170_000))
    with pytest.raises(InputError, match=r"exceed 327 km"):
        position_report(Front(400_000_000, 0, 0), LRBG, TRAIN)
    report = position_report(Front(0, 0, 0), LRBG, TRAIN)
    with pytest.raises(InputError, match="not to 426/22"):
        reported_interval(report, replace(LRBG, nid_bg=22))
    with pytest.raises(InputError, match="on which side"):
        reported_interval({**report, "Q_DLRBG": UNKNOWN}, LRBG)
    with pytest.raises(InputError, match="a length of the report is unknown"):
        reported_interval({**report, "L_DOUBTOVER": UNKNOWN_LENGTH}, LRBG)
    national = position_report(Front(0, 0, 0), LRBG, replace(TRAIN, m_level=1, nid_ntc=7))
    assert 122 == len(encode_packet(national, "train"))


def test_an_unlinked_group_is_never_the_reference() -> None:
    """SUBSET-026 3.6.2.2.2 a; the message names what to send."""
    message = r"^group 426/21 is unlinked, which is never the LRBG; .* send unknown_position_report\.$"
    for lrbg in (replace(LRBG, linked=False), replace(LRBG, linked=False, previous=(426, 20))):
        with pytest.raises(InputError, match=message):
            position_report(Front(1_512_340, 5_050, 3_000), lrbg, TRAIN)


@pytest.mark.parametrize("level", [{"m_level": 2}, {"m_level": 1, "nid_ntc": 6}])
def test_a_position_that_refers_to_no_linked_group_is_unknown(level: dict[str, int]) -> None:
    """LRBG, distance, doubts and directions are unknown; speed, mode and level are told, and the bits are those of packet 0."""
    train = replace(TRAIN, **level)  # type: ignore[arg-type]
    report = unknown_position_report(train)
    assert (UNKNOWN_GROUP, 20, train.m_level) == tuple(report[name] for name in ("NID_LRBG", "V_TRAIN", "M_LEVEL"))
    assert {UNKNOWN_LENGTH} == {report[name] for name in ("D_LRBG", "L_DOUBTOVER", "L_DOUBTUNDER")}
    assert {UNKNOWN} == {report[name] for name in ("Q_DIRLRBG", "Q_DLRBG", "Q_DIRTRAIN")}
    read = decode_packet(BitReader(encode_packet(report, "train")), "train")
    assert {**report, "L_PACKET": read["L_PACKET"]} == read
    with pytest.raises(InputError, match=r"the report is of|refers to NID_LRBG"):
        reported_interval(report, LRBG)


@pytest.mark.parametrize("more", [{"safe_length_mm": 200_000}, {"q_length": CONFIRMED_BY_DEVICE}])
def test_an_unknown_position_has_no_safe_length(more: dict[str, int]) -> None:
    """It counts from the front end, and integrity is confirmed with it only."""
    with pytest.raises(InputError, match=r"^a confirmed integrity comes with a safe train length, .* has neither\.$"):
        unknown_position_report(replace(TRAIN, **more))  # type: ignore[arg-type]
    assert INTEGRITY_LOST == unknown_position_report(replace(TRAIN, q_length=INTEGRITY_LOST))["Q_LENGTH"]


def test_a_single_group_without_a_known_one_before_has_unknown_directions() -> None:
    """SUBSET-026 3.4.2.3.3.3: the previous LRBG is unknown, and so is every direction of packet 1."""
    report = position_report(Front(1_512_340, 5_050, 3_000), Lrbg(426, 21, 1_000_000, None, (1_023, 16_383)), TRAIN)
    assert (1, UNKNOWN_GROUP) == (report["NID_PACKET"], report["NID_PRVLRBG"])
    assert {UNKNOWN} == {report[name] for name in ("Q_DIRLRBG", "Q_DLRBG", "Q_DIRTRAIN")}
