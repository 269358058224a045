"""Objects along the track in a railML document: signals, axle counters, tunnels, speeds, ends of track, switches."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from decimal import Decimal

from safeloc.errors import InputError
from safeloc.railway.map.elements import AxleCounter, Direction, Node, Signal, SpeedLimit, Stretch, Tunnel
from safeloc.railway.map.imports.building import made
from safeloc.railway.map.imports.lengths import decimal
from safeloc.railway.map.imports.notes import Note
from safeloc.railway.map.imports.railml_network import Network
from safeloc.railway.map.imports.railml_places import Places
from safeloc.railway.map.imports.railml_xml import Element
from safeloc.railway.map.imports.topology import End, Naming, Relation

_MM_S_PER_KM_H = Decimal(1_000_000) / Decimal(3_600)
_SIGNAL_KINDS = {
    "isTrainMovementSignal": "main",
    "isAnnouncementSignal": "announcement",
    "isDangerSignal": "danger",
    "isEtcsSignal": "etcs",
    "isInformationSignal": "information",
    "isLevelCrossingSignal": "level crossing",
    "isMilepost": "milepost",
    "isSpeedSignal": "speed",
    "isStopPost": "stop",
}


def signals(functional: Element, places: Places) -> Iterator[Signal]:
    """Yield signals by their direction of travel; one for both directions becomes two."""
    return places.each(functional.all("signalsIS", "signalIS"), lambda element: _signals(element, places))


def _signals(element: Element, places: Places) -> Iterator[Signal]:
    kind = "+".join(name for tag, name in _SIGNAL_KINDS.items() if element.all(tag)) or "unknown"
    spot = places.spot(element)
    if spot is None:
        return
    if not spot.directions:
        places.notes.append(Note("not carried over", element.place, "signal without applicationDirection"))
    if len(spot.directions) > 1:
        places.notes.append(Note("assumed", element.place, "applies to both directions; carried over as two signals"))
    for direction in spot.directions:
        name = element.need("id") + (f" {direction}" if len(spot.directions) > 1 else "")
        fields = {"id": name, "edge": spot.edge, "position_mm": spot.position_mm, "direction": direction, "kind": kind}
        yield made(Signal, element.place, **fields)


def axle_counters(functional: Element, places: Places) -> Iterator[AxleCounter]:
    """Yield train detection elements of type axleCounter; note the others with their type."""
    found = functional.all("trainDetectionElements", "trainDetectionElement")
    return places.each(found, lambda element: _axle_counter(element, places))


def _axle_counter(element: Element, places: Places) -> Iterator[AxleCounter]:
    kind = element.get("type")
    if kind != "axleCounter":
        element.skip()
        places.notes.append(Note("not carried over", element.place, f"train detection element of type {kind}"))
        return
    spot = places.spot(element)
    if spot is not None:
        fields = {"id": element.need("id"), "edge": spot.edge, "position_mm": spot.position_mm}
        yield made(AxleCounter, element.place, **fields)


def tunnels(functional: Element, places: Places) -> Iterator[Tunnel]:
    """Yield over-crossings of construction type tunnel: the track runs below."""
    return places.each(functional.all("overCrossings", "overCrossing"), lambda element: _tunnel(element, places))


def _tunnel(element: Element, places: Places) -> Iterator[Tunnel]:
    if element.get("constructionType") != "tunnel":
        element.skip()
        places.notes.append(Note("not carried over", element.place, "over crossing that is no tunnel"))
        return
    stretches, _ = places.stretches(element)
    if stretches:
        yield made(Tunnel, element.place, id=element.need("id"), stretches=stretches)


def speed_limits(functional: Element, places: Places) -> Iterator[SpeedLimit]:
    """Yield the speed sections, rounded down to whole mm/s; note those for some trains only."""
    return places.each(functional.all("speeds", "speedSection"), lambda element: _speed_limits(element, places))


def _speed_limits(element: Element, places: Places) -> Iterator[SpeedLimit]:
    if element.all("validForSpeedProfile"):
        element.skip()
        places.notes.append(Note("not carried over", element.place, "speed of a profile for some trains"))
        return
    speed = decimal(element.need("maxSpeed"), f"{element.place}: maxSpeed")
    stretches, directions = places.stretches(element)
    only: Direction | None = directions[0] if len(directions) == 1 else None
    for stretch in stretches:
        limit = int(speed * _MM_S_PER_KM_H)
        yield made(SpeedLimit, element.place, **stretch.model_dump(), max_speed_mm_s=limit, direction=only)


def track_names(functional: Element, places: Places) -> dict[str, str]:
    """Return for net elements the name of the track over them, or its identity if it has no name."""
    found: dict[str, str] = {}
    for name, element, stretch in places.each(functional.all("tracks", "track"), lambda one: _named(one, places)):
        if found.setdefault(stretch.edge, name) != name:
            remark = f"second track on net element {stretch.edge!r}"
            places.notes.append(Note("not carried over", element.place, remark))
    return found


def _named(element: Element, places: Places) -> Iterator[tuple[str, Element, Stretch]]:
    name = next((one.get("name") for one in element.all("name")), None) or element.need("id")
    for stretch in places.stretches(element)[0]:
        yield name, element, stretch


# ------------------------------------------------------------------ ends and switches


def ended(functional: Element, places: Places, nodes: Sequence[Node], node_of: Mapping[End, str]) -> tuple[Node, ...]:
    """Return the nodes, with buffer stops and open borders where exactly one edge ends."""
    kinds: dict[str, str] = {}
    alone = {name for name, count in Counter(node_of.values()).items() if count == 1}
    for tags, kind in ((("bufferStops", "bufferStop"), "buffer_stop"), (("borders", "border"), "border")):
        found = places.each(functional.all(*tags), lambda one: [(one, _node_at(one, places, node_of))])
        for element, node in found:
            open_end = element.get("isOpenEnd")
            if node in alone and (kind == "buffer_stop" or open_end in ("true", "1")):
                kinds[node] = kind
            elif node is not None:
                places.notes.append(Note("not carried over", element.place, "does not stand where the track ends"))
    return tuple(node.model_copy(update={"kind": kinds[node.id]}) if node.id in kinds else node for node in nodes)


def _node_at(element: Element, places: Places, node_of: Mapping[End, str]) -> str | None:
    spot = places.spot(element)
    if spot is None:
        return None
    length = places.network.elements[spot.edge].length_mm
    end = 0 if spot.position_mm == 0 else 1
    return node_of[spot.edge, end] if spot.position_mm in (0, length) else ""


def switch_naming(functional: Element, network: Network, places: Places) -> Naming:
    """Return names of nodes from switches and crossings, and the sides of the branches as the document gives them."""
    relations = {relation.id: relation for relation in network.relations}
    names: dict[frozenset[End], str] = {}
    left_of: dict[frozenset[End], bool] = {}
    for tags in (("switchesIS", "switchIS"), ("crossings", "crossing")):
        for name, tag, pair in places.each(functional.all(*tags), lambda element: _branches(element, relations)):
            names.setdefault(pair, name)
            if tag in ("leftBranch", "rightBranch"):
                left_of[pair] = tag == "leftBranch"

    def node(ends: Sequence[End], meeting: Sequence[Relation]) -> str:
        named = [names[pair] for one in meeting if (pair := frozenset((one.one, one.other))) in names]
        if named:
            return named[0]
        return meeting[0].id if meeting else f"{ends[0][0]} {'end' if ends[0][1] else 'begin'}"

    def sides(stem: End, one: End, other: End) -> tuple[End, End] | None:
        first, second = left_of.get(frozenset((stem, one))), left_of.get(frozenset((stem, other)))
        if first is None or second is None or first == second:
            return None
        return (one, other) if first else (other, one)

    return Naming(node, sides, lambda _: None)


def _branches(element: Element, relations: Mapping[str, Relation]) -> Iterator[tuple[str, str, frozenset[End]]]:
    """Yield identity of the switch, kind of branch and the ends that it connects."""
    for tag in ("leftBranch", "rightBranch", "straightBranch", "turningBranch"):
        for branch in element.all(tag):
            yield element.need("id"), tag, _pair(branch, relations, element)
    for location in element.all("spotLocation"):
        location.skip()  # the node follows from the branches


def _pair(branch: Element, relations: Mapping[str, Relation], owner: Element) -> frozenset[End]:
    name = branch.need("netRelationRef")
    if name not in relations:
        raise InputError(f"{owner.place}: {branch.tag} line {branch.line}: there is no netRelation {name!r}.")
    return frozenset((relations[name].one, relations[name].other))
