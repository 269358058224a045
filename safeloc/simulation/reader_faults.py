"""Puts faults of a marker reader into its readings.

missed      the reader does not report the marker
repeated    it reports every reading once more, unchanged, in the next cycle without one
misplaced   it reports the identity, and so the mapped place, of another marker of the line: a marker mounted at the wrong
            place, or cross-talk from the neighbouring track
foreign     it reports an identity that the map does not have
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from safeloc.errors import InputError
from safeloc.simulation.faults import Fault, Kinds, plain
from safeloc.simulation.sensors import FOREIGN, Reading

KINDS = Kinds("a marker reader", {**plain("missed", "repeated", "foreign"), "misplaced": {"reach": 2}})
"""Faults by name of the reader, in cycles. The marker read instead is the `reach`-th after the true one (negative: before)."""


def with_faults(
    name: str,
    readings: Sequence[Reading],
    markers: Sequence[tuple[int, int]],
    faults: Sequence[Fault],
    *,
    anywhen: bool = False,
) -> list[Reading]:
    """Return the readings of the reader of this name with its faults, applied one after the other.

    anywhen  faults are drawn at some time: one between readings, or where no other marker is near, changes nothing

    InputError for a fault that no reader has and, unless `anywhen`, for one that hits no reading and so would test nothing.
    """
    KINDS.require(faults)
    found = list(readings)
    for fault in faults:
        if not fault.strikes(name) or (anywhen and not _changes(fault, found, markers)):
            continue
        if not any(_hits(fault, reading) for reading in found):
            raise InputError(f"{fault} hits no reading; readings are in cycles {[one.cycle for one in found][:20]}.")
        found = _struck(found, markers, fault)
    return found


def _changes(fault: Fault, readings: Sequence[Reading], markers: Sequence[tuple[int, int]]) -> bool:
    """Return whether a fault hits a reading, and a marker told instead exists."""
    hit = [one.marker for one in readings if _hits(fault, one)]
    if fault.kind != "misplaced":
        return bool(hit)
    identities = [identity for identity, _ in markers]
    places = [identities.index(marker) + KINDS.figure(fault, "reach") for marker in hit if marker in identities]
    return bool(places) and 0 <= min(places) and max(places) < len(identities)


def _hits(fault: Fault, reading: Reading) -> bool:
    return fault.active(reading.cycle)


def _struck(readings: list[Reading], markers: Sequence[tuple[int, int]], fault: Fault) -> list[Reading]:
    match fault.kind:
        case "missed":
            return [one for one in readings if not _hits(fault, one)]
        case "repeated":
            return _repeated(readings, fault)
        case "misplaced":
            return [_misplaced(one, markers, fault) if _hits(fault, one) else one for one in readings]
        case _:
            return [_foreign(one) if _hits(fault, one) else one for one in readings]


def _repeated(readings: list[Reading], fault: Fault) -> list[Reading]:
    taken = {one.cycle for one in readings}
    more: list[Reading] = []
    for reading in readings:
        if _hits(fault, reading):
            cycle = reading.cycle + 1
            while cycle in taken:
                cycle += 1
            taken.add(cycle)
            more.append(replace(reading, cycle=cycle))
    return sorted([*readings, *more], key=lambda one: one.cycle)


def _misplaced(reading: Reading, markers: Sequence[tuple[int, int]], fault: Fault) -> Reading:
    identities = [identity for identity, _ in markers]
    if reading.marker not in identities:
        return reading
    reach = KINDS.figure(fault, "reach")
    number = identities.index(reading.marker) + reach
    if reach == 0 or not 0 <= number < len(markers):
        raise InputError(f"{fault}: marker {reading.marker} has no other one {reach} markers further on this line.")
    marker, place_mm = markers[number]
    return replace(reading, marker=marker, place_mm=place_mm)


def _foreign(reading: Reading) -> Reading:
    return replace(reading, marker=FOREIGN + reading.cycle % 1000, place_mm=None)
