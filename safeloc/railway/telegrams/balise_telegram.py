"""A Eurobalise's telegram: header, packets, end packet (SUBSET-026 8.4.2).

What is here are the user bits, 830 or 210 of them. Their code with check bits and scrambling (SUBSET-036) is the reader's:
it tells the bits only where the check is right.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from safeloc.errors import InputError
from safeloc.railway.telegrams.layout import BitReader, Values, decoded, encoded
from safeloc.railway.telegrams.packets import END, VIRTUAL_COVER_MARKER, encode_packet, packets_until_end

HEADER = (
    "Q_UPDOWN", "M_VERSION", "Q_MEDIA", "N_PIG", "N_TOTAL", "M_DUP", "M_MCOUNT", "NID_C", "NID_BG", "Q_LINK",
)  # fmt: skip
_SYSTEM_VERSION = 2
"""The first three bits of M_VERSION: the version whose packets are known here."""


def decode_telegram(bits: str) -> Values:
    """Return the header's values and `packets`; bits behind the end packet are padding and are not read.

    Packets of another system version are kept as bits. Raises InputError with the bit for anything cut off or spare.
    """
    reader = BitReader(bits)
    header = decoded(HEADER, reader)
    known = header["M_VERSION"] >> 4 == _SYSTEM_VERSION
    return {**header, "packets": list(packets_until_end(reader, known=known))}


def encode_telegram(values: Mapping[str, Any], size: int | None = None) -> str:
    """Return the bits of a telegram with its end packet, filled up with ones to `size` bits. InputError if it does not fit."""
    header = {name: value for name, value in values.items() if name != "packets"}
    packets: Sequence[Mapping[str, Any]] = values.get("packets", ())
    content = "".join(encode_packet(packet, "track") for packet in packets)
    bits = encoded(HEADER, header, "header: ") + content + encode_packet({"NID_PACKET": END}, "track")
    if size is not None and len(bits) > size:
        raise InputError(f"the telegram has {len(bits)} bits, {size} are there; leave out packets.")
    return bits.ljust(size or 0, "1")


def covered(telegram: Values, covers: Sequence[tuple[int, int]]) -> bool:
    """Return whether a virtual balise cover hides the telegram: its marker comes first, and its country has that cover.

    covers   country and marker (NID_C, NID_VBCMK) of the covers that are set
    """
    first = next(iter(telegram["packets"]), None)
    if first is None or first["NID_PACKET"] != VIRTUAL_COVER_MARKER:
        return False
    return (telegram["NID_C"], first["NID_VBCMK"]) in covers
