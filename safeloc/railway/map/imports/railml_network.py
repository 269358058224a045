"""The micro topology of a railML document: net elements with exact lengths and kilometres, and the relations of their ends."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from decimal import Decimal
from itertools import pairwise

from safeloc.errors import InputError
from safeloc.railway.map.elements import KilometrePoint
from safeloc.railway.map.imports.building import made
from safeloc.railway.map.imports.lengths import decimal, millimetres
from safeloc.railway.map.imports.notes import Note
from safeloc.railway.map.imports.railml_coordinates import Course, coordinate_systems, course
from safeloc.railway.map.imports.railml_xml import Element
from safeloc.railway.map.imports.topology import End, Relation

_METRES_PER_UNIT = {"m": Decimal(1), "km": Decimal(1000)}
_PASSABLE = {"both": True, "none": False, "ab": True, "ba": True}


@dataclass(frozen=True)
class NetElement:
    """A net element of the micro level.

    length_m   length as the document gives it, exact
    measures   linear positioning system -> (intrinsic coordinate, kilometre in metres), in order
    course     coordinates from its beginning to its end; None if the document gives none
    """

    element: Element
    length_m: Decimal
    measures: Mapping[str, tuple[tuple[Decimal, Decimal], ...]]
    course: Course | None

    @property
    def id(self) -> str:
        """The identity of the net element."""
        return self.element.need("id")

    @property
    def length_mm(self) -> int:
        """The length to the nearest mm."""
        return millimetres(self.length_m)[0]


@dataclass(frozen=True)
class Network:
    """Net elements of the micro level by identity, the relations between them, and identities of the other levels."""

    elements: Mapping[str, NetElement]
    relations: tuple[Relation, ...]
    elsewhere: frozenset[str]


def read_network(root: Element, infrastructure: Element, notes: list[Note]) -> Network:
    """Return the micro topology. InputError for missing lengths and ends, and for unknown references."""
    units, systems = linear_units(root), coordinate_systems(root)
    everything = _by_identity(infrastructure.all("topology", "netElements", "netElement"))
    micro = _micro(infrastructure, everything, notes)
    for identity, element in everything.items():
        if identity not in micro:
            element.skip()
            notes.append(Note("not carried over", element.place, "net element of a coarser level"))
    tracks = _track_lengths(infrastructure)
    elements = {
        identity: _net_element(everything[identity], units, systems, tracks, notes)
        for identity in everything
        if identity in micro
    }
    if not elements:
        raise InputError(f"{infrastructure.place}: topology/netElements holds no net element of the micro level.")
    relations = tuple(_relations(infrastructure, elements, frozenset(everything), notes))
    _references(infrastructure, frozenset(everything))
    return Network(elements, relations, frozenset(everything) - frozenset(elements))


def _by_identity(found: list[Element]) -> dict[str, Element]:
    known: dict[str, Element] = {}
    for element in found:
        identity = element.need("id")
        if identity in known:
            raise InputError(f"{element.place}: the identity was given in line {known[identity].line} already.")
        known[identity] = element
    return known


def _micro(infrastructure: Element, everything: Mapping[str, Element], notes: list[Note]) -> set[str]:
    """Return the net elements of the micro level: those so named by a network, else those that do not collect others."""
    named = set()
    for level in infrastructure.all("topology", "networks", "network", "level"):
        resources = [resource.need("ref") for resource in level.all("networkResource")]
        if (level.get("descriptionLevel") or "").lower() == "micro":
            named |= set(resources)
    if named & set(everything):
        return named & set(everything)
    remark = "no network names the micro level; taken are all net elements that are no collection of others"
    notes.append(Note("assumed", infrastructure.place, remark))
    collections = ("elementCollectionOrdered", "elementCollectionUnordered")
    return {one for one, element in everything.items() if not any(element.all(tag) for tag in collections)}


# ------------------------------------------------------------------ lengths and kilometres


def linear_units(root: Element) -> dict[str, Decimal]:
    """Return the metres per unit of each linear positioning system."""
    found = {}
    for system in root.all("common", "positioning", "linearPositioningSystems", "linearPositioningSystem"):
        unit = (system.get("units") or "m").lower()
        if unit not in _METRES_PER_UNIT:
            raise InputError(f"{system.place}: units {unit!r} are not known; use m or km.")
        found[system.need("id")] = _METRES_PER_UNIT[unit]
    return found


def _track_lengths(infrastructure: Element) -> dict[str, Element]:
    """Return for net elements the physical length of a track that covers exactly this element."""
    found: dict[str, Element] = {}
    for track in infrastructure.all("functionalInfrastructure", "tracks", "track"):
        pieces = track.all("linearLocation", "associatedNetElement")
        lengths = [one for one in track.all("length") if one.get("type") in (None, "physical")]
        parts = ("posBegin", "posEnd", "intrinsicCoordBegin", "intrinsicCoordEnd")
        if (
            len(pieces) == len(lengths) == 1
            and not any(pieces[0].get(name) for name in parts)
            and not pieces[0].children
        ):
            found[pieces[0].need("netElementRef")] = lengths[0]
    return found


def _net_element(
    element: Element,
    units: Mapping[str, Decimal],
    systems: Mapping[str, str],
    tracks: Mapping[str, Element],
    notes: list[Note],
) -> NetElement:
    measures, way = _measures(element, units), _course(element, systems, notes)
    length_m = _length(
        element, notes, lambda: _unstated_length(element, measures, tracks.get(element.need("id")), way, notes)
    )
    if way is not None and way.contradicts(length_m):
        remark = f"{length_m} m long, but {way.length_m} m by its coordinates; the former is taken"
        notes.append(Note("doubtful", element.place, remark))
    rounded, exact = millimetres(length_m)
    if not exact:
        notes.append(Note("rounded", element.place, f"length {length_m} m to {rounded} mm"))
    return NetElement(element, length_m, measures, way)


def _course(element: Element, systems: Mapping[str, str], notes: list[Note]) -> Course | None:
    """Return the course, or None with a note: wrong coordinates are no reason to refuse a net element with a length."""
    try:
        return course(element, systems, notes)
    except InputError as error:
        reason = str(error).removeprefix(f"{element.place}: ").rstrip(".")
        notes.append(Note("not carried over", element.place, f"its coordinates: {reason}"))
        return None


def _length(element: Element, notes: list[Note], unstated: Callable[[], Decimal]) -> Decimal:
    """Return the attribute, or what `unstated` finds. A stated length of 0 counts as none: plans state it for every element."""
    stated = element.get("length")
    length_m = None if stated is None else decimal(stated, f"{element.place}: length")
    if length_m is not None and length_m < 0:
        raise InputError(f"{element.place}: its length {length_m} m must be positive.")
    if length_m:
        return length_m
    found = unstated()
    if length_m is not None:
        notes.append(Note("doubtful", element.place, f"a stated length of 0; taken is {found} m"))
    return found


def _unstated_length(
    element: Element,
    measures: Mapping[str, tuple[tuple[Decimal, Decimal], ...]],
    of_track: Element | None,
    way: Course | None,
    notes: list[Note],
) -> Decimal:
    """Return the kilometres between both ends, else the length of the track that is this net element, else that by coordinates."""
    for points in measures.values():
        if points[0][0] == 0 and points[-1][0] == 1 and points[0][1] != points[-1][1]:
            return abs(points[-1][1] - points[0][1])
    if of_track is not None:
        notes.append(Note("assumed", element.place, f"its length is that of its track, line {of_track.line}"))
        return decimal(of_track.need("value"), f"{of_track.place}: value")
    if way is not None and way.length_m > 0:
        points_count = len(way.geometry.points)
        notes.append(
            Note("assumed", element.place, f"its length is that of straight pieces between {points_count} coordinates")
        )
        return way.length_m
    raise InputError(
        f"{element.place}: has no length: no attribute 'length' above 0, no kilometres or coordinates at both ends, no track. "
        "A plan without lengths is no map: export it with lengths, or add them from the survey."
    )


def _measures(element: Element, units: Mapping[str, Decimal]) -> dict[str, tuple[tuple[Decimal, Decimal], ...]]:
    found: dict[str, list[tuple[Decimal, Decimal]]] = {}
    for system in element.all("associatedPositioningSystem"):
        for point in system.all("intrinsicCoordinate"):
            share = intrinsic(point, "intrinsicCoord")
            for linear in point.all("linearCoordinate"):
                name = linear.need("positioningSystemRef")
                found.setdefault(name, []).append((share, measure(linear, units)))
    return {name: tuple(sorted(points)) for name, points in found.items()}


def intrinsic(element: Element, name: str) -> Decimal:
    """Return an intrinsic coordinate, 0..1."""
    share = decimal(element.need(name), f"{element.place}: {name}")
    if not 0 <= share <= 1:
        raise InputError(f"{element.place}: {name} {share} is outside 0..1.")
    return share


def measure(linear: Element, units: Mapping[str, Decimal]) -> Decimal:
    """Return the kilometre of a linear coordinate, in metres."""
    system = linear.need("positioningSystemRef")
    if system not in units:
        raise InputError(f"{linear.place}: there is no linearPositioningSystem {system!r}.")
    return decimal(linear.need("measure"), f"{linear.place}: measure") * units[system]


def kilometres(net: NetElement, notes: list[Note]) -> tuple[KilometrePoint, ...]:
    """Return the kilometre points of the first positioning system; note the others, and points that contradict the length."""
    for other in list(net.measures)[1:]:
        notes.append(Note("not carried over", net.element.place, f"second kilometre line {other!r}"))
    for system, points in list(net.measures.items())[:1]:
        if len(points) < 2 or points[0][0] != 0:
            notes.append(
                Note("not carried over", net.element.place, "kilometres that are not given from its beginning on")
            )
            return ()
        return tuple(_kilometre_points(net, system, points, notes))
    return ()


def _kilometre_points(
    net: NetElement, system: str, points: tuple[tuple[Decimal, Decimal], ...], notes: list[Note]
) -> Iterator[KilometrePoint]:
    for (share, here), (next_share, there) in pairwise(points):
        track, counted = (next_share - share) * net.length_m, abs(there - here)
        if track != counted:
            remark = f"{counted} m of kilometres on {track} m of track; counted from its lower end on"
            notes.append(Note("doubtful", net.element.place, remark))
        yield made(
            KilometrePoint,
            net.element.place,
            position_mm=millimetres(share * net.length_m)[0],
            kilometre_mm=millimetres(here)[0],
            direction="increasing" if there >= here else "decreasing",
            line=system,
        )


# ------------------------------------------------------------------ relations


def _relations(
    infrastructure: Element, elements: Mapping[str, NetElement], everything: frozenset[str], notes: list[Note]
) -> Iterator[Relation]:
    for element in _by_identity(infrastructure.all("topology", "netRelations", "netRelation")).values():
        names = [_side(element, side, everything) for side in ("elementA", "elementB")]
        if not all(name in elements for name in names):
            element.skip()
            notes.append(Note("not carried over", element.place, "net relation of a coarser level"))
            continue
        one, other = (_end(element, *pair) for pair in zip(names, ("positionOnA", "positionOnB"), strict=True))
        passable = _passable(element, notes)
        yield Relation(element.need("id"), one, other, passable, element.place)


def _references(infrastructure: Element, everything: frozenset[str]) -> None:
    """Check that net elements and networks refer to existing net relations and net elements."""
    relations = {one.need("id") for one in infrastructure.all("topology", "netRelations", "netRelation")}
    for one in infrastructure.all("topology", "netElements", "netElement", "relation"):
        if one.need("ref") not in relations:
            raise InputError(f"{one.place}: there is no netRelation {one.need('ref')!r}.")
    known = relations | everything
    for one in infrastructure.all("topology", "networks", "network", "level", "networkResource"):
        if one.need("ref") not in known:
            raise InputError(f"{one.place}: there is no net element or relation {one.need('ref')!r}.")


def _side(relation: Element, tag: str, everything: frozenset[str]) -> str:
    side = relation.one(tag)
    if side is None:
        raise InputError(f"{relation.place}: {tag} is missing.")
    name = side.need("ref")
    if name not in everything:
        raise InputError(f"{relation.place}: {tag}: there is no netElement {name!r}.")
    return name


def _end(relation: Element, name: str, attribute: str) -> End:
    side = relation.need(attribute)
    if side not in ("0", "1"):
        raise InputError(f"{relation.place}: {attribute} must be 0 or 1, not {side!r}.")
    return name, int(side)


def _passable(relation: Element, notes: list[Note]) -> bool:
    navigability = relation.need("navigability").lower()
    if navigability not in _PASSABLE:
        raise InputError(f"{relation.place}: navigability must be Both, None, AB or BA, not {navigability!r}.")
    if navigability in ("ab", "ba"):
        notes.append(Note("not carried over", relation.place, "one way only; the map allows both ways"))
    return _PASSABLE[navigability]
