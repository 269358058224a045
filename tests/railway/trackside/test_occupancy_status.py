"""Occupancy status telegrams: the bytes of the layout, there and back, and no section vacant that is not clear."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from safeloc.errors import InputError
from safeloc.railway.trackside.occupancy_status import (
    Occupancy,
    OccupancyStatus,
    Trigger,
    decode_occupancy_status,
    occupancy_of,
)

PAGE = Path(__file__).resolve().parents[3] / "docs" / "trackside.md"
NAMES = st.text(st.characters(min_codepoint=33, max_codepoint=126, exclude_characters="_"), min_size=1, max_size=20)


def report(mode: str, clear: object) -> dict[str, Any]:
    """The report of an area with one section."""
    return {"mode": {"area": "SWEPT", "section_1": mode}, "outputs": {"section_1.clear": clear}}


def test_the_bytes_are_those_of_the_layout() -> None:
    """50 bytes: protocol, type with the lower byte first, names filled up, state, ability, filling level -1, power, disturbance, trigger."""
    told = OccupancyStatus("west.1", "EI_01", Occupancy.VACANT, Trigger.INTERNAL).encoded()
    assert told == b"\x20\x07\x00" + b"west.1______________" + b"EI_01_______________" + bytes.fromhex(
        "01 01 ffff ff ff 06"
    )
    disturbed = OccupancyStatus("west.1", "EI_01", Occupancy.DISTURBED, Trigger.INITIAL_STATE).encoded()
    assert disturbed[43:] == bytes.fromhex("03 01 ffff ff 01 05")


@given(NAMES, NAMES, st.sampled_from(Occupancy), st.sampled_from(Trigger))
def test_a_status_there_and_back(sender: str, receiver: str, occupancy: Occupancy, trigger: Trigger) -> None:
    """What was told is read again, and one byte less or more is no telegram."""
    told = OccupancyStatus(sender, receiver, occupancy, trigger)
    assert decode_occupancy_status(told.encoded()) == told
    for wrong in (told.encoded()[:-1], told.encoded() + b"\0"):
        with pytest.raises(InputError, match=r"^\d+ bytes; an occupancy status has 50"):
            decode_occupancy_status(wrong)


@given(st.binary(min_size=50, max_size=50))
def test_any_bytes_are_read_or_refused(data: bytes) -> None:
    """What is read is written as the same bytes."""
    head = b"\x20\x07\x00" + data[3:]
    try:
        found = decode_occupancy_status(head)
    except InputError:
        return
    assert found.encoded() == head


@pytest.mark.parametrize(
    ("place", "value", "why"),
    [
        (0, 0x30, "protocol 0x30, message 0x0007"),
        (1, 0x0B, "protocol 0x20, message 0x000b"),
        (43, 0x04, "an occupancy status with a value that virtual sections do not have"),
        (44, 0x02, "an occupancy status with ability 0x02"),
        (45, 0x00, "an occupancy status with ability 0x01, filling level -256"),
        (49, 0x02, "an occupancy status with a value that virtual sections do not have"),
        (3, 0x5F, "sender '': give 1 to 20 characters"),
    ],
)
def test_other_telegrams_are_refused(place: int, value: int, why: str) -> None:
    """By what they have that a virtual section has not."""
    telegram = bytearray(OccupancyStatus("w", "EI_01", Occupancy.OCCUPIED).encoded())
    telegram[place] = value
    with pytest.raises(InputError, match=f"^{why}"):
        decode_occupancy_status(bytes(telegram))


@pytest.mark.parametrize("name", ["", "a" * 21, "ends_", "Łódź", "a\nb"])
def test_names_that_do_not_fit_are_refused(name: str) -> None:
    """Nothing is cut off or replaced: two sections would share a name."""
    with pytest.raises(InputError, match=r"^receiver '"):
        OccupancyStatus("west.1", name, Occupancy.VACANT)


def test_only_a_clear_section_is_vacant() -> None:
    """Of all modes; and a report that contradicts itself is none."""
    found = {
        mode: occupancy_of(report(mode, mode == "FREE"), 1) for mode in ("FREE", "OCCUPIED", "AMBIGUOUS", "UNKNOWN")
    }
    assert found == {
        "FREE": Occupancy.VACANT, "OCCUPIED": Occupancy.OCCUPIED, "AMBIGUOUS": Occupancy.OCCUPIED, "UNKNOWN": Occupancy.DISTURBED,
    }  # fmt: skip
    for mode, clear in (("OCCUPIED", True), ("FREE", False), ("FREE", 1), ("FREE", None)):
        with pytest.raises(InputError, match=r"^section 1 is .*: the report contradicts itself"):
            occupancy_of(report(mode, clear), 1)
    with pytest.raises(InputError, match=r"^the report has no section 2"):
        occupancy_of(report("FREE", clear=True), 2)


def test_the_program_of_the_page_prints_what_it_says(capsys: pytest.CaptureFixture[str]) -> None:
    """As a reader would run it."""
    programs = re.findall(r"```python\n(.*?)```", PAGE.read_text(encoding="utf-8"), re.DOTALL)
    [program] = [one for one in programs if "occupancy_status" in one]
    exec(program, {})  # the page's own program
    assert capsys.readouterr().out.strip() == program.strip().rpartition("# ")[2]
