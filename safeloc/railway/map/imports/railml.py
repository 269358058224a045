"""Imports railML 3 (3.1 to 3.3): the micro topology and the objects along it (RFL-4).

Carried over: net elements with their courses, and relations with switches and crossings, kilometres, tracks, buffer stops
and open borders, balise groups, signals, axle counters, tunnels, speed limits. An object along the track whose data is wrong
is left out, with a note; errors in the topology refuse the document. Lengths become whole mm by exact decimal arithmetic.
Everything else is in the notes, element by element, known or unknown.
"""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterator
from pathlib import Path

from safeloc.errors import InputError
from safeloc.railway.map.elements import Node, TrackEdge
from safeloc.railway.map.imports.building import made, within
from safeloc.railway.map.imports.notes import Imported, Note
from safeloc.railway.map.imports.railml_balises import balise_groups
from safeloc.railway.map.imports.railml_network import Network, kilometres, linear_units, read_network
from safeloc.railway.map.imports.railml_objects import (
    axle_counters,
    ended,
    signals,
    speed_limits,
    switch_naming,
    track_names,
    tunnels,
)
from safeloc.railway.map.imports.railml_places import Places
from safeloc.railway.map.imports.railml_xml import Element, read_xml, unused
from safeloc.railway.map.imports.topology import Joined, join
from safeloc.railway.map.model import Line

_NAMESPACE = re.compile(r"https://www\.railml\.org/schemas/3\.[1-3]")
_NO_PLACE = frozenset({
    "metadata", "name", "designator", "isValid", "typeDesignator", "external", "elementState", "gmlLocations",
    "gmlLocation", "networkLocation", "areaLocation", "geometricCoordinate", "screenPositioningSystems",
    "organizationalUnits", "speedProfiles", "electrificationSystems", "positioning",
    "rollingstock", "timetable", "interlocking", "visualizations", "infrastructureVisualizations", "geometry",
    "infrastructureState", "length", "trackBegin", "trackEnd", "locationReference",
    "connectedWithInfrastructureElement", "applicationType", "functionalType", "crossesElement", "tunnelResistance",
    "anchors", "detectors", "derailersIS", "electrifications", "etcsAreas", "etcsLevelTransitions",
    "genericLocators", "hazardAreas", "keyLocksIS", "levelCrossingsIS", "lines", "loadingGauges", "mileageChanges",
    "operationalPoints", "platforms", "platformEdges", "restrictionAreas", "serviceSections", "stoppingPlaces",
    "trackBeds", "trackGauges", "trainProtectionElements", "trainRadios", "tunnelGatesIS", "underCrossings",
    "weightLimits", "signalConstruction",
})  # fmt: skip
"""Elements of railML without a place in the map; any other element that is not carried over is noted as not understood."""


_NO_PLACE_ATTRIBUTES = frozenset({
    "type", "continueCourse", "branchCourse", "language", "description", "basedOnTemplate", "belongsToParent", "radius",
    "mainDirection", "infrastructureManagerRef", "isSwitchable", "detectorMedium", "detectedObject", "layout", "length",
    "linkReactionNominal", "linkReactionReverse", "coverage", "isSignalized", "isTemporary", "endPointValidity",
    "branchingSpeed", "joiningSpeed", "verbalConstraint", "startMeasure", "endMeasure", "linearReferencingMethod",
})  # fmt: skip
"""Attributes of railML without a place in the map."""


def read_railml(path: Path, *, name: str | None = None, version: str | None = None) -> Imported:
    """Return the line in a railML 3 document.

    name, version  of the line; by default the file's name, and "1"
    Raises InputError, with element, identity and line, for broken references, missing lengths, places off their net
    element, anything that is not railML 3 and any document type; EngineError without lxml.
    """
    with within(path):
        return _imported(_checked(read_xml(path)), name or path.stem, version or "1", path.name)


def _checked(root: Element) -> Element:
    if root.tag != "railML" or not _NAMESPACE.fullmatch(root.namespace):
        raise InputError(f"expected a railML 3.1 to 3.3 document, got <{root.tag}> of {root.namespace!r}.")
    root.get("version")
    return root


def _imported(root: Element, name: str, version: str, source: str) -> Imported:
    infrastructure = root.one("infrastructure")
    if infrastructure is None:
        raise InputError("the document has no infrastructure.")
    functional = infrastructure.one("functionalInfrastructure") or Element("none", root.namespace, 0, "", {}, [])
    notes: list[Note] = []
    network = read_network(root, infrastructure, notes)
    places = Places(network, linear_units(root), notes)
    joined = join(list(network.elements), network.relations, switch_naming(functional, network, places))
    nodes = ended(functional, places, joined.nodes, joined.node_of)
    edges = _edges(network, joined, track_names(functional, places), notes)
    line = made(
        Line,
        infrastructure.place,
        name=name,
        version=version,
        source=source,
        nodes=nodes,
        edges=edges,
        switches=joined.switches,
        crossings=joined.crossings,
        balise_groups=tuple(balise_groups(functional, places, {edge.id: edge for edge in edges})),
        signals=tuple(signals(functional, places)),
        axle_counters=tuple(axle_counters(functional, places)),
        tunnels=tuple(tunnels(functional, places)),
        speed_limits=tuple(speed_limits(functional, places)),
    )
    return Imported(line, (*notes, *joined.notes, *_ends(nodes, joined), *_left(root)))


def _edges(network: Network, joined: Joined, tracks: dict[str, str], notes: list[Note]) -> tuple[TrackEdge, ...]:
    return tuple(
        made(
            TrackEdge,
            net.element.place,
            id=name,
            from_node=joined.node_of[name, 0],
            to_node=joined.node_of[name, 1],
            length_mm=net.length_mm,
            track=tracks.get(name, ""),
            kilometres=kilometres(net, notes),
            geometry=None if net.course is None else net.course.geometry,
        )
        for name, net in network.elements.items()
    )


def _ends(nodes: tuple[Node, ...], joined: Joined) -> Iterator[Note]:
    """Yield notes on nodes at which a single edge ends without a statement why."""
    kinds = {node.id: node.kind for node in nodes}
    count = Counter(joined.node_of.values())
    for (edge, _), node in joined.node_of.items():
        if count[node] == 1 and kinds[node] == "track":
            yield Note("assumed", f"netElement {edge!r}", "track ends without a buffer stop or an open border")


def _left(root: Element) -> Iterator[Note]:
    """Yield notes on elements and attributes that the importer did not read."""
    for element, attribute in unused(root):
        if attribute is not None:
            known = attribute in _NO_PLACE_ATTRIBUTES
            yield Note("not carried over" if known else "not understood", element.place, f"attribute {attribute!r}")
        elif element.tag in _NO_PLACE and element.namespace == root.namespace:
            for one in _members(element):
                yield Note("not carried over", one.place, f"{one.tag}: the map has no place for it")
        else:
            space = "" if element.namespace == root.namespace else f" of {element.namespace!r}"
            yield Note("not understood", element.place, f"element {element.tag}{space}")


def _members(element: Element) -> list[Element]:
    """Return the members of a list of elements with identities, or else the element itself."""
    listed = bool(element.children) and all("id" in child.attributes for child in element.children)
    return element.children if listed and "id" not in element.attributes else [element]
