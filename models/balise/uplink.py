"""Inputs of the balise machine from what trackside sends: linking (packet 5), national values (3), reflectors (44), readings.

A telegram tells distances; places follow from that of the group that sent it. Coordinates grow in the direction of running.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any, Literal

from safeloc.errors import InputError
from safeloc.language.units import MM_PER_M
from safeloc.models.balise.groups import GROUPS_OF_A_COUNTRY
from safeloc.models.balise.linking import LARGEST_ACCURACY_MM
from safeloc.railway.telegrams.layout import Values
from safeloc.railway.telegrams.next_reflector import told_by
from safeloc.railway.telegrams.variables import UNKNOWN_LENGTH, length_mm, scale_mm
from safeloc.runtime.streams.steps import Cell

_REVERSE_ONLY, _NOMINAL_ONLY = 0, 1
"""Q_DIR: for trains that pass the group in this direction; 2: for both."""
_REACTIONS = ("TRAIN_TRIP", "SERVICE_BRAKE", "NONE")
"""Q_LINKREACTION."""
_ORIENTATIONS = ("REVERSE", "NOMINAL")
"""Q_LINKORIENTATION."""
_UNKNOWN_GROUP = 16_383
"""NID_BG of a group whose identity a later telegram gives (repositioning)."""
_BEFORE_NEXT, _AFTER_PREVIOUS = 1, 2
"""M_DUP: the balise has the same telegram as the next one, or as the previous one."""
Accuracy = Literal["place", "distance"]


@dataclass(frozen=True)
class Sender:
    """The group that sent a packet, and how the train passed it.

    position_mm  place of its balise 1 along the route
    passed       direction in which the train passed the group
    accuracy_mm  location accuracy of the group; counts only where linking accuracies are those of distances
    """

    nid_c: int
    position_mm: int
    passed: Literal["NOMINAL", "REVERSE"]
    accuracy_mm: int = 0


def identity(nid_c: int, nid_bg: int) -> int:
    """Return the machine's number of a group."""
    return nid_c * GROUPS_OF_A_COUNTRY + nid_bg + 1


def concerns(packet: Values, passed: Literal["NOMINAL", "REVERSE"]) -> bool:
    """Return whether a packet is meant for a train that passed the group in this direction (Q_DIR)."""
    direction: int = packet["Q_DIR"]
    return direction != (_REVERSE_ONLY if passed == "NOMINAL" else _NOMINAL_ONLY)


def announcements(packet: Values, sender: Sender, accuracy_of: Accuracy = "place") -> list[dict[str, Cell]]:
    """Return the inputs that announce the groups of packet 5, one announcement a cycle; none if it is for the other direction.

    accuracy_of  `place`: Q_LOCACC is how far a group may lie from its place, which is the sum of the distances to it (the
                 assumption of the machine). `distance`: it is how far off a distance between two groups may be, so that errors
                 of the groups before, that of the sender and half a unit of every distance add up
    Raises InputError for another packet, a group without identity, and an accuracy above 63 m.
    """
    if packet.get("NID_PACKET") != 5:
        raise InputError(f"linking is packet 5, not {packet.get('NID_PACKET')}.")
    if not concerns(packet, sender.passed):
        return []
    return list(_announced(packet, sender, accuracy_of))


def _announced(packet: Values, sender: Sender, accuracy_of: Accuracy) -> Iterator[dict[str, Cell]]:
    links: Sequence[Values] = [packet, *packet["D_LINK(k)"]]
    country, place, chained = sender.nid_c, sender.position_mm, sender.accuracy_mm
    for number, link in enumerate(links, 1):
        country = link["NID_C"] if link["Q_NEWCOUNTRY"] else country
        place += length_mm(link["D_LINK"], packet["Q_SCALE"])
        own = link["Q_LOCACC"] * MM_PER_M
        chained += own + scale_mm(packet["Q_SCALE"]) // 2
        accuracy = own if accuracy_of == "place" else chained
        if link["NID_BG"] == _UNKNOWN_GROUP:
            raise InputError(f"linked group {number} has no identity; it is told later (repositioning).")
        if accuracy > LARGEST_ACCURACY_MM:
            raise InputError(
                f"linked group {number}: the distances to it are wrong by up to {accuracy} mm, more than {LARGEST_ACCURACY_MM} mm; "
                "take its place from the map."
            )
        yield {
            "linking_order": "REPLACE" if number == 1 else "ADD",
            "linking_group": identity(country, link["NID_BG"]),
            "linking_position_mm": place,
            "linking_accuracy_mm": accuracy,
            "linking_reaction": _REACTIONS[link["Q_LINKREACTION"]],
            "linking_orientation": _ORIENTATIONS[link["Q_LINKORIENTATION"]],
        }


@dataclass(frozen=True)
class NationalAccuracy:
    """The national location accuracy that is stored, and the countries that it is for (SUBSET-026 3.18.2).

    default_mm  counts before national values were received, and where those stored are not for the country of the group that
                was read last: they are withdrawn there (`default_accuracy_mm` of the machine)
    """

    default_mm: int
    stored_mm: int | None = None
    countries: frozenset[int] = frozenset()

    def received(self, packet: Values) -> NationalAccuracy:
        """Return what packet 3 leaves stored. It replaces all values before, from the place on that `valid_from_mm` tells."""
        if packet.get("NID_PACKET") != 3:
            raise InputError(f"national values are packet 3, not {packet.get('NID_PACKET')}.")
        countries = frozenset({packet["NID_C"], *(one["NID_C"] for one in packet["NID_C(k)"])})
        return replace(self, stored_mm=packet["Q_NVLOCACC"] * MM_PER_M, countries=countries)

    def inputs(self, nid_c: int) -> dict[str, Cell]:
        """Return the machine's input in a country: the value stored for it, else the default. Give it with each group read."""
        if self.stored_mm is None or nid_c not in self.countries:
            return {"national_accuracy_mm": self.default_mm}
        return {"national_accuracy_mm": self.stored_mm}


def valid_from_mm(packet: Values) -> int:
    """Return the distance from the group that sent packet 3 to where its values begin to count; 0: at once."""
    distance: int = packet["D_VALIDNV"]
    return 0 if distance == UNKNOWN_LENGTH else length_mm(distance, packet["Q_SCALE"])


def group_reading(
    telegrams: Sequence[Mapping[str, Any]], *, age_ms: int, since_mm: int | None = None
) -> dict[str, Cell]:
    """Return the inputs of a group reading from the telegrams of its balises, in the order in which they were read.

    age_ms, since_mm  time and measured distance since the antenna stood over balise 1
    A balise that was not read counts as read where its duplicate was (M_DUP). This does not hold for balise 1, since time and
    distance count from it, and not for a group of which a single balise was read, since that shows no direction of running:
    such a reading counts as incomplete. Raises InputError where there is no telegram, or
    two of them are not of one group, or one balise comes twice.
    """
    if not telegrams:
        raise InputError("a group reading needs the telegram of at least one balise.")
    heads = {tuple(one[name] for name in ("NID_C", "NID_BG", "N_TOTAL", "Q_LINK")) for one in telegrams}
    if len(heads) > 1:
        raise InputError("the telegrams are of different groups, or contradict each other about size or linking.")
    numbers = [one["N_PIG"] for one in telegrams]
    if len(set(numbers)) < len(numbers):
        raise InputError("one balise comes twice; give each balise once.")
    [(country, group, last_number, linked)] = heads
    inputs: dict[str, Cell | None] = {
        "telegram_group": identity(country, group),
        "telegram_link": "LINKED" if linked else "UNLINKED",
        "telegram_check": "PASSED",
        "telegram_total": last_number + 1,
        "telegram_read": len(_read(telegrams, last_number)),
        "telegram_first": numbers[0] + 1,
        "telegram_last": numbers[-1] + 1,
        "telegram_age_ms": age_ms,
        "telegram_since_mm": since_mm,
    }
    return {name: value for name, value in inputs.items() if value is not None}


def reflector_ahead(
    telegrams: Sequence[Mapping[str, Any]], passed: Literal["NOMINAL", "REVERSE"], *, nid_xuser: int
) -> dict[str, Cell]:
    """Return the inputs of the next reflector (RFL-5) from packet 44 of a group's telegrams; none if it tells of none.

    Give them in the cycle of `group_reading`. nid_xuser: the user whose data these are. InputError if the data are not those of
    `safeloc.railway.telegrams.next_reflector`, or the telegrams contradict each other.
    """
    packets = (one for telegram in telegrams for one in telegram["packets"])
    concerned = (one for one in packets if "Q_DIR" in one and concerns(one, passed))
    found = told_by(concerned, nid_xuser=nid_xuser)
    if found is None:
        return {}
    inputs = {"telegram_reflector_mm": found.reflector_mm, "telegram_search_mm": found.search_mm}
    return {name: value for name, value in inputs.items() if value is not None}


def _read(telegrams: Sequence[Mapping[str, Any]], last_number: int) -> set[int]:
    """Return the numbers of the balises whose telegram is known, from themselves or from a duplicate."""
    found = {one["N_PIG"] for one in telegrams}
    for one in telegrams if len(telegrams) > 1 else ():
        beside = one["N_PIG"] + {_BEFORE_NEXT: 1, _AFTER_PREVIOUS: -1}.get(one["M_DUP"], 0)
        if 1 <= beside <= last_number:
            found.add(beside)
    return found
