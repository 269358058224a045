"""Packets of SUBSET-026 7.4 in system version 2: national values, linking, virtual balise cover, position reports, other data.

A packet that is not known here is kept as its bits, and written as it was read: nothing is lost.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import Any, Literal

from safeloc.errors import InputError
from safeloc.railway.telegrams.layout import BitReader, Given, Listed, Part, Values, decoded, encoded
from safeloc.railway.telegrams.variables import VARIABLES

Sender = Literal["track", "train"]
END = 255
"""NID_PACKET of the end of a telegram; it has no length."""
VIRTUAL_COVER_MARKER = 0
OTHER_DATA = 44
"""NID_PACKET of data for an application outside ETCS, which NID_XUSER names; only that application knows their layout."""
_NATIONAL_SYSTEM = 102
"""NID_XUSER of a national train control system, which NID_NTC names."""
_LINK: Sequence[Part] = (
    "D_LINK", "Q_NEWCOUNTRY", Given("Q_NEWCOUNTRY", {1}, ("NID_C",)), "NID_BG", "Q_LINKORIENTATION", "Q_LINKREACTION",
    "Q_LOCACC",
)  # fmt: skip
_STEP: Sequence[Part] = ("V_NVKVINT", "M_NVKVINT", Given("Q_NVKVINTSET", {1}, ("M_NVKVINT(2)",)))
_RESISTANCE: Sequence[Part] = ("L_NVKRINT", "M_NVKRINT")


def _report(*previous: str) -> Sequence[Part]:
    return (
        "Q_SCALE", "NID_LRBG", *previous, "D_LRBG", "Q_DIRLRBG", "Q_DLRBG", "L_DOUBTOVER", "L_DOUBTUNDER", "Q_LENGTH",
        Given("Q_LENGTH", {1, 2}, ("L_TRAININT",)), "V_TRAIN", "Q_DIRTRAIN", "M_MODE", "M_LEVEL",
        Given("M_LEVEL", {1}, ("NID_NTC",)),
    )  # fmt: skip


def _correction(index: str) -> Sequence[Part]:
    """Return a set of correction factors; one of them for freight trains, two with limits of braking for passenger trains."""
    return (
        "Q_NVKVINTSET", Given("Q_NVKVINTSET", {1}, ("A_NVP12", "A_NVP23")), *_STEP, Listed(f"V_NVKVINT({index})", _STEP)
    )  # fmt: skip


BODIES: Mapping[tuple[Sender, int], Sequence[Part]] = {
    ("train", 0): _report(),
    ("train", 1): _report("NID_PRVLRBG"),
    ("track", 3): (
        "Q_SCALE", "D_VALIDNV", "NID_C", Listed("NID_C(k)", ("NID_C",)), "V_NVSHUNT", "V_NVSTFF", "V_NVONSIGHT",
        "V_NVLIMSUPERV", "V_NVUNFIT", "V_NVREL", "D_NVROLL", "Q_NVSBTSMPERM", "Q_NVEMRRLS", "Q_NVGUIPERM",
        "Q_NVSBFBPERM", "Q_NVINHSMICPERM", "V_NVALLOWOVTRP", "V_NVSUPOVTRP", "D_NVOVTRP", "T_NVOVTRP", "D_NVPOTRP",
        "M_NVCONTACT", "T_NVCONTACT", "M_NVDERUN", "D_NVSTFF", "Q_NVDRIVER_ADHES", "A_NVMAXREDADH1",
        "A_NVMAXREDADH2", "A_NVMAXREDADH3", "Q_NVLOCACC", "M_NVAVADH", "M_NVEBCL", "Q_NVKINT",
        Given("Q_NVKINT", {1}, (
            *_correction("n"), Listed("Q_NVKVINTSET(k)", _correction("m")), *_RESISTANCE,
            Listed("L_NVKRINT(l)", _RESISTANCE), "M_NVKTINT",
        )),
    ),
    ("track", 5): ("Q_SCALE", *_LINK, Listed("D_LINK(k)", _LINK)),
    ("track", 6): ("Q_VBCO", "NID_VBCMK", "NID_C", Given("Q_VBCO", {1}, ("T_VBC",))),
    ("track", OTHER_DATA): ("NID_XUSER", Given("NID_XUSER", {_NATIONAL_SYSTEM}, ("NID_NTC",))),
}  # fmt: skip
"""The parts behind NID_PACKET, Q_DIR (from the track) and L_PACKET, by sender and NID_PACKET. Behind those of packet 44
follow the data of its user, as `bits`."""
_BARE: Mapping[int, Sequence[Part]] = {VIRTUAL_COVER_MARKER: ("NID_VBCMK",), END: ()}
"""Packets from the track that have neither direction nor length."""


def decode_packet(bits: BitReader, sender: Sender, *, known: bool = True) -> Values:
    """Return the next packet.

    known   False: the layouts of another system version may differ, so every packet that has a length is kept as bits
    Raises InputError with the bit for anything cut off or spare, and for a length that is not that of the packet.
    """
    begin, number = bits.at, bits.peek("NID_PACKET")
    if sender == "track" and number in _BARE:
        return decoded(("NID_PACKET", *_BARE[number]), bits)
    header = decoded(_header(sender), bits)
    body = BODIES.get((sender, number)) if known else None
    values = header if body is None else header | decoded(body, bits)
    if body is None or number == OTHER_DATA:
        rest = header["L_PACKET"] - (bits.at - begin)
        if rest < 0:
            raise InputError(
                f"bit {begin}: packet {number} is said to have {header['L_PACKET']} bits, fewer than its header."
            )
        return {**values, "bits": bits.take(rest)}
    if bits.at - begin != values["L_PACKET"]:
        raise InputError(
            f"bit {begin}: packet {number} has {bits.at - begin} bits, its L_PACKET says {values['L_PACKET']}."
        )
    return values


def encode_packet(values: Mapping[str, Any], sender: Sender) -> str:
    """Return the bits of a packet; L_PACKET may be left out. InputError names the packet and the variable."""
    number = values.get("NID_PACKET")
    where = f"packet {number}: "
    if not isinstance(number, int):
        raise InputError("a packet needs its NID_PACKET.")
    if sender == "track" and number in _BARE:
        return encoded(("NID_PACKET", *_BARE[number]), values, where)
    kept = dict(values)
    stated = kept.pop("L_PACKET", None)
    header = _header(sender)
    names = [part for part in header if isinstance(part, str)]
    first = {name: kept.pop(name) for name in names if name in kept}
    content = _content(number, BODIES.get((sender, number)), kept, where)
    length = sum(VARIABLES[name].bits for name in names) + len(content)
    if stated not in (None, length):
        raise InputError(f"{where}L_PACKET is {stated}, but it has {length} bits.")
    return encoded(header, {**first, "L_PACKET": length}, where) + content


def _content(number: int, body: Sequence[Part] | None, values: Mapping[str, Any], where: str) -> str:
    """Return what follows the header: the values by the layout; else, and behind those of packet 44, the bits as they are."""
    left = {name: value for name, value in values.items() if name != "bits"}
    raw = values.get("bits")
    if raw is None and body is not None:
        return encoded(body, left, where)
    if not isinstance(raw, str):
        raise InputError(f"{where}is not known here; give its content as bits.")
    read_as_values = number == OTHER_DATA and "NID_XUSER" in left
    layout = body if read_as_values and body is not None else ()
    return encoded(layout, left, where) + BitReader(raw).take(len(raw))


def _header(sender: Sender) -> Sequence[Part]:
    return ("NID_PACKET", "Q_DIR", "L_PACKET") if sender == "track" else ("NID_PACKET", "L_PACKET")


def packets_until_end(bits: BitReader, *, known: bool = True) -> Iterator[Values]:
    """Yield the packets of a telegram without the end packet. InputError where the bits end before it."""
    while (packet := decode_packet(bits, "track", known=known))["NID_PACKET"] != END:
        yield packet
