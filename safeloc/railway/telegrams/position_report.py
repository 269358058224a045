"""Position reports: packets 0 and 1 from an interval of the front end, rounded so that they promise no more than it does.

Coordinates grow along the route. The reported position is the estimated front end as a distance from the last relevant balise
group (LRBG). Seen in the direction in which the train faces, its true front end lies at most L_DOUBTUNDER ahead of that and at
most L_DOUBTOVER behind (SUBSET-026 3.6.4.4); both include the location accuracy of the group.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

from safeloc.errors import InputError
from safeloc.language.units import MM_PER_M
from safeloc.railway.telegrams.layout import Values
from safeloc.railway.telegrams.variables import (
    FASTEST_KM_H,
    SPEED_STEP_KM_H,
    UNKNOWN_GROUP,
    UNKNOWN_LENGTH,
    group_identity,
    length_mm,
    scale_mm,
)

Sense = Literal["along", "against"]
REVERSE, NOMINAL, UNKNOWN = 0, 1, 2
"""Q_DIRLRBG, Q_DLRBG, Q_DIRTRAIN: as seen in the nominal direction of the LRBG."""
NO_INTEGRITY, CONFIRMED_BY_DEVICE, CONFIRMED_BY_DRIVER, INTEGRITY_LOST = range(4)
"""Q_LENGTH."""
_SCALES = (0, 1, 2)
_S_PER_H = 3_600


@dataclass(frozen=True)
class Lrbg:
    """The last relevant balise group, and how the route passes it.

    position_mm  place of its balise 1 along the route, as the interval was reckoned from
    sense        `along`: the route passes it in its nominal direction, `against`: in reverse; None: not known
    previous     country and number of the group before, for a group whose orientation only that gives (packet 1);
                 the direction from that group to this one then counts as nominal; it too is one marked as linked
    linked       the group is marked as linked (Q_LINK): an unlinked one is never the LRBG (SUBSET-026 3.6.2.2.2 a)
    """

    nid_c: int
    nid_bg: int
    position_mm: int
    sense: Sense | None
    previous: tuple[int, int] | None = None
    linked: bool = True


@dataclass(frozen=True)
class Front:
    """The interval of the train's front end, mm along the route, as the machines report it.

    faces  the direction in which the train's front is ahead
    """

    position_mm: int
    margin_above_mm: int
    margin_below_mm: int
    faces: Sense = "along"


@dataclass(frozen=True)
class Train:
    """The further data of a report.

    speed_mm_s       magnitude, rounded to the nearest 5 km/h
    moves            direction of movement along the route; None: not known
    q_length         state of the train's integrity; with a safe length where it is confirmed
    safe_length_mm   from the min safe rear end to the estimated front end
    nid_ntc          national system, at level NTC
    """

    speed_mm_s: int
    moves: Sense | None
    m_mode: int
    m_level: int
    q_length: int = NO_INTEGRITY
    safe_length_mm: int | None = None
    nid_ntc: int | None = None


def position_report(front: Front, lrbg: Lrbg, train: Train) -> Values:
    """Return packet 0, or packet 1 if the LRBG comes with a previous group, at the finest scale that holds all lengths.

    The position is rounded to the nearest unit, and both doubts are reckoned from it and rounded up. Raises InputError for
    negative margins, an unlinked group, a speed above 600 km/h, and lengths that no scale holds (327 km).
    """
    if not lrbg.linked:
        raise InputError(
            f"group {lrbg.nid_c}/{lrbg.nid_bg} is unlinked, which is never the LRBG; refer to the last linked group, or, where no "
            "position refers to one, send unknown_position_report."
        )
    if min(front.margin_above_mm, front.margin_below_mm) < 0:
        raise InputError("margins of an interval are not negative; a position that is not valid is not reported.")
    number = {"NID_PACKET": 0} if lrbg.previous is None else {"NID_PACKET": 1}
    previous = {} if lrbg.previous is None else {"NID_PRVLRBG": group_identity(*lrbg.previous)}
    return {
        **number,
        **_lengths(front, lrbg, train),
        "NID_LRBG": group_identity(lrbg.nid_c, lrbg.nid_bg),
        **previous,
        "Q_DIRLRBG": _seen(lrbg.sense, front.faces),
        "Q_DLRBG": _seen(lrbg.sense, "along" if front.position_mm >= lrbg.position_mm else "against"),
        "Q_LENGTH": train.q_length,
        "V_TRAIN": _speed(train.speed_mm_s),
        "Q_DIRTRAIN": _seen(lrbg.sense, train.moves),
        **_mode(train),
    }


def unknown_position_report(train: Train) -> Values:
    """Return packet 0 without an LRBG: the position is unknown, or refers only to an unlinked group (SUBSET-026 3.6.2.2.2.1).

    Raises InputError for a safe train length or a confirmed integrity, which comes with one, since that length counts from the front
    end; and for a speed above 600 km/h.
    """
    if train.safe_length_mm is not None or train.q_length in (CONFIRMED_BY_DEVICE, CONFIRMED_BY_DRIVER):
        raise InputError(
            "a confirmed integrity comes with a safe train length, which counts from the front end; a report of an unknown position "
            "has neither."
        )
    lengths = dict.fromkeys(("D_LRBG", "L_DOUBTOVER", "L_DOUBTUNDER"), UNKNOWN_LENGTH)
    return {
        "NID_PACKET": 0,
        "Q_SCALE": _SCALES[0],
        **lengths,
        "NID_LRBG": UNKNOWN_GROUP,
        **dict.fromkeys(("Q_DIRLRBG", "Q_DLRBG", "Q_DIRTRAIN"), UNKNOWN),
        "Q_LENGTH": train.q_length,
        "V_TRAIN": _speed(train.speed_mm_s),
        **_mode(train),
    }


def _mode(train: Train) -> Values:
    national = {} if train.nid_ntc is None else {"NID_NTC": train.nid_ntc}
    return {"M_MODE": train.m_mode, "M_LEVEL": train.m_level, **national}


def _seen(sense: Sense | None, direction: Sense | None) -> int:
    """Return a direction along the route as seen in the nominal direction of the group."""
    if sense is None or direction is None:
        return UNKNOWN
    return NOMINAL if sense == direction else REVERSE


def _speed(speed_mm_s: int) -> int:
    steps = round(abs(speed_mm_s) * _S_PER_H / (SPEED_STEP_KM_H * 1_000 * MM_PER_M))
    if steps * SPEED_STEP_KM_H > FASTEST_KM_H:
        raise InputError(f"{speed_mm_s} mm/s is above {FASTEST_KM_H} km/h, the highest speed of V_TRAIN.")
    return steps


def _lengths(front: Front, lrbg: Lrbg, train: Train) -> Values:
    for scale in _SCALES:
        found = _scaled(front, lrbg, train, scale)
        if max(found.values()) < UNKNOWN_LENGTH:
            return {"Q_SCALE": scale, **found}
    raise InputError(
        f"its lengths exceed {length_mm(UNKNOWN_LENGTH, _SCALES[-1]) // 10**6} km, the longest of a report."
    )


def _scaled(front: Front, lrbg: Lrbg, train: Train, scale: int) -> dict[str, int]:
    """Return the lengths in units of this scale."""
    unit = scale_mm(scale)
    offset = front.position_mm - lrbg.position_mm
    distance = (abs(offset) + unit // 2) // unit
    shift = (distance * unit if offset >= 0 else -distance * unit) - offset  # of the reported position, along the route
    above, below = front.margin_above_mm - shift, front.margin_below_mm + shift
    ahead, behind = (above, below) if front.faces == "along" else (below, above)
    found = {"D_LRBG": distance, "L_DOUBTOVER": _up(behind, unit), "L_DOUBTUNDER": _up(ahead, unit)}
    if train.safe_length_mm is not None:
        forward = shift if front.faces == "along" else -shift
        found["L_TRAININT"] = _up(train.safe_length_mm + forward, unit)
    return found


def _up(length: int, unit: int) -> int:
    return max(0, -(-length // unit))


def reported_interval(report: Values, lrbg: Lrbg) -> tuple[int, int]:
    """Return the least and the greatest coordinate of the front end that a report allows, mm along the route.

    Raises InputError where the report is of another group, or its direction or a length is unknown.
    """
    if report["NID_LRBG"] != group_identity(lrbg.nid_c, lrbg.nid_bg):
        raise InputError(f"the report refers to NID_LRBG {report['NID_LRBG']}, not to {lrbg.nid_c}/{lrbg.nid_bg}.")
    names = ("D_LRBG", "L_DOUBTOVER", "L_DOUBTUNDER")
    if lrbg.sense is None or UNKNOWN in (report["Q_DIRLRBG"], report["Q_DLRBG"]):
        raise InputError("the report does not say on which side of its group the train is.")
    if any(report[name] == UNKNOWN_LENGTH for name in names):
        raise InputError("a length of the report is unknown.")
    distance, over, under = (length_mm(report[name], report["Q_SCALE"]) for name in names)
    nominal = 1 if lrbg.sense == "along" else -1
    position = lrbg.position_mm + (nominal if report["Q_DLRBG"] == NOMINAL else -nominal) * distance
    facing = nominal if report["Q_DIRLRBG"] == NOMINAL else -nominal
    return (position - over, position + under) if facing > 0 else (position - under, position + over)
