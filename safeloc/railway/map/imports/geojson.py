"""Imports track networks as GeoJSON: lines are edges with geodesic lengths, points of type `netrelation` connect ends.

A relation names two elements, one end of each (0 begin, 1 end), and whether vehicles can run from one to the other.
Coordinates are longitude and latitude (RFC 7946); lengths are those of the geodesics on WGS 84, without heights.
"""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path
from typing import Any

from safeloc.errors import InputError
from safeloc.railway.map.elements import Geometry, TrackEdge
from safeloc.railway.map.imports.building import made, missing, within
from safeloc.railway.map.imports.json_text import mapping, others, read_object, required, sequence, text
from safeloc.railway.map.imports.lengths import decimal
from safeloc.railway.map.imports.notes import Imported, Note
from safeloc.railway.map.imports.topology import End, Joined, Naming, Relation, join
from safeloc.railway.map.model import Line

Point = tuple[float, float]
_PASSABLE = {"both": True, "none": False, "ab": True, "ba": True}
_RELATION = ("id", "type", "netelementA", "netelementB", "positionOnA", "positionOnB", "navigability")
_MEETING_LIMIT_M = 1.0
"""Greatest distance between two ends that meet; if they lie farther apart, the file contradicts itself."""
_BRANCH_M = 30.0
"""Length of the branches over which left and right are determined."""


@dataclass(frozen=True)
class Track:
    """A LineString of the file."""

    id: str
    place: str
    points: tuple[Point, ...]


@dataclass(frozen=True)
class Feature:
    """A feature with its place in the file."""

    place: str
    properties: dict[str, Any]
    kind: str
    coordinates: list[Any]


def read_geojson(path: Path, *, name: str | None = None, version: str | None = None) -> Imported:
    """Return the network in a GeoJSON file.

    name, version  of the line; by default the file's name, and "1"
    Raises InputError with the feature for anything wrong in it; EngineError without pyproj.
    """
    notes: list[Note] = []
    with within(path):
        return _imported(read_features(path, notes), name or path.stem, version or "1", path.name, notes)


def _imported(features: Sequence[Feature], name: str, version: str, source: str, notes: list[Note]) -> Imported:
    tracks = _tracks(features, notes)
    relations = list(_relations(features, tracks, notes))
    joined = join(list(tracks), relations, _naming(tracks))
    notes += joined.notes
    _relations_apart(relations, tracks, notes)
    notes += _open_ends(joined)
    lengths = _lengths_mm(tracks)
    line = made(
        Line,
        "network",
        name=name,
        version=version,
        source=source,
        nodes=joined.nodes,
        edges=tuple(_edge(track, lengths[track.id], joined) for track in tracks.values()),
        switches=joined.switches,
        crossings=joined.crossings,
    )
    return Imported(line, tuple(notes))


# ------------------------------------------------------------------ features


def read_features(path: Path, notes: list[Note]) -> list[Feature]:
    """Return the features of a FeatureCollection in degrees. InputError for anything else."""
    collection = read_object(path)
    if collection.get("type") != "FeatureCollection":
        raise InputError(f"expected a FeatureCollection, got {collection.get('type')!r}.")
    if "crs" in collection:
        raise InputError("names a coordinate system; GeoJSON is longitude and latitude on WGS 84 (RFC 7946).")
    for name in others(collection, ("type", "features", "properties", "bbox", "name")):
        notes.append(Note("not understood", "collection", f"member {name!r}"))
    if collection.get("properties"):
        notes.append(Note("not carried over", "collection", "its properties"))
    listed = sequence(required(collection, "features", "collection"), "features")
    return [_feature(f"feature {index}", found) for index, found in enumerate(listed, 1)]


def _feature(place: str, found: object) -> Feature:
    feature = mapping(found, place)
    properties = mapping(feature.get("properties") or {}, f"{place}: properties")
    named = properties.get("id", properties.get("netelement_id"))
    if named is not None:
        place = f"{place} {named!r}"
    if feature.get("type") != "Feature":
        raise InputError(f"{place}: expected a Feature, got {feature.get('type')!r}.")
    geometry = mapping(feature.get("geometry") or {}, f"{place}: geometry")
    return Feature(place, properties, str(geometry.get("type")), geometry.get("coordinates") or [])


def _point(found: object, place: str) -> Point:
    """Return a position as (longitude, latitude) in degrees. InputError for anything else."""
    numbers = sequence(found, f"{place}: position")
    if len(numbers) < 2:
        raise InputError(f"{place}: a position has a longitude and a latitude.")
    longitude, latitude = (float(decimal(number, f"{place}: position")) for number in numbers[:2])
    if not (-180 <= longitude <= 180 and -90 <= latitude <= 90):
        raise InputError(f"{place}: {longitude}, {latitude} is no longitude and latitude in degrees.")
    return longitude, latitude


def _tracks(features: Sequence[Feature], notes: list[Note]) -> dict[str, Track]:
    tracks: dict[str, Track] = {}
    for feature in features:
        if feature.kind == "LineString":
            track = _track(feature, notes)
            if track.id in tracks:
                raise InputError(f"{feature.place}: the identity is that of an earlier feature.")
            tracks[track.id] = track
        elif feature.properties.get("type") != "netrelation":
            what = f"{feature.kind} of type {feature.properties.get('type')!r}"
            notes.append(Note("not understood", feature.place, what))
    if not tracks:
        raise InputError("the file has no LineString: there is no track in it.")
    return tracks


def _track(feature: Feature, notes: list[Note]) -> Track:
    identity = text(required(feature.properties, "id", feature.place), f"{feature.place}: id")
    positions = sequence(feature.coordinates, f"{feature.place}: coordinates")
    for name in others(feature.properties, ("id",)):
        notes.append(Note("not understood", feature.place, f"property {name!r}"))
    if any(isinstance(position, list) and len(position) > 2 for position in positions):
        notes.append(Note("not carried over", feature.place, "heights; lengths are those on the ellipsoid"))
    points = tuple(_point(position, feature.place) for position in positions)
    if len(set(points)) < 2:
        raise InputError(f"{feature.place}: a track has at least two points.")
    return Track(identity, feature.place, points)


# ------------------------------------------------------------------ relations


def _relations(features: Sequence[Feature], tracks: Mapping[str, Track], notes: list[Note]) -> Iterator[Relation]:
    for feature in features:
        if feature.properties.get("type") == "netrelation" and feature.kind != "LineString":
            yield _relation(feature, tracks, notes)


def _relation(feature: Feature, tracks: Mapping[str, Track], notes: list[Note]) -> Relation:
    for name in others(feature.properties, _RELATION):
        notes.append(Note("not understood", feature.place, f"property {name!r}"))
    identity = text(required(feature.properties, "id", feature.place), f"{feature.place}: id")
    navigability = text(
        required(feature.properties, "navigability", feature.place), f"{feature.place}: navigability"
    ).lower()
    if navigability not in _PASSABLE:
        raise InputError(f"{feature.place}: navigability must be both, none, AB or BA, not {navigability!r}.")
    if navigability in ("ab", "ba"):
        notes.append(Note("not carried over", feature.place, "one way only; the map allows both ways"))
    one, other = (_end(feature, side, tracks) for side in "AB")
    return Relation(identity, one, other, _PASSABLE[navigability], feature.place)


def _end(feature: Feature, side: str, tracks: Mapping[str, Track]) -> End:
    name = text(required(feature.properties, f"netelement{side}", feature.place), f"{feature.place}: netelement{side}")
    if name not in tracks:
        raise InputError(f"{feature.place}: netelement{side}: there is no element {name!r}.")
    position = required(feature.properties, f"positionOn{side}", feature.place)
    if isinstance(position, bool) or position not in (0, 1):
        raise InputError(f"{feature.place}: positionOn{side} must be 0 or 1, not {position!r}.")
    return name, int(position)


def _relations_apart(relations: Sequence[Relation], tracks: Mapping[str, Track], notes: list[Note]) -> None:
    """Note relations whose ends do not lie at the same place."""
    geod = _ellipsoid()
    for relation in relations:
        one, other = _coordinates(tracks, relation.one), _coordinates(tracks, relation.other)
        apart_m = geod.inv(*one, *other)[2]
        if apart_m > _MEETING_LIMIT_M:
            remark = f"ends that meet lie {apart_m:.1f} m apart; taken as meeting"
            notes.append(Note("doubtful", relation.place, remark))


# ------------------------------------------------------------------ edges and nodes


def _lengths_mm(tracks: Mapping[str, Track]) -> dict[str, int]:
    """Return geodesic lengths, to the nearest mm."""
    geod = _ellipsoid()
    return {track.id: round(geod.line_length(*zip(*track.points, strict=True)) * 1000) for track in tracks.values()}


def _ellipsoid() -> Any:
    try:
        from pyproj import Geod
    except ImportError as error:
        raise missing("pyproj", "measuring GeoJSON tracks") from error
    return Geod(ellps="WGS84")


def _edge(track: Track, length_mm: int, joined: Joined) -> TrackEdge:
    return made(
        TrackEdge,
        track.place,
        id=track.id,
        from_node=joined.node_of[track.id, 0],
        to_node=joined.node_of[track.id, 1],
        length_mm=length_mm,
        geometry=made(Geometry, track.place, points=track.points),
    )


def _open_ends(joined: Joined) -> Iterator[Note]:
    count = Counter(joined.node_of.values())
    for (edge, end), node in joined.node_of.items():
        if count[node] == 1:
            where = f"{'end' if end else 'beginning'} of {edge!r}"
            yield Note("assumed", where, "no relation there: the track ends, whether at a buffer stop or not")


def _naming(tracks: Mapping[str, Track]) -> Naming:
    return Naming(
        _node_name, lambda stem, one, other: _sides(tracks, stem, one, other), lambda end: _coordinates(tracks, end)
    )


def _node_name(ends: Sequence[End], meeting: Sequence[Relation]) -> str:
    """Name a node by the common prefix of its relations' identities, up to a bar; otherwise by its first end."""
    names = {relation.id.partition("|")[0] for relation in meeting if "|" in relation.id}
    if len(names) == 1:
        return names.pop()
    return f"{ends[0][0]} {'end' if ends[0][1] else 'begin'}"


def _coordinates(tracks: Mapping[str, Track], end: End) -> Point:
    return tracks[end[0]].points[-1 if end[1] else 0]


def _sides(tracks: Mapping[str, Track], stem: End, one: End, other: End) -> tuple[End, End] | None:
    """Return left and right branch, from their courses; None if both have the same direction."""
    centre = _coordinates(tracks, stem)
    reach = min(_BRANCH_M, *(_length_m(_from_end(tracks, end)) for end in (one, other)))
    ax, ay = _plane(centre, _after(_from_end(tracks, one), reach))
    bx, by = _plane(centre, _after(_from_end(tracks, other), reach))
    turned = ax * by - ay * bx
    if abs(turned) < 1e-3 * reach:
        return None
    return (other, one) if turned > 0 else (one, other)


def _from_end(tracks: Mapping[str, Track], end: End) -> tuple[Point, ...]:
    points = tracks[end[0]].points
    return points[::-1] if end[1] else points


def _after(points: Sequence[Point], reach_m: float) -> Point:
    """Return the point at this distance along the course."""
    left = reach_m
    for before, after in pairwise(points):
        step = math.hypot(*_plane(before, after))
        if step >= left and step > 0:
            share = left / step
            return before[0] + share * (after[0] - before[0]), before[1] + share * (after[1] - before[1])
        left -= step
    return points[-1]


def _length_m(points: Sequence[Point]) -> float:
    return sum(math.hypot(*_plane(before, after)) for before, after in pairwise(points))


def _plane(origin: Point, to: Point) -> Point:
    """Return metres east and north; accurate enough over some tens of metres."""
    metres_per_degree = 111_320.0
    scale = math.cos(math.radians(origin[1]))
    return (to[0] - origin[0]) * metres_per_degree * scale, (to[1] - origin[1]) * metres_per_degree
