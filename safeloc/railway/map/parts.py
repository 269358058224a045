"""Parts of a map that a vehicle loads along its way (RFL-4): cut at seams, with a checksum, joined only if they fit."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass
from functools import cached_property
from itertools import combinations
from typing import Any

import networkx as nx
from pydantic import ValidationError, model_validator

from safeloc.errors import InputError
from safeloc.railway.map.elements import Node, TrackEdge
from safeloc.railway.map.model import Line, content_checksum, sealed
from safeloc.railway.map.places import kilometre_mm

_BY_EDGE = ("balise_groups", "reflectors", "markers", "stop_points", "signals", "axle_counters")
_BY_STRETCH = ("speed_limits", "gradients", "curves")
_SECTIONS = ("detection_sections", "virtual_sections", "tunnels")
_BY_NODE = ("switches", "crossings")


class LinePart(Line):
    """A part of a line, with its own name and checksum. It ends at a seam where another part follows."""

    @model_validator(mode="after")
    def _is_a_part(self) -> LinePart:
        if not self.part:
            raise ValueError("part: a part of a map needs a name of its own")
        if self.checksum is None:
            raise ValueError("checksum: a part of a map needs one (`sealed`)")
        return self


@dataclass(frozen=True)
class PartialMap:
    """The parts on board. Every change is checked: a part that does not fit is refused, and the map stays unchanged."""

    parts: tuple[LinePart, ...]

    def __post_init__(self) -> None:
        if not self.parts:
            raise InputError("a map needs at least one part.")
        for check in _CHECKS:
            for wrong in check(self.parts):
                raise InputError(f"{wrong}; the part is refused.")
        _ = self.line

    def with_part(self, part: LinePart) -> PartialMap:
        """Return the map with one more part. InputError if checksum, version or seams do not match; this map stays unchanged."""
        return PartialMap((*self.parts, part))

    def without(self, name: str) -> PartialMap:
        """Return the map without a part that lies behind. InputError if no part has that name."""
        if name not in {part.part for part in self.parts}:
            raise InputError(f"there is no part {name!r}; on board are {', '.join(part.part for part in self.parts)}.")
        return PartialMap(tuple(part for part in self.parts if part.part != name))

    @cached_property
    def line(self) -> Line:
        """All parts as one line. While it has open seams it is a part itself, and may refer to elements beyond them."""
        return _assembled(self.parts)


# ------------------------------------------------------------------ checks


def _checksums(parts: tuple[LinePart, ...]) -> Iterator[str]:
    for part in parts:
        if part.checksum != content_checksum(part):
            yield f"part {part.part!r}: checksum is {part.checksum}, its content has {content_checksum(part)}"


def _one_map(parts: tuple[LinePart, ...]) -> Iterator[str]:
    first = parts[0]
    for part in parts[1:]:
        if (part.name, part.version) != (first.name, first.version):
            yield (
                f"part {part.part!r} belongs to {part.name!r} version {part.version!r}, the map on board is "
                f"{first.name!r} version {first.version!r}"
            )


def _names(parts: tuple[LinePart, ...]) -> Iterator[str]:
    names = [part.part for part in parts]
    yield from (f"part {name!r} is on board already" for name in sorted(set(names)) if names.count(name) > 1)


def _seams(parts: tuple[LinePart, ...]) -> Iterator[str]:
    for first, second in combinations(parts, 2):
        there = {node.id: node for node in second.nodes}
        for node in first.nodes:
            if node.id in there:
                yield from _seam(first, second, node, there[node.id])


def _seam(first: LinePart, second: LinePart, here: Node, there: Node) -> Iterator[str]:
    shared = f"parts {first.part!r} and {second.part!r} share node {here.id!r}"
    if (here.kind, there.kind) != ("seam", "seam"):
        yield f"{shared}, which must be a seam in both"
        return
    if (here.longitude_deg, here.latitude_deg) != (there.longitude_deg, there.latitude_deg):
        yield f"{shared} at different coordinates"
    one, other = _edge_at(first, here.id), _edge_at(second, here.id)
    counted = [kilometre_mm(edge, 0 if edge.from_node == here.id else edge.length_mm) for edge in (one, other)]
    if None not in counted and counted[0] != counted[1]:
        yield f"{shared} at different kilometres, {counted[0]} and {counted[1]}"
    if {"both"}.isdisjoint((one.travel, other.travel)) and _leads_to(one, here.id) == _leads_to(other, here.id):
        yield f"{shared}, where the regular directions of travel meet head-on"


def _edge_at(part: LinePart, node: str) -> TrackEdge:
    return next(edge for edge in part.edges if node in (edge.from_node, edge.to_node))


def _leads_to(edge: TrackEdge, node: str) -> bool:
    return (edge.to_node == node) == (edge.travel == "increasing")


_CHECKS: tuple[Callable[[tuple[LinePart, ...]], Iterator[str]], ...] = (_checksums, _one_map, _names, _seams)


# ------------------------------------------------------------------ joining


def _assembled(parts: tuple[LinePart, ...]) -> Line:
    joined = ("edges", "fibres", "localization_sections", *_BY_NODE, *_BY_EDGE, *_BY_STRETCH)
    merged: dict[str, Any] = {
        kind: tuple(element for part in parts for element in getattr(part, kind)) for kind in joined
    }
    merged |= {kind: _sections(parts, kind) for kind in _SECTIONS}
    nodes = _nodes(parts)
    open_seams = any(node.kind == "seam" for node in nodes)
    name = "+".join(part.part for part in parts) if open_seams else ""
    first = parts[0]
    try:
        return Line(name=first.name, version=first.version, source=first.source, part=name, nodes=nodes, **merged)
    except ValidationError as error:
        reason = error.errors(include_url=False)[0]["msg"].removeprefix("Value error, ")
        raise InputError(f"parts {', '.join(part.part for part in parts)} do not fit together: {reason}.") from error


def _nodes(parts: tuple[LinePart, ...]) -> tuple[Node, ...]:
    found: dict[str, Node] = {}
    for node in (node for part in parts for node in part.nodes):
        found[node.id] = node.model_copy(update={"kind": "track"}) if node.id in found else node
    return tuple(found.values())


def _sections(parts: tuple[LinePart, ...], kind: str) -> tuple[Any, ...]:
    """Return the sections of all parts, joining those that were cut at a seam."""
    found: dict[str, Any] = {}
    for section in (section for part in parts for section in getattr(part, kind)):
        known = found.get(section.id)
        if known is not None and known.model_copy(update={"stretches": section.stretches}) != section:
            raise InputError(f"{kind} {section.id!r} differs between parts; the part is refused.")
        stretches = (*known.stretches, *section.stretches) if known is not None else section.stretches
        found[section.id] = section.model_copy(update={"stretches": stretches})
    return tuple(found.values())


# ------------------------------------------------------------------ cutting


def cut(line: Line, names: Mapping[str, str], seams: Iterable[str]) -> tuple[LinePart, ...]:
    """Return the line, cut at plain nodes. `names` maps one edge of each part to the part's name.

    Raises InputError for a seam that is not a plain node between two edges, for a part without a name or with two, and
    for a fibre that a seam would cut.
    """
    uncut = line.model_copy(update={"checksum": None})
    at = frozenset(seams)
    _cuttable(uncut, at)
    pieces = _pieces(uncut, at)
    _refuse_cut_fibres(uncut, pieces)
    return tuple(_piece(uncut, edges, at, _name(edges, names)) for edges in pieces)


def _cuttable(line: Line, seams: frozenset[str]) -> None:
    owned = {one.node for one in line.switches} | {one.node for one in line.crossings}
    for seam in sorted(seams):
        ends = [edge for edge in line.edges if seam in (edge.from_node, edge.to_node)]
        if len(ends) != 2 or seam in owned:
            raise InputError(f"node {seam!r}: a line is cut where two edges meet without a switch; {len(ends)} meet.")


def _pieces(line: Line, seams: frozenset[str]) -> list[frozenset[str]]:
    graph: nx.Graph[tuple[str, str]] = nx.Graph()
    for edge in line.edges:
        graph.add_node(("edge", edge.id))
        ends = {edge.from_node, edge.to_node} - seams
        graph.add_edges_from((("edge", edge.id), ("node", node)) for node in ends)
    found = nx.connected_components(graph)
    return [frozenset(identity for kind, identity in piece if kind == "edge") for piece in found]


def _name(edges: frozenset[str], names: Mapping[str, str]) -> str:
    given = sorted({names[edge] for edge in edges if edge in names})
    if len(given) != 1:
        raise InputError(f"the part with edge {min(edges)!r} is given {len(given)} names; give it one.")
    return given[0]


def _piece(line: Line, edges: frozenset[str], seams: frozenset[str], name: str) -> LinePart:
    kept = tuple(edge for edge in line.edges if edge.id in edges)
    nodes = {node for edge in kept for node in (edge.from_node, edge.to_node)}
    held: dict[str, Any] = {
        "part": name,
        "edges": kept,
        "nodes": tuple(_as_seam(node, seams) for node in line.nodes if node.id in nodes),
    }
    held |= {kind: tuple(one for one in getattr(line, kind) if one.node in nodes) for kind in _BY_NODE}
    held |= {kind: tuple(one for one in getattr(line, kind) if one.edge in edges) for kind in (*_BY_EDGE, *_BY_STRETCH)}
    held |= {kind: _within(getattr(line, kind), edges) for kind in _SECTIONS}
    fibres = tuple(fibre for fibre in line.fibres if fibre.path[0].edge in edges)
    carried = {fibre.id for fibre in fibres}
    held |= {
        "fibres": fibres,
        "localization_sections": tuple(one for one in line.localization_sections if one.fibre in carried),
    }
    part = sealed(line.model_copy(update=held))
    return LinePart(**{field: getattr(part, field) for field in Line.model_fields})


def _as_seam(node: Node, seams: frozenset[str]) -> Node:
    return node.model_copy(update={"kind": "seam"}) if node.id in seams else node


def _within(sections: tuple[Any, ...], edges: frozenset[str]) -> tuple[Any, ...]:
    kept = []
    for section in sections:
        stretches = tuple(stretch for stretch in section.stretches if stretch.edge in edges)
        if stretches:
            kept.append(section.model_copy(update={"stretches": stretches}))
    return tuple(kept)


def _refuse_cut_fibres(line: Line, pieces: list[frozenset[str]]) -> None:
    for fibre in line.fibres:
        used = {stretch.edge for stretch in fibre.path} | {point.edge for point in fibre.map_points}
        if not any(used <= edges for edges in pieces):
            raise InputError(f"fibre {fibre.id!r} runs over a seam; cut the line where no fibre continues.")
