"""A made-up receiver on a made-up junction: a map with courses, positions once a second, and the truth beside them.

`recordings/` beside it holds what this makes: `junction.toml`, `junction.csv` and `junction.nmea`, for `safeloc guard`.
The receiver calls every position FIXED, even if it is off the track, frozen, displaced, or wrong in speed.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from datetime import UTC, datetime, timedelta
from functools import reduce
from pathlib import Path
from random import Random

from safeloc.railway.map.elements import Geometry, Node, Switch, TrackEdge
from safeloc.railway.map.model import Line, sealed

FOLDER = Path(__file__).with_name("recordings")
BEGIN = datetime(2026, 3, 2, 8, 0, tzinfo=UTC)
LONGITUDE_DEG, LATITUDE_DEG = 9.0, 48.0
EARTH_AXIS_M, ECCENTRICITY_2 = 6_378_137.0, 0.00669437999014
STEM_MM, MAIN_MM, SIDE_MM = 1_000_000, 2_000_000, 900_000
SECONDS, FASTEST_MM_S, GAIN_MM_S2 = 150, 20_000, 500
_NOISE_MM = 2_500
_KNOT_MM_S = 514.444
FAULTS = {
    range(25, 37): "off track",
    range(52, 55): "displaced",
    range(70, 76): "frozen",
    range(92, 96): "no fix",
    range(110, 114): "wrong speed",
}
"""Faults of the receiver, by the seconds in which they act."""


@dataclass(frozen=True)
class ReceiverReport:
    """Report of the receiver at a second, and the true place of the vehicle along stem and main track."""

    second: int
    truth_mm: int
    place: tuple[float, float] | None
    speed_mm_s: int


def degrees(east_m: float, north_m: float) -> tuple[float, float]:
    """Return longitude and latitude of a place that lies so far east and north of the junction's west end."""
    sine = math.sin(math.radians(LATITUDE_DEG))
    across = EARTH_AXIS_M / math.sqrt(1 - ECCENTRICITY_2 * sine**2)
    along = across * (1 - ECCENTRICITY_2) / (1 - ECCENTRICITY_2 * sine**2)
    east = math.degrees(east_m / (across * math.cos(math.radians(LATITUDE_DEG))))
    return LONGITUDE_DEG + east, LATITUDE_DEG + math.degrees(north_m / along)


def junction() -> Line:
    """Return a line with a stem of 1 km, a main track straight on for 2 km, and a side track 40 m to the left."""
    side = ((1_000, 0), (1_200, 10), (1_400, 40), (1_900, 40))
    return sealed(
        Line(
            name="junction",
            version="1",
            nodes=(
                Node(id="west", kind="border"), Node(id="S1"), Node(id="east", kind="border"),
                Node(id="yard", kind="buffer_stop"),
            ),
            edges=(
                _edge("stem", "west", "S1", STEM_MM, ((0, 0), (1_000, 0))),
                _edge("main", "S1", "east", MAIN_MM, ((1_000, 0), (3_000, 0))),
                _edge("side", "S1", "yard", SIDE_MM, side),
            ),
            switches=(Switch(id="S1", node="S1", stem="stem", left="side", right="main"),),
        )
    )  # fmt: skip


def _edge(name: str, begin: str, end: str, length_mm: int, points: tuple[tuple[float, float], ...]) -> TrackEdge:
    course = Geometry(points=tuple((round(x, 9), round(y, 9)) for x, y in (degrees(*point) for point in points)))
    return TrackEdge(id=name, from_node=begin, to_node=end, length_mm=length_mm, geometry=course)


def receiver_reports(seed: int = 1) -> Iterator[ReceiverReport]:
    """Yield the receiver's reports second by second: the vehicle starts at 100 m, reaches 20 m/s and runs on along the main track."""
    random, frozen = Random(seed), (0.0, 0.0)
    for second in range(SECONDS):
        fault = next((name for when, name in FAULTS.items() if second in when), "")
        truth, speed = _motion_mm(second)
        place = (truth + random.uniform(-_NOISE_MM, _NOISE_MM)) / 1_000, random.uniform(-_NOISE_MM, _NOISE_MM) / 1_000
        frozen = frozen if fault == "frozen" else place
        yield ReceiverReport(
            second, truth, _shown(fault, place, frozen), speed + (9_000 if fault == "wrong speed" else 0)
        )


def _shown(fault: str, place: tuple[float, float], frozen: tuple[float, float]) -> tuple[float, float] | None:
    match fault:
        case "off track":
            return place[0] + 60, place[1] + 120
        case "displaced":
            return place[0] + 150, place[1]
        case "no fix":
            return None
        case _:
            return frozen


def _motion_mm(second: int) -> tuple[int, int]:
    """Return place (mm) and speed (mm/s) at a second."""
    until = FASTEST_MM_S // GAIN_MM_S2
    gaining, steady = min(second, until), max(0, second - until)
    return 100_000 + GAIN_MM_S2 * gaining**2 // 2 + FASTEST_MM_S * steady, GAIN_MM_S2 * gaining


def csv_text() -> str:
    """Return the run as CSV, with a line that is not finite, one that is repeated, one that is late, and one that is cut off."""
    lines = ["timestamp,longitude,latitude,speed_m_s,quality"]
    for one in receiver_reports():
        lines.append(_csv_line(one))
        match one.second:
            case 60:
                lines.append(lines[-1])
            case 62:
                lines.append(lines[-5])
            case 64:
                lines.append("2026-03-02T08:01:04.500,nan,nan,,FIXED")
            case 66:
                lines.append("2026-03-02T08:01:0")
    return "\n".join(lines) + "\n"


def _csv_line(one: ReceiverReport) -> str:
    when = (BEGIN + timedelta(seconds=one.second)).strftime("%Y-%m-%dT%H:%M:%S")
    if one.place is None:
        return f"{when},,,,NONE"
    x, y = degrees(*one.place)
    return f"{when},{x:.9f},{y:.9f},{one.speed_mm_s / 1_000},FIXED"


def nmea_text() -> str:
    """Return the run as RMC sentences."""
    return "".join(f"${body}*{_checksum(body):02X}\r\n" for body in map(_rmc, receiver_reports()))


def _rmc(one: ReceiverReport) -> str:
    when = BEGIN + timedelta(seconds=one.second)
    time, day = when.strftime("%H%M%S.00"), when.strftime("%d%m%y")
    if one.place is None:
        return f"GNRMC,{time},V,,,,,,,{day},,,N"
    x, y = degrees(*one.place)
    return f"GNRMC,{time},A,{_angle(y, 2)},N,{_angle(x, 3)},E,{one.speed_mm_s / _KNOT_MM_S:.3f},,{day},,,A"


def _angle(value: float, digits: int) -> str:
    """Return degrees and minutes as one number in the format of NMEA 0183."""
    return f"{int(value):0{digits}d}{(value - int(value)) * 60:010.7f}"


def _checksum(body: str) -> int:
    return reduce(lambda sum_, letter: sum_ ^ ord(letter), body, 0)
