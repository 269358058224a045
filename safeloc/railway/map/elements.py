"""Elements of a line: frozen records, with positions in whole mm along a track edge (RFL-4).

A track edge runs from one node to another; its position 0 is at `from_node`, `length_mm` at `to_node`. `increasing`
is the direction of growing position, `decreasing` the other one. An object's `direction` is the direction of travel
for which it is intended. Every identity is unique within its kind.
"""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import ConfigDict, Field

from safeloc.config import Config

Direction = Literal["increasing", "decreasing"]
Identity = Annotated[str, Field(min_length=1, max_length=200, pattern=r"^\S(.*\S)?$")]
Position = Annotated[int, Field(ge=0, le=10**10, json_schema_extra={"unit": "mm"})]
Length = Annotated[int, Field(gt=0, le=10**10, json_schema_extra={"unit": "mm"})]
Signed = Annotated[int, Field(ge=-(10**10), le=10**10, json_schema_extra={"unit": "mm"})]
ModelName = Annotated[str, Field(pattern=r"^[A-Za-z][A-Za-z0-9_-]*$", max_length=40)]
Coordinate = Annotated[float, Field(allow_inf_nan=False)]


def opposite(direction: Direction) -> Direction:
    """Return the other direction along an edge."""
    return "decreasing" if direction == "increasing" else "increasing"


class Element(Config):
    """Base class of all elements of the map."""

    model_config = ConfigDict(frozen=True, extra="forbid", strict=True)


class OnEdge(Element):
    """An element at one place of the track."""

    id: Identity
    edge: Identity
    position_mm: Position


class Stretch(Element):
    """A piece of one edge, from_mm < to_mm (along a fibre also against the edge: from_mm > to_mm)."""

    edge: Identity
    from_mm: Position
    to_mm: Position


# ------------------------------------------------------------------ track


class Node(Element):
    """A point where edges meet or end. At a `seam` the next part of the map continues the track."""

    id: Identity
    kind: Literal["track", "buffer_stop", "border", "seam"] = "track"
    longitude_deg: Coordinate | None = None
    latitude_deg: Coordinate | None = None


class KilometrePoint(Element):
    """From `position_mm` on, the kilometre of line `line` counts up or down from `kilometre_mm`."""

    position_mm: Position = 0
    kilometre_mm: Signed
    direction: Direction = "increasing"
    line: str = ""


class Geometry(Element):
    """The edge's course in the plane, from `from_node` to `to_node`.

    crs     "EPSG:4326" means (longitude, latitude) in degrees; anything else a projected system in metres
    points  at least two pairs of coordinates
    """

    crs: str = "EPSG:4326"
    points: tuple[tuple[Coordinate, Coordinate], ...] = Field(min_length=2)


class TrackEdge(Element):
    """A piece of track without branches. `travel` is its regular direction of travel."""

    id: Identity
    from_node: Identity
    to_node: Identity
    length_mm: Length
    travel: Literal["both", "increasing", "decreasing"] = "both"
    track: str = ""
    kilometres: tuple[KilometrePoint, ...] = ()
    geometry: Geometry | None = None


class Switch(Element):
    """Three edges at a node: vehicles run between `stem` and `left` or `right`, never between left and right."""

    id: Identity
    node: Identity
    stem: Identity
    left: Identity
    right: Identity


class Crossing(Element):
    """A diamond crossing or a slip: the pairs of edges at the node between which vehicles may run."""

    id: Identity
    node: Identity
    movements: tuple[tuple[Identity, Identity], ...] = Field(min_length=1)


# ------------------------------------------------------------------ references for the position


class Balise(Element):
    """One balise of a group. The first of the group's list is number 1."""

    position_mm: Position


class TelegramReflector(Element):
    """The announcement of a reflector ahead in a balise telegram (RFL-9), for vehicles travelling in `direction`.

    distance_mm     from the group's position to the reflector
    search_from_mm  distance behind the group at which the search starts; None: not given
    """

    direction: Direction
    reflector: Identity
    distance_mm: Length
    search_from_mm: Position | None = None


class BaliseGroup(Element):
    """One to eight balises on one edge; the group's position is that of balise number 1.

    identity             NID_BG; `country` is NID_C
    linked               linking announces the group
    nominal_direction    for a single balise, whose order gives no direction: as announced by linking; None: unknown
    location_accuracy_mm Q_LOCACC as given by linking; None: the national value applies
    duplicate_of         the group with the same messages
    """

    id: Identity
    edge: Identity
    identity: int = Field(ge=0, le=16_383)
    country: int = Field(default=0, ge=0, le=1_023)
    balises: tuple[Balise, ...] = Field(min_length=1, max_length=8)
    linked: bool = True
    nominal_direction: Direction | None = None
    location_accuracy_mm: int | None = Field(default=None, ge=0, le=63_000, json_schema_extra={"unit": "mm"})
    duplicate_of: Identity | None = None
    telegram_reflectors: tuple[TelegramReflector, ...] = ()

    @property
    def position_mm(self) -> int:
        """Position of balise number 1 along the edge."""
        return self.balises[0].position_mm

    @property
    def orientation(self) -> Direction | None:
        """The nominal direction, from the order of the balises or else from linking; None if neither gives it."""
        if len(self.balises) == 1:
            return self.nominal_direction
        return "increasing" if self.balises[0].position_mm < self.balises[1].position_mm else "decreasing"


class Marker(OnEdge):
    """A position marker beside the track (MRK-1), which readers at both ends of a vehicle read, in either direction of travel.

    identity     number that the readers read; balise groups have numbers of their own
    accuracy_mm  it lies within so much of its place on the map; None: the vehicle's figure for markers without an own one
    """

    identity: int = Field(ge=1, le=1_000_000)
    accuracy_mm: int | None = Field(default=None, ge=0, le=63_000, json_schema_extra={"unit": "mm"})


class Reflector(OnEdge):
    """A passive radar reflector (RFL-3, RFL-10).

    direction          direction of travel of the vehicles that see it ahead
    lateral_offset_mm  from the track's axis; positive to the right, seen in direction of travel
    view_from_mm       distance before the reflector where the view zone begins, along the track
    view_to_mm         distance before the reflector where it ends; nearer, the radar cannot measure it
    """

    model: ModelName
    direction: Direction
    lateral_offset_mm: Signed = 0
    view_from_mm: Length
    view_to_mm: Position


class StopPoint(OnEdge):
    """A point for a precise stop of the vehicle's front (RFL-D7); the reflector is visible from there.

    standstill_distance_mm  from the stopped front end to the reflector
    window_before_mm        greatest distance of a valid stop before the position; window_after_mm: beyond it
    """

    direction: Direction
    reflector: Identity
    standstill_distance_mm: Length
    window_before_mm: Position
    window_after_mm: Position
    platform: str = ""


class Signal(OnEdge):
    """A signal or a stop board for vehicles that run in `direction`."""

    direction: Direction
    kind: str = "main"


class AxleCounter(OnEdge):
    """A counting point of an axle counter."""


# ------------------------------------------------------------------ fibre


class FibrePoint(Element):
    """A surveyed point: the place on the track at `fibre_mm` of cable."""

    fibre_mm: Position
    edge: Identity
    position_mm: Position


class ReflectingPoint(Element):
    """A known disturbance of the fibre that always reflects (FWG-5)."""

    id: Identity
    fibre_mm: Position


class Fibre(Element):
    """An optical fibre along the track.

    length_mm             cable from the coupler to the end, longer than the track because of slack
    path                  the edges along which it runs, in order; from_mm > to_mm if it runs against the edge
    map_points            surveyed points in order of the cable; between them the slack is spread evenly
    refractive_index_ppm  index of refraction in millionths
    position_code         its localization sections are a code that gives the place without counting (FWG-10)
    """

    id: Identity
    length_mm: Length
    path: tuple[Stretch, ...] = Field(min_length=1)
    map_points: tuple[FibrePoint, ...] = Field(min_length=2)
    reflecting_points: tuple[ReflectingPoint, ...] = ()
    absorber_at_end: bool = True
    position_code: bool = False
    refractive_index_ppm: int = Field(default=1_468_000, gt=1_000_000, lt=3_000_000, json_schema_extra={"unit": "ppm"})


class LocalizationSection(Element):
    """A piece of fibre that reacts to vibration more (`raises`) or less (`lowers`) than its neighbours (FWG-1)."""

    id: Identity
    fibre: Identity
    from_fibre_mm: Position
    to_fibre_mm: Position
    effect: Literal["raises", "lowers"]


# ------------------------------------------------------------------ sections and properties of the track


class DetectionSection(Element):
    """A section whose occupation is detected by axle counters."""

    id: Identity
    axle_counters: tuple[Identity, ...] = Field(min_length=1)
    stretches: tuple[Stretch, ...] = Field(min_length=1)


class VirtualSection(Element):
    """A section whose occupation follows from reported positions; it may be part of a detection section."""

    id: Identity
    stretches: tuple[Stretch, ...] = Field(min_length=1)
    detection_section: Identity | None = None


class Tunnel(Element):
    """A tunnel: track without a view of the sky."""

    id: Identity
    stretches: tuple[Stretch, ...] = Field(min_length=1)


class SpeedLimit(Stretch):
    """The highest permitted speed, in both directions unless `direction` names one."""

    max_speed_mm_s: int = Field(gt=0, le=200_000, json_schema_extra={"unit": "mm/s"})
    direction: Direction | None = None


class Gradient(Stretch):
    """The gradient in direction of growing position, negative for a falling track. 1 per mille is 1000 ppm."""

    rise_ppm: int = Field(ge=-200_000, le=200_000, json_schema_extra={"unit": "ppm"})


class Curve(Stretch):
    """The radius at both ends, positive to the right in direction of growing position; None: straight.

    Between different radii the curvature changes evenly (a transition curve).
    """

    from_radius_mm: Signed | None = None
    to_radius_mm: Signed | None = None
