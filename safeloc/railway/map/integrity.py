"""Consistency checks of a line, one function each. All of them run, and each names the faulty elements."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterator, Mapping, Sequence
from itertools import pairwise
from typing import TYPE_CHECKING, Protocol

from safeloc.railway.map.elements import BaliseGroup, Fibre, OnEdge, Stretch

if TYPE_CHECKING:
    from safeloc.railway.map.model import Line


class _Named(Protocol):
    @property
    def id(self) -> str: ...


def contradictions(line: Line) -> Iterator[str]:
    """Yield a sentence for every contradiction in the map."""
    for check in _CHECKS:
        yield from check(line)


def kinds(line: Line) -> Mapping[str, Sequence[_Named]]:
    """Return the elements that have identities, by the name of their list."""
    return {
        "nodes": line.nodes,
        "edges": line.edges,
        "switches": line.switches,
        "crossings": line.crossings,
        "balise_groups": line.balise_groups,
        "reflectors": line.reflectors,
        "markers": line.markers,
        "stop_points": line.stop_points,
        "signals": line.signals,
        "axle_counters": line.axle_counters,
        "detection_sections": line.detection_sections,
        "virtual_sections": line.virtual_sections,
        "fibres": line.fibres,
        "localization_sections": line.localization_sections,
        "tunnels": line.tunnels,
    }


def _identities(line: Line) -> Iterator[str]:
    for kind, elements in kinds(line).items():
        for identity, count in Counter(element.id for element in elements).items():
            if count > 1:
                yield f"{kind}: {count} elements are called {identity!r}"


def _telegram_identities(line: Line) -> Iterator[str]:
    same = Counter((group.country, group.identity) for group in line.balise_groups)
    for (country, identity), count in same.items():
        if count > 1:
            yield f"balise_groups: {count} groups send NID_C {country}, NID_BG {identity}"


def _marker_identities(line: Line) -> Iterator[str]:
    for identity, count in Counter(marker.identity for marker in line.markers).items():
        if count > 1:
            yield f"markers: {count} markers have the identity {identity}, so a reading would not tell which one was passed"


def _edge_nodes(line: Line) -> Iterator[str]:
    known = {node.id for node in line.nodes}
    for edge in line.edges:
        for node in (edge.from_node, edge.to_node):
            if node not in known:
                yield f"edge {edge.id!r}: there is no node {node!r}"
        if edge.from_node == edge.to_node:
            yield f"edge {edge.id!r}: begins and ends at node {edge.from_node!r}; put a node in between"


def _kilometre_points(line: Line) -> Iterator[str]:
    for edge in line.edges:
        places = [point.position_mm for point in edge.kilometres]
        if any(a >= b for a, b in pairwise(places)):
            yield f"edge {edge.id!r}: kilometre points must be in order of position"
        if places and places[0] != 0:
            yield f"edge {edge.id!r}: the first kilometre point must be at position 0"
        if any(place > edge.length_mm for place in places):
            yield f"edge {edge.id!r}: a kilometre point lies beyond its length {edge.length_mm} mm"


def _ends_at(line: Line) -> dict[str, frozenset[str]]:
    """Return the edges that end at each node."""
    found: dict[str, set[str]] = {node.id: set() for node in line.nodes}
    for edge in line.edges:
        found.setdefault(edge.from_node, set()).add(edge.id)
        found.setdefault(edge.to_node, set()).add(edge.id)
    return {node: frozenset(edges) for node, edges in found.items()}


def _switches(line: Line) -> Iterator[str]:
    there = _ends_at(line)
    for switch in line.switches:
        used = (switch.stem, switch.left, switch.right)
        if len(set(used)) != 3:
            yield f"switch {switch.id!r}: stem, left and right must be three edges, not {', '.join(used)}"
        if there.get(switch.node, frozenset()) != set(used):
            met = ", ".join(sorted(there.get(switch.node, ()))) or "none"
            yield f"switch {switch.id!r}: joins {', '.join(used)}, but at node {switch.node!r} meet: {met}"


def _crossings(line: Line) -> Iterator[str]:
    there = _ends_at(line)
    for crossing in line.crossings:
        used = {edge for pair in crossing.movements for edge in pair}
        if used != there.get(crossing.node, frozenset()):
            met = ", ".join(sorted(there.get(crossing.node, ()))) or "none"
            yield f"crossing {crossing.id!r}: moves between {', '.join(sorted(used))}, but at node meet: {met}"
        if any(a == b for a, b in crossing.movements):
            yield f"crossing {crossing.id!r}: a movement must be between two edges"


def _nodes(line: Line) -> Iterator[str]:
    there = _ends_at(line)
    owners = Counter([*(one.node for one in line.switches), *(one.node for one in line.crossings)])
    for node in line.nodes:
        count, owned = len(there[node.id]), owners[node.id]
        if owned > 1:
            yield f"node {node.id!r}: belongs to {owned} switches or crossings; it may belong to one"
        if count == 0:
            yield f"node {node.id!r}: no edge ends there"
        if count > 2 and not owned:
            yield f"node {node.id!r}: {count} edges meet without a switch or crossing"
        if node.kind in ("buffer_stop", "border", "seam") and count != 1:
            yield f"node {node.id!r}: is a {node.kind} and must end one edge, not {count}"


def _places(line: Line) -> Iterator[str]:
    lengths = {edge.id: edge.length_mm for edge in line.edges}
    named: list[tuple[str, str, int]] = []
    on_edge: Sequence[tuple[str, Sequence[OnEdge]]] = (
        ("reflector", line.reflectors),
        ("marker", line.markers),
        ("stop point", line.stop_points),
        ("signal", line.signals),
        ("axle counter", line.axle_counters),
    )
    for kind, elements in on_edge:
        named += [(f"{kind} {one.id!r}", one.edge, one.position_mm) for one in elements]
    for group in line.balise_groups:
        named += [(f"balise group {group.id!r}", group.edge, balise.position_mm) for balise in group.balises]
    for fibre in line.fibres:
        named += [(f"fibre {fibre.id!r}", point.edge, point.position_mm) for point in fibre.map_points]
    for name, edge, position in named:
        yield from _off_edge(lengths, name, edge, position)


def _off_edge(lengths: Mapping[str, int], name: str, edge: str, position_mm: int) -> Iterator[str]:
    if edge not in lengths:
        yield f"{name}: there is no edge {edge!r}"
    elif position_mm > lengths[edge]:
        yield f"{name}: {position_mm} mm lies beyond edge {edge!r} of {lengths[edge]} mm"


def _stretches(line: Line) -> Iterator[str]:
    lengths = {edge.id: edge.length_mm for edge in line.edges}
    named: list[tuple[str, Stretch]] = []
    for kind, sections in (
        ("detection section", line.detection_sections),
        ("virtual section", line.virtual_sections),
        ("tunnel", line.tunnels),
    ):
        named += [(f"{kind} {one.id!r}", stretch) for one in sections for stretch in one.stretches]
    plain: Sequence[tuple[str, Sequence[Stretch]]] = (
        ("speed limit", line.speed_limits),
        ("gradient", line.gradients),
        ("curve", line.curves),
    )
    for kind, stretches in plain:
        named += [(f"{kind} on {one.edge!r}", one) for one in stretches]
    for name, stretch in named:
        yield from _off_edge(lengths, name, stretch.edge, stretch.to_mm)
        if stretch.from_mm >= stretch.to_mm:
            yield f"{name}: from_mm {stretch.from_mm} must lie before to_mm {stretch.to_mm}"
    for fibre in line.fibres:
        for stretch in fibre.path:
            far = max(stretch.from_mm, stretch.to_mm)
            yield from _off_edge(lengths, f"fibre {fibre.id!r}", stretch.edge, far)


def _balise_order(line: Line) -> Iterator[str]:
    for group in line.balise_groups:
        yield from _one_group(group)


def _one_group(group: BaliseGroup) -> Iterator[str]:
    steps = [b.position_mm - a.position_mm for a, b in pairwise(group.balises)]
    if not (all(step > 0 for step in steps) or all(step < 0 for step in steps)):
        yield f"balise group {group.id!r}: its balises must lie in the order of their numbers"
    elif steps and group.nominal_direction not in (None, group.orientation):
        yield f"balise group {group.id!r}: nominal_direction contradicts the order of its balises"
    if not group.linked and len(group.balises) < 2:
        yield f"balise group {group.id!r}: an unlinked group has at least two balises"


def _references(line: Line) -> Iterator[str]:
    """Check references between elements. A part may refer to elements of other parts, a complete line may not."""
    if line.part:
        return
    known = {kind: {element.id for element in elements} for kind, elements in kinds(line).items()}
    wanted: list[tuple[str, str, str]] = []
    wanted += [(f"stop point {stop.id!r}", "reflectors", stop.reflector) for stop in line.stop_points]
    for group in line.balise_groups:
        name = f"balise group {group.id!r}"
        wanted += [(name, "reflectors", announced.reflector) for announced in group.telegram_reflectors]
        wanted += [(name, "balise_groups", group.duplicate_of)] if group.duplicate_of is not None else []
    for section in line.detection_sections:
        wanted += [(f"detection section {section.id!r}", "axle_counters", one) for one in section.axle_counters]
    wanted += [
        (f"virtual section {one.id!r}", "detection_sections", one.detection_section)
        for one in line.virtual_sections
        if one.detection_section is not None
    ]
    wanted += [(f"localization section {one.id!r}", "fibres", one.fibre) for one in line.localization_sections]
    for name, kind, identity in wanted:
        if identity not in known[kind]:
            yield f"{name}: there is no {identity!r} among {kind}"


def _view_zones(line: Line) -> Iterator[str]:
    for reflector in line.reflectors:
        if reflector.view_to_mm >= reflector.view_from_mm:
            yield (
                f"reflector {reflector.id!r}: its view zone begins {reflector.view_from_mm} mm before it and must end "
                f"nearer to it, not {reflector.view_to_mm} mm before it"
            )


def _fibres(line: Line) -> Iterator[str]:
    for fibre in line.fibres:
        yield from _one_fibre(fibre)
    lengths = {fibre.id: fibre.length_mm for fibre in line.fibres}
    for section in line.localization_sections:
        if section.from_fibre_mm >= section.to_fibre_mm:
            yield f"localization section {section.id!r}: from_fibre_mm must lie before to_fibre_mm"
        elif section.to_fibre_mm > lengths.get(section.fibre, section.to_fibre_mm):
            yield f"localization section {section.id!r}: lies beyond the end of fibre {section.fibre!r}"


def _one_fibre(fibre: Fibre) -> Iterator[str]:
    cable = [point.fibre_mm for point in fibre.map_points]
    if any(a >= b for a, b in pairwise(cable)):
        yield f"fibre {fibre.id!r}: map points must be in order of the cable"
    if max(cable) > fibre.length_mm:
        yield f"fibre {fibre.id!r}: a map point lies beyond its length {fibre.length_mm} mm"
    for point in fibre.map_points:
        if not any(_covers(stretch, point.edge, point.position_mm) for stretch in fibre.path):
            yield f"fibre {fibre.id!r}: its path does not lead by {point.position_mm} mm on edge {point.edge!r}"
    if any(point.fibre_mm > fibre.length_mm for point in fibre.reflecting_points):
        yield f"fibre {fibre.id!r}: a reflecting point lies beyond its length {fibre.length_mm} mm"
    if any(stretch.from_mm == stretch.to_mm for stretch in fibre.path):
        yield f"fibre {fibre.id!r}: a stretch of its path is empty"


def _covers(stretch: Stretch, edge: str, position_mm: int) -> bool:
    low, high = sorted((stretch.from_mm, stretch.to_mm))
    return stretch.edge == edge and low <= position_mm <= high


_CHECKS: tuple[Callable[[Line], Iterator[str]], ...] = (
    _identities,
    _telegram_identities,
    _marker_identities,
    _edge_nodes,
    _kilometre_points,
    _switches,
    _crossings,
    _nodes,
    _places,
    _stretches,
    _balise_order,
    _references,
    _view_zones,
    _fibres,
)
