"""The distance to the next reflector, as a telegram brings it (RFL-5): packet 44, data for an application outside ETCS.

SUBSET-026 leaves the layout of these data to their user. The one here is this project's own:

    bits  what
    8     number of the layout: 1
    24    distance from balise 1 of the group to the next reflector in the direction of running, mm
    1     1: a distance follows at which the search for the reflector begins
    24    that distance, mm; not there after a 0

NID_XUSER, the number of the user, is assigned by whoever runs the line; there is no default.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import Any

from safeloc.errors import InputError
from safeloc.railway.telegrams.layout import BitReader, Values
from safeloc.railway.telegrams.packets import OTHER_DATA

_LAYOUT, _LAYOUT_BITS, _DISTANCE_BITS = 1, 8, 24
FARTHEST_MM = 2**_DISTANCE_BITS - 1
"""Longest distance that the layout holds."""


@dataclass(frozen=True)
class NextReflector:
    """The next reflector, as a telegram tells it.

    reflector_mm  distance from balise 1 of the group to the reflector, in the direction of running
    search_mm     distance at which the search for it begins; None: where the telegram was read

    InputError if a distance is no whole number from 0 to 16 777 215 mm, or the search begins behind the reflector.
    """

    reflector_mm: int
    search_mm: int | None = None

    def __post_init__(self) -> None:
        for name, value in (("reflector_mm", self.reflector_mm), ("search_mm", self.search_mm)):
            if value is not None and (isinstance(value, bool) or not 0 <= value <= FARTHEST_MM):
                raise InputError(f"{name} is {value}; give a whole number of mm from 0 to {FARTHEST_MM}.")
        if self.search_mm is not None and self.search_mm > self.reflector_mm:
            raise InputError(
                f"the search begins at {self.search_mm} mm, behind the reflector at {self.reflector_mm} mm."
            )


def packet_of(reflector: NextReflector, *, nid_xuser: int, q_dir: int) -> Values:
    """Return packet 44 for trains that pass the group in one direction (q_dir 0: reverse, 1: nominal)."""
    if q_dir not in (0, 1):
        raise InputError(f"Q_DIR is {q_dir}; a reflector ahead lies in one direction: 0 (reverse) or 1 (nominal).")
    search = "0" if reflector.search_mm is None else f"1{reflector.search_mm:0{_DISTANCE_BITS}b}"
    bits = f"{_LAYOUT:0{_LAYOUT_BITS}b}{reflector.reflector_mm:0{_DISTANCE_BITS}b}{search}"
    return {"NID_PACKET": OTHER_DATA, "Q_DIR": q_dir, "NID_XUSER": nid_xuser, "bits": bits}


def next_reflector(packet: Mapping[str, Any], *, nid_xuser: int) -> NextReflector | None:
    """Return what a packet tells of the next reflector; None if it is another packet, or of another user.

    InputError for a packet of this user whose layout is another one, is cut off, or goes on behind its end.
    """
    if packet.get("NID_PACKET") != OTHER_DATA or packet.get("NID_XUSER") != nid_xuser:
        return None
    bits = BitReader(packet["bits"])
    layout = _number(bits, _LAYOUT_BITS)
    if layout != _LAYOUT:
        raise InputError(
            f"packet {OTHER_DATA} of user {nid_xuser}: layout {layout} is not known; give layout {_LAYOUT}."
        )
    reflector_mm = _number(bits, _DISTANCE_BITS)
    search_mm = _number(bits, _DISTANCE_BITS) if bits.take(1) == "1" else None
    if bits.left:
        raise InputError(f"packet {OTHER_DATA} of user {nid_xuser}: {bits.left} bits more than its layout has.")
    return NextReflector(reflector_mm, search_mm)


def told_by(packets: Iterable[Mapping[str, Any]], *, nid_xuser: int) -> NextReflector | None:
    """Return what the packets of a group tell of the next reflector; None if they tell nothing.

    packets  those for the direction in which the train passed the group
    InputError if two of them differ.
    """
    found = {one for packet in packets if (one := next_reflector(packet, nid_xuser=nid_xuser)) is not None}
    if len(found) > 1:
        raise InputError(f"the telegrams of the group tell {len(found)} different next reflectors.")
    return next(iter(found), None)


def _number(bits: BitReader, size: int) -> int:
    return int(bits.take(size), 2)
