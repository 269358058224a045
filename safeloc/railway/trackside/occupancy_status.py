"""Occupancy status telegrams for an interlocking: SCI-TDS of EULYNX (Eu.Doc.44), message "TVPS occupancy status".

A telegram has 50 bytes: protocol (0x20: train detection), message type (2 bytes, the lower first), sender and receiver (20 bytes
each, ISO 8859-1, filled up with `_`), and seven bytes of content. Layout and numbers are those on which public implementations of the
interface agree; the supplier of the interlocking has to confirm them. How it gets there (RaSTA, redundancy, sequence, time-out)
belongs to the connection, and is not here.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from enum import IntEnum
from struct import Struct
from typing import Any

from safeloc.errors import InputError

_PROTOCOL, _OCCUPANCY_STATUS, _NAME_BYTES = 0x20, 0x0007, 20
_LAYOUT = Struct(f"<BH{_NAME_BYTES}s{_NAME_BYTES}sBBhBBB")
_NO_FILLING_LEVEL, _NOT_APPLICABLE = -1, 0xFF


class Occupancy(IntEnum):
    """State of a train detection section, as far as virtual sections have it."""

    VACANT = 0x01
    OCCUPIED = 0x02
    DISTURBED = 0x03


class Trigger(IntEnum):
    """Reason why the state changed, as far as virtual sections have it."""

    PASSING_DETECTED = 0x01
    TECHNICAL_FAILURE = 0x04
    INITIAL_STATE = 0x05
    INTERNAL = 0x06
    NOT_APPLICABLE = _NOT_APPLICABLE


@dataclass(frozen=True)
class OccupancyStatus:
    """The content of a telegram about one section: no filling level, since sections count no axles, and no forcing to clear.

    sender, receiver  names of section and interlocking, at most 20 characters of ISO 8859-1 and no `_` at their end

    InputError for another name.
    """

    sender: str
    receiver: str
    occupancy: Occupancy
    trigger: Trigger = Trigger.NOT_APPLICABLE

    def __post_init__(self) -> None:
        for what, name in (("sender", self.sender), ("receiver", self.receiver)):
            if (
                not name
                or name != name.rstrip("_")
                or not name.isprintable()
                or len(_bytes_of(what, name)) > _NAME_BYTES
            ):
                raise InputError(
                    f"{what} {name!r}: give 1 to {_NAME_BYTES} characters of ISO 8859-1 that can be printed, with no _ at the end."
                )

    def encoded(self) -> bytes:
        """Return the 50 bytes of the telegram."""
        names = (_bytes_of("name", name).ljust(_NAME_BYTES, b"_") for name in (self.sender, self.receiver))
        return _LAYOUT.pack(
            _PROTOCOL, _OCCUPANCY_STATUS, *names, self.occupancy, _NOT_ABLE, _NO_FILLING_LEVEL, _NOT_APPLICABLE,
            _NOT_APPLICABLE if self.occupancy != Occupancy.DISTURBED else _OPERATIONAL, self.trigger,
        )  # fmt: skip


_NOT_ABLE = 0x01
"""The section cannot be forced to clear: it is clear on positive evidence only."""
_OPERATIONAL = 0x01
"""Disturbance that ends by itself once trains report again, and not by a repair."""


def decode_occupancy_status(telegram: bytes) -> OccupancyStatus:
    """Return what a telegram tells. InputError for another telegram, and for content that `OccupancyStatus` does not have."""
    if len(telegram) != _LAYOUT.size:
        raise InputError(f"{len(telegram)} bytes; an occupancy status has {_LAYOUT.size}.")
    protocol, kind, sender, receiver, occupancy, able, level, power, disturbance, trigger = _LAYOUT.unpack(telegram)
    if (protocol, kind) != (_PROTOCOL, _OCCUPANCY_STATUS):
        raise InputError(f"protocol {protocol:#04x}, message {kind:#06x}: no occupancy status of train detection.")
    names = [name.decode("latin-1").rstrip("_") for name in (sender, receiver)]
    try:
        known = Occupancy(occupancy), Trigger(trigger)
    except ValueError as error:
        raise InputError(f"an occupancy status with a value that virtual sections do not have: {error}.") from error
    found = OccupancyStatus(names[0], names[1], *known)
    if found.encoded() != telegram:
        raise InputError(
            f"an occupancy status with ability {able:#04x}, filling level {level}, power {power:#04x}, disturbance {disturbance:#04x}: "
            "virtual sections have none of them."
        )
    return found


def occupancy_of(report: Mapping[str, Any], section: int) -> Occupancy:
    """Return the state of a section (counted from 1) in the report of an area.

    VACANT only if the report says that the section is clear and its machine is FREE; DISTURBED if nothing is known of it (UNKNOWN);
    else OCCUPIED. InputError for a report that has no such section, or in which both contradict each other.
    """
    try:
        mode, clear = report["mode"][f"section_{section}"], report["outputs"][f"section_{section}.clear"]
    except (KeyError, TypeError) as error:
        raise InputError(f"the report has no section {section}.") from error
    if not isinstance(clear, bool) or clear is not (mode == "FREE"):
        raise InputError(f"section {section} is {mode}, and clear is {clear}: the report contradicts itself.")
    if clear:
        return Occupancy.VACANT
    return Occupancy.DISTURBED if mode == "UNKNOWN" else Occupancy.OCCUPIED


def _bytes_of(what: str, name: str) -> bytes:
    try:
        return name.encode("latin-1")
    except UnicodeEncodeError as error:
        raise InputError(f"{what} {name!r}: {name[error.start]!r} is no character of ISO 8859-1.") from error
