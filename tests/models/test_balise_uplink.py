"""Linking, national values and group readings, from telegrams to the balise machine's inputs and back to a position report."""

from __future__ import annotations

from typing import Any

import pytest

from safeloc.errors import InputError
from safeloc.models.balise.groups import Group, telegram
from safeloc.models.balise.uplink import (
    NationalAccuracy,
    Sender,
    announcements,
    concerns,
    group_reading,
    identity,
    reflector_ahead,
    valid_from_mm,
)
from safeloc.railway.telegrams.balise_telegram import decode_telegram, encode_telegram
from safeloc.railway.telegrams.layout import BitReader
from safeloc.railway.telegrams.next_reflector import NextReflector, packet_of
from safeloc.railway.telegrams.packets import BODIES, decode_packet, encode_packet
from safeloc.railway.telegrams.position_report import Front, Lrbg, Train, position_report, reported_interval
from tests.models.balise_runs import PLAIN, drive, step
from tests.railway.telegrams.test_packets import HEADER, PUBLISHED, link

SENDER = Sender(nid_c=426, position_mm=1_000_000, passed="NOMINAL", accuracy_mm=1_000)


def test_the_published_linking_announces_its_groups() -> None:
    """Thirty announcements: a new list, then additions, at the sums of the distances."""
    found = announcements(PUBLISHED, SENDER)
    assert ["REPLACE"] + ["ADD"] * 29 == [one["linking_order"] for one in found]
    assert [1_172_000, 1_227_000, 1_379_000] == [one["linking_position_mm"] for one in found[:3]]
    assert {
        "linking_order": "REPLACE", "linking_group": identity(426, 365), "linking_position_mm": 1_172_000,
        "linking_accuracy_mm": 2_000, "linking_reaction": "TRAIN_TRIP", "linking_orientation": "REVERSE",
    } == found[0]  # fmt: skip


def test_accuracies_of_distances_add_up() -> None:
    """1 m of the sender, and for each distance 2 m and half a unit of 1 m; beyond 63 m the map has to tell the place."""
    found = announcements({**PUBLISHED, "D_LINK(k)": PUBLISHED["D_LINK(k)"][:3]}, SENDER, "distance")
    assert [3_500, 6_000, 8_500, 11_000] == [one["linking_accuracy_mm"] for one in found]
    with pytest.raises(
        InputError, match=r"^linked group 25: the distances to it are wrong by up to 63500 mm, more than 63000 mm"
    ):
        announcements(PUBLISHED, SENDER, "distance")


def test_linking_of_the_other_direction_and_of_other_countries() -> None:
    """Q_DIR reverse is not for a train in nominal direction; a new country counts from its group on."""
    assert [] == announcements({**PUBLISHED, "Q_DIR": 0}, SENDER)
    assert 30 == len(announcements({**PUBLISHED, "Q_DIR": 2}, SENDER))
    assert [True, False, True] == [concerns({"Q_DIR": direction}, "REVERSE") for direction in (0, 1, 2)]
    abroad = {**link(55, 366), "Q_NEWCOUNTRY": 1, "NID_C": 84}
    found = announcements({**PUBLISHED, "D_LINK(k)": [abroad, link(10, 3)]}, SENDER)
    assert [identity(426, 365), identity(84, 366), identity(84, 3)] == [one["linking_group"] for one in found]


def test_what_cannot_be_announced_is_refused() -> None:
    """Another packet; a group whose identity is told later."""
    with pytest.raises(InputError, match="linking is packet 5, not 3"):
        announcements({"NID_PACKET": 3}, SENDER)
    with pytest.raises(InputError, match=r"linked group 2 has no identity"):
        announcements({**PUBLISHED, "D_LINK(k)": [link(1, 16_383)]}, SENDER)


def test_the_national_accuracy_is_for_its_countries() -> None:
    """NID_C and the list of further countries; elsewhere, and before anything was received, the default counts."""
    packet = national_values(5) | {"NID_C(k)": [{"NID_C": 84}]}
    stored = NationalAccuracy(default_mm=12_000).received(packet)
    assert [5_000, 5_000, 12_000] == [stored.inputs(country)["national_accuracy_mm"] for country in (426, 84, 85)]
    assert {"national_accuracy_mm": 12_000} == NationalAccuracy(12_000).inputs(426)
    newer = stored.received(national_values(7))
    assert [7_000, 12_000] == [newer.inputs(country)["national_accuracy_mm"] for country in (426, 84)]
    assert [0, 3_000] == [valid_from_mm({**packet, "Q_SCALE": 1, "D_VALIDNV": distance}) for distance in (32_767, 3)]
    with pytest.raises(InputError, match="national values are packet 3, not 5"):
        stored.received({"NID_PACKET": 5})


def test_withdrawn_national_values_are_the_machines_default_again() -> None:
    """A group of another country is judged with the default accuracy: its interval is that of a machine that received none."""
    abroad = Group(identity(85, 1), 0, accuracy_mm=None)
    stored = NationalAccuracy(PLAIN.default_accuracy_mm).received(national_values(1))
    read = step(1_000, telegram(abroad, since_mm=0))
    margins = [
        drive([step(1_000, before), read | with_it]).steps[-1].outputs["margin_above_mm"]
        for before, with_it in (({}, {}), (stored.inputs(426), {}), (stored.inputs(426), stored.inputs(85)))
    ]
    assert margins[1] < margins[0] == margins[2]


def balise(number: int, **changed: int) -> dict[str, Any]:
    """The telegram of a balise of a linked group of three."""
    values = {**HEADER, "N_PIG": number, "N_TOTAL": 2, **changed, "packets": []}
    return decode_telegram(encode_telegram(values))


def test_a_group_reading_is_made_of_telegrams() -> None:
    """Size, number of balises read, first and last, identity and linking."""
    assert {
        "telegram_group": identity(426, 21), "telegram_link": "LINKED", "telegram_check": "PASSED", "telegram_total": 3,
        "telegram_read": 3, "telegram_first": 3, "telegram_last": 1, "telegram_age_ms": 12, "telegram_since_mm": 300,
    } == group_reading([balise(2), balise(1), balise(0)], age_ms=12, since_mm=300)  # fmt: skip
    missed = group_reading([balise(0, Q_LINK=0), balise(2, Q_LINK=0)], age_ms=0)
    assert (2, "UNLINKED") == (missed["telegram_read"], missed["telegram_link"])


def test_a_duplicate_stands_for_the_balise_beside_it() -> None:
    """M_DUP names the next or the previous one; one balise alone shows no direction, whatever its duplicate."""
    assert 3 == group_reading([balise(0, M_DUP=1), balise(2)], age_ms=0)["telegram_read"]
    assert 3 == group_reading([balise(0), balise(2, M_DUP=2)], age_ms=0)["telegram_read"]
    assert 2 == group_reading([balise(0, M_DUP=2), balise(2, M_DUP=1)], age_ms=0)["telegram_read"]
    assert 1 == group_reading([balise(0, M_DUP=1)], age_ms=0)["telegram_read"]
    without_first = group_reading([balise(1, M_DUP=2), balise(2)], age_ms=0)  # time and distance count from balise 1
    assert (2, 3) == (without_first["telegram_read"], without_first["telegram_total"])


def test_telegrams_that_are_no_group_are_refused() -> None:
    """None, of two groups, or one balise twice."""
    with pytest.raises(InputError, match="at least one balise"):
        group_reading([], age_ms=0)
    with pytest.raises(InputError, match="of different groups"):
        group_reading([balise(0), balise(1, NID_BG=22)], age_ms=0)
    with pytest.raises(InputError, match="one balise comes twice"):
        group_reading([balise(0), balise(0)], age_ms=0)


def test_a_telegram_tells_the_reflector_of_its_direction() -> None:
    """The place of a reflector for each direction of running: the machine keeps the one that lies ahead, and where its search begins."""
    ahead, behind = NextReflector(150_000, 120_000), NextReflector(90_000)
    sent = [packet_of(ahead, nid_xuser=300, q_dir=1), packet_of(behind, nid_xuser=300, q_dir=0)]
    values = {**HEADER, "N_TOTAL": 0, "packets": [{"NID_PACKET": 0, "NID_VBCMK": 5}, *sent]}
    telegrams = [decode_telegram(encode_telegram(values, 830))]
    assert {"telegram_reflector_mm": 90_000} == reflector_ahead(telegrams, "REVERSE", nid_xuser=300)
    assert {} == reflector_ahead(telegrams, "NOMINAL", nid_xuser=301)
    inputs = reflector_ahead(telegrams, "NOMINAL", nid_xuser=300)
    assert {"telegram_reflector_mm": 150_000, "telegram_search_mm": 120_000} == inputs
    read = group_reading([balise(number) for number in range(3)], age_ms=0, since_mm=0)
    read |= {"telegram_position_mm": 40_000, "telegram_orientation": "NOMINAL"}
    outputs = drive([read | inputs]).steps[-1].outputs
    assert (190_000, 160_000) == (outputs["reflector_mm"], outputs["search_mm"])


def test_from_telegrams_to_reports() -> None:
    """Bits of two groups' telegrams drive the machine; every report that is made of its position holds the true place.

    The vehicle runs 1 m a cycle; the wheel counts 3 % too little. Group 21 lies at 0, group 22 is announced at 50 m.
    """
    linking = {"NID_PACKET": 5, "Q_DIR": 1, "Q_SCALE": 0, **link(500, 22), "Q_LINKORIENTATION": 1, "D_LINK(k)": []}
    national = national_values(2)
    first = [{**HEADER, "N_PIG": number, "packets": [linking, national]} for number in (0, 1)]
    second = [{**one, "NID_BG": 22, "packets": []} for one in first]
    read_at = {0: (21, 0, first), 50: (22, 50_000, second)}
    stream: list[dict[str, Any]] = []
    announced: dict[str, Any] = {}
    for cycle in range(90):
        record: dict[str, Any] = {"odometer_mm": 970}
        if cycle in read_at:
            _, place, sent = read_at[cycle]
            telegrams = [decode_telegram(encode_telegram(one, 830)) for one in sent]
            record |= group_reading(telegrams, age_ms=0, since_mm=0)
            record |= {"telegram_position_mm": place, "telegram_orientation": "NOMINAL"}
            for packet in telegrams[0]["packets"]:
                if packet["NID_PACKET"] == 5:
                    [announced] = announcements(packet, Sender(426, place, "NOMINAL"))
                else:
                    record |= NationalAccuracy(PLAIN.default_accuracy_mm).received(packet).inputs(426)
        stream.append(record | (announced if cycle == 1 else {}))
    reported, run = 0, drive(stream).steps
    assert run[50].outputs["margin_above_mm"] < run[49].outputs["margin_above_mm"]  # the second group is accepted
    for cycle, made in enumerate(run):
        if made.outputs["valid"]:
            group, place, _ = read_at[50 if cycle >= 50 else 0]
            lrbg = Lrbg(426, group, place, "along")
            front = Front(*(int(made.outputs[name]) for name in ("position_mm", "margin_above_mm", "margin_below_mm")))
            report = position_report(front, lrbg, Train(speed_mm_s=1_000, moves="along", m_mode=0, m_level=2))
            low, high = reported_interval(decode_packet(BitReader(encode_packet(report, "train")), "train"), lrbg)
            assert low <= cycle * 1_000 <= high
            reported += 1
    assert reported == 90


def national_values(metres: int) -> dict[str, Any]:
    """National values with this location accuracy, all others 0, for one country."""
    names = [part for part in BODIES["track", 3] if isinstance(part, str)]
    values = dict.fromkeys(names, 0) | {"NID_C": 426, "NID_C(k)": [], "Q_NVLOCACC": metres}
    return {"NID_PACKET": 3, "Q_DIR": 2, **values}
