"""Places on the track, their kilometres, and distances along an edge in a direction of travel."""

from __future__ import annotations

from dataclasses import dataclass

from safeloc.railway.map.elements import Direction, KilometrePoint, TrackEdge


@dataclass(frozen=True, order=True)
class Place:
    """A place on the track: a position in mm along an edge."""

    edge: str
    position_mm: int


def kilometre_mm(edge: TrackEdge, position_mm: int) -> tuple[str, int] | None:
    """Return the kilometre line and the kilometre, in mm, of a place; None without a kilometre reference."""
    point = _point(edge, position_mm)
    if point is None:
        return None
    run = position_mm - point.position_mm
    return point.line, point.kilometre_mm + (run if point.direction == "increasing" else -run)


def _point(edge: TrackEdge, position_mm: int) -> KilometrePoint | None:
    reached = [point for point in edge.kilometres if point.position_mm <= position_mm]
    return reached[-1] if reached else None


def kilometre_text(edge: TrackEdge, position_mm: int) -> str:
    """Return the kilometre of a place as `12.345678`, with six decimals (mm); empty without a kilometre reference."""
    found = kilometre_mm(edge, position_mm)
    if found is None:
        return ""
    line, millimetres = found
    sign, size = ("-" if millimetres < 0 else ""), abs(millimetres)
    text = f"{sign}{size // 1_000_000}.{size % 1_000_000:06}"
    return f"{line} {text}".strip()


def along(direction: Direction, length_mm: int, position_mm: int) -> int:
    """Return the distance run from the start of an edge to a place on it, for a vehicle that runs in `direction`."""
    return position_mm if direction == "increasing" else length_mm - position_mm
