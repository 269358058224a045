"""Consistency checks of a line, one function each. All of them run, and each names the faulty elements."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from itertools import pairwise
from typing import TYPE_CHECKING, Protocol, TypeVar

from safeloc.railway.map.elements import BaliseGroup, Fibre, OnEdge, Stretch
from safeloc.runtime.flaws import Flaw, Place

if TYPE_CHECKING:
    from safeloc.railway.map.model import Line


_Value = TypeVar("_Value")


class _Named(Protocol):
    @property
    def id(self) -> str: ...


class _Stretched(_Named, Protocol):
    @property
    def stretches(self) -> Sequence[Stretch]: ...


def contradictions(line: Line) -> Iterator[Flaw]:
    """Yield every contradiction in the map, with the places of the elements that contradict."""
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


def _identities(line: Line) -> Iterator[Flaw]:
    for kind, elements in kinds(line).items():
        for identity, numbers in _same(element.id for element in elements):
            yield Flaw(f"{kind}: {len(numbers)} elements are called {identity!r}", _places_of(kind, numbers, "id"))


def _telegram_identities(line: Line) -> Iterator[Flaw]:
    for (country, identity), numbers in _same((group.country, group.identity) for group in line.balise_groups):
        told = f"balise_groups: {len(numbers)} groups send NID_C {country}, NID_BG {identity}"
        yield Flaw(told, _places_of("balise_groups", numbers, "identity"))


def _marker_identities(line: Line) -> Iterator[Flaw]:
    for identity, numbers in _same(marker.identity for marker in line.markers):
        yield Flaw(
            f"markers: {len(numbers)} markers have the identity {identity}, so a reading would not tell which one was passed",
            _places_of("markers", numbers, "identity"),
        )


def _same(values: Iterable[_Value]) -> Iterator[tuple[_Value, Sequence[int]]]:
    """Yield each value that comes more than once, with the numbers where it comes, the last one first."""
    found: dict[_Value, list[int]] = {}
    for number, value in enumerate(values):
        found.setdefault(value, []).append(number)
    return ((value, numbers[::-1]) for value, numbers in found.items() if len(numbers) > 1)


def _places_of(kind: str, numbers: Sequence[int], key: str) -> Sequence[Place]:
    return [(kind, number, key) for number in numbers]


def _edge_nodes(line: Line) -> Iterator[Flaw]:
    known = {node.id for node in line.nodes}
    for number, edge in enumerate(line.edges):
        at = ("edges", number)
        for key, node in (("from_node", edge.from_node), ("to_node", edge.to_node)):
            if node not in known:
                yield Flaw(f"edge {edge.id!r}: there is no node {node!r}", [(*at, key)])
        if edge.from_node == edge.to_node:
            yield Flaw(f"edge {edge.id!r}: begins and ends at node {edge.from_node!r}; put a node in between", [at])


def _kilometre_points(line: Line) -> Iterator[Flaw]:
    for number, edge in enumerate(line.edges):
        at = ("edges", number, "kilometres")
        places = [point.position_mm for point in edge.kilometres]
        if any(a >= b for a, b in pairwise(places)):
            yield Flaw(f"edge {edge.id!r}: kilometre points must be in order of position", [at])
        if places and places[0] != 0:
            yield Flaw(f"edge {edge.id!r}: the first kilometre point must be at position 0", [at])
        if any(place > edge.length_mm for place in places):
            yield Flaw(f"edge {edge.id!r}: a kilometre point lies beyond its length {edge.length_mm} mm", [at])


def _ends_at(line: Line) -> dict[str, frozenset[str]]:
    """Return the edges that end at each node."""
    found: dict[str, set[str]] = {node.id: set() for node in line.nodes}
    for edge in line.edges:
        found.setdefault(edge.from_node, set()).add(edge.id)
        found.setdefault(edge.to_node, set()).add(edge.id)
    return {node: frozenset(edges) for node, edges in found.items()}


def _switches(line: Line) -> Iterator[Flaw]:
    there = _ends_at(line)
    for number, switch in enumerate(line.switches):
        at, name = ("switches", number), f"switch {switch.id!r}"
        used = (switch.stem, switch.left, switch.right)
        if len(set(used)) != 3:
            yield Flaw(f"{name}: stem, left and right must be three edges, not {', '.join(used)}", [at])
        if there.get(switch.node, frozenset()) != set(used):
            met = ", ".join(sorted(there.get(switch.node, ()))) or "none"
            yield Flaw(f"{name}: joins {', '.join(used)}, but at node {switch.node!r} meet: {met}", [at])


def _crossings(line: Line) -> Iterator[Flaw]:
    there = _ends_at(line)
    for number, crossing in enumerate(line.crossings):
        at, name = ("crossings", number), f"crossing {crossing.id!r}"
        used = {edge for pair in crossing.movements for edge in pair}
        if used != there.get(crossing.node, frozenset()):
            met = ", ".join(sorted(there.get(crossing.node, ()))) or "none"
            yield Flaw(f"{name}: moves between {', '.join(sorted(used))}, but at node meet: {met}", [at])
        if any(a == b for a, b in crossing.movements):
            yield Flaw(f"{name}: a movement must be between two edges", [(*at, "movements")])


def _nodes(line: Line) -> Iterator[Flaw]:
    there = _ends_at(line)
    owners = Counter([*(one.node for one in line.switches), *(one.node for one in line.crossings)])
    for number, node in enumerate(line.nodes):
        at = [("nodes", number)]
        count, owned = len(there[node.id]), owners[node.id]
        if owned > 1:
            yield Flaw(f"node {node.id!r}: belongs to {owned} switches or crossings; it may belong to one", at)
        if count == 0:
            yield Flaw(f"node {node.id!r}: no edge ends there", at)
        if count > 2 and not owned:
            yield Flaw(f"node {node.id!r}: {count} edges meet without a switch or crossing", at)
        if node.kind in ("buffer_stop", "border", "seam") and count != 1:
            yield Flaw(f"node {node.id!r}: is a {node.kind} and must end one edge, not {count}", at)


def _places(line: Line) -> Iterator[Flaw]:
    lengths = {edge.id: edge.length_mm for edge in line.edges}
    on_edge: Sequence[tuple[str, str, Sequence[OnEdge]]] = (
        ("reflector", "reflectors", line.reflectors),
        ("marker", "markers", line.markers),
        ("stop point", "stop_points", line.stop_points),
        ("signal", "signals", line.signals),
        ("axle counter", "axle_counters", line.axle_counters),
    )
    for word, kind, elements in on_edge:
        for number, one in enumerate(elements):
            yield from _off_edge(lengths, f"{word} {one.id!r}", (kind, number), one.edge, one.position_mm)
    for number, group in enumerate(line.balise_groups):
        for balise in group.balises:
            group_at = ("balise_groups", number)
            yield from _off_edge(lengths, f"balise group {group.id!r}", group_at, group.edge, balise.position_mm)
    for number, fibre in enumerate(line.fibres):
        for count, point in enumerate(fibre.map_points):
            point_at = ("fibres", number, "map_points", count)
            yield from _off_edge(lengths, f"fibre {fibre.id!r}", point_at, point.edge, point.position_mm)


def _off_edge(lengths: Mapping[str, int], name: str, at: Place, edge: str, position_mm: int) -> Iterator[Flaw]:
    if edge not in lengths:
        yield Flaw(f"{name}: there is no edge {edge!r}", [(*at, "edge")])
    elif position_mm > lengths[edge]:
        far = f"{name}: {position_mm} mm lies beyond edge {edge!r} of {lengths[edge]} mm"
        yield Flaw(far, [(*at, "position_mm")])


def _stretches(line: Line) -> Iterator[Flaw]:
    lengths = {edge.id: edge.length_mm for edge in line.edges}
    named: list[tuple[str, Place, Stretch]] = []
    divided: Sequence[tuple[str, str, Sequence[_Stretched]]] = (
        ("detection section", "detection_sections", line.detection_sections),
        ("virtual section", "virtual_sections", line.virtual_sections),
        ("tunnel", "tunnels", line.tunnels),
    )
    for word, kind, sections in divided:
        for number, one in enumerate(sections):
            at = (kind, number, "stretches")
            named += [(f"{word} {one.id!r}", (*at, count), there) for count, there in enumerate(one.stretches)]
    plain: Sequence[tuple[str, str, Sequence[Stretch]]] = (
        ("speed limit", "speed_limits", line.speed_limits),
        ("gradient", "gradients", line.gradients),
        ("curve", "curves", line.curves),
    )
    for word, kind, stretches in plain:
        named += [(f"{word} on {one.edge!r}", (kind, number), one) for number, one in enumerate(stretches)]
    for name, place, stretch in named:
        yield from _off_edge(lengths, name, place, stretch.edge, stretch.to_mm)
        if stretch.from_mm >= stretch.to_mm:
            yield Flaw(f"{name}: from_mm {stretch.from_mm} must lie before to_mm {stretch.to_mm}", [place])
    for number, fibre in enumerate(line.fibres):
        for count, stretch in enumerate(fibre.path):
            far = max(stretch.from_mm, stretch.to_mm)
            yield from _off_edge(lengths, f"fibre {fibre.id!r}", ("fibres", number, "path", count), stretch.edge, far)


def _balise_order(line: Line) -> Iterator[Flaw]:
    for number, group in enumerate(line.balise_groups):
        yield from (Flaw(told, [("balise_groups", number)]) for told in _one_group(group))


def _one_group(group: BaliseGroup) -> Iterator[str]:
    steps = [b.position_mm - a.position_mm for a, b in pairwise(group.balises)]
    if not (all(step > 0 for step in steps) or all(step < 0 for step in steps)):
        yield f"balise group {group.id!r}: its balises must lie in the order of their numbers"
    elif steps and group.nominal_direction not in (None, group.orientation):
        yield f"balise group {group.id!r}: nominal_direction contradicts the order of its balises"
    if not group.linked and len(group.balises) < 2:
        yield f"balise group {group.id!r}: an unlinked group has at least two balises"


def _references(line: Line) -> Iterator[Flaw]:
    """Check references between elements. A part may refer to elements of other parts, a complete line may not."""
    if line.part:
        return
    known = {kind: {element.id for element in elements} for kind, elements in kinds(line).items()}
    for name, at, kind, identity in _referring(line):
        if identity not in known[kind]:
            yield Flaw(f"{name}: there is no {identity!r} among {kind}", [at])


def _referring(line: Line) -> Iterator[tuple[str, Place, str, str]]:
    """Yield every reference: who refers, its place, and the list and identity that it refers to."""
    for number, stop in enumerate(line.stop_points):
        yield f"stop point {stop.id!r}", ("stop_points", number, "reflector"), "reflectors", stop.reflector
    for number, group in enumerate(line.balise_groups):
        name, at = f"balise group {group.id!r}", ("balise_groups", number)
        for count, announced in enumerate(group.telegram_reflectors):
            yield name, (*at, "telegram_reflectors", count, "reflector"), "reflectors", announced.reflector
        if group.duplicate_of is not None:
            yield name, (*at, "duplicate_of"), "balise_groups", group.duplicate_of
    for number, section in enumerate(line.detection_sections):
        for count, one in enumerate(section.axle_counters):
            place = ("detection_sections", number, "axle_counters", count)
            yield f"detection section {section.id!r}", place, "axle_counters", one
    for number, virtual in enumerate(line.virtual_sections):
        if virtual.detection_section is not None:
            key = "detection_section"
            yield (
                f"virtual section {virtual.id!r}",
                ("virtual_sections", number, key),
                "detection_sections",
                virtual.detection_section,
            )
    for number, local in enumerate(line.localization_sections):
        name = f"localization section {local.id!r}"
        yield name, ("localization_sections", number, "fibre"), "fibres", local.fibre


def _view_zones(line: Line) -> Iterator[Flaw]:
    for number, reflector in enumerate(line.reflectors):
        if reflector.view_to_mm >= reflector.view_from_mm:
            yield Flaw(
                f"reflector {reflector.id!r}: its view zone begins {reflector.view_from_mm} mm before it and must end "
                f"nearer to it, not {reflector.view_to_mm} mm before it",
                [("reflectors", number, "view_to_mm")],
            )


def _fibres(line: Line) -> Iterator[Flaw]:
    for number, fibre in enumerate(line.fibres):
        yield from (Flaw(told, [("fibres", number)]) for told in _one_fibre(fibre))
    lengths = {fibre.id: fibre.length_mm for fibre in line.fibres}
    for number, section in enumerate(line.localization_sections):
        name, at = f"localization section {section.id!r}", [("localization_sections", number)]
        if section.from_fibre_mm >= section.to_fibre_mm:
            yield Flaw(f"{name}: from_fibre_mm must lie before to_fibre_mm", at)
        elif section.to_fibre_mm > lengths.get(section.fibre, section.to_fibre_mm):
            yield Flaw(f"{name}: lies beyond the end of fibre {section.fibre!r}", at)


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


_CHECKS: tuple[Callable[[Line], Iterator[Flaw]], ...] = (
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
