"""Builds nodes, switches and crossings from relations between ends of edges (for railML and GeoJSON networks)."""

from __future__ import annotations

from collections import Counter, defaultdict
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import combinations

from safeloc.errors import InputError
from safeloc.railway.map.elements import Crossing, Node, Switch
from safeloc.railway.map.imports.building import made
from safeloc.railway.map.imports.notes import Note

_MOST_ENDS = 100
"""Greatest number of edge ends at one node; each pair of them may be a way."""

End = tuple[str, int]
"""One end of an edge: its identity, and 0 where it begins or 1 where it ends."""

Pair = frozenset[End]
Sides = Callable[[End, End, End], tuple[End, End] | None]
"""(stem, one branch, the other) -> (left, right), seen from the stem; None if unknown."""

NodeName = Callable[[Sequence[End], Sequence["Relation"]], str]
"""(ends, relations) -> the name of the node where these ends meet by these relations."""

Coordinates = Callable[[End], tuple[float, float] | None]
"""End -> its longitude and latitude; None if unknown."""


@dataclass(frozen=True)
class Relation:
    """Two ends that meet. `passable`: vehicles can run from one edge to the other."""

    id: str
    one: End
    other: End
    passable: bool
    place: str


@dataclass(frozen=True)
class Joined:
    """The connections of the edges."""

    nodes: tuple[Node, ...]
    node_of: Mapping[End, str]
    switches: tuple[Switch, ...]
    crossings: tuple[Crossing, ...]
    notes: tuple[Note, ...]


@dataclass(frozen=True)
class Naming:
    """Functions of a format that describe a node where edges meet."""

    node: NodeName
    sides: Sides
    coordinates: Coordinates


def join(edges: Sequence[str], relations: Sequence[Relation], naming: Naming) -> Joined:
    """Return the nodes at which the edges meet.

    Three ends with two ways are a switch if the sides of its branches are known; any other node with more than two ends is a
    crossing, which only lists the ways. An end without a way to another gets a node of its own.
    """
    notes: list[Note] = []
    ways = _ways(relations, notes)
    groups = _groups(edges, relations, ways)
    inside, notes_apart = _inside(relations, groups)
    node_of: dict[End, str] = {}
    found: list[Switch | Crossing] = []
    nodes: list[Node] = []
    for ends, meeting in zip(groups, inside, strict=True):
        if len(ends) > _MOST_ENDS:
            raise InputError(f"edge {min(ends)[0]!r}: {len(ends)} ends meet at one place, at most {_MOST_ENDS} can.")
        place = meeting[0].place if meeting else f"edge {min(ends)[0]!r}"
        node = _node(sorted(ends), meeting, naming, place)
        nodes.append(node)
        node_of |= dict.fromkeys(ends, node.id)
        found += _joint(node.id, ends, ways, naming.sides, place, notes)
    notes += notes_apart
    _refuse_same_names(nodes)
    return Joined(
        tuple(nodes),
        node_of,
        tuple(one for one in found if isinstance(one, Switch)),
        tuple(one for one in found if isinstance(one, Crossing)),
        tuple(notes),
    )


def _ways(relations: Iterable[Relation], notes: list[Note]) -> set[Pair]:
    """Return the pairs of ends between which vehicles can run; if two relations contradict each other they cannot."""
    by_pair: dict[Pair, list[Relation]] = defaultdict(list)
    for relation in relations:
        by_pair[frozenset((relation.one, relation.other))].append(relation)
    ways = set()
    for pair, statements in by_pair.items():
        if len(pair) == 1:
            raise InputError(f"{statements[0].place}: joins one end of edge {statements[0].one[0]!r} to itself.")
        if all(statement.passable for statement in statements):
            ways.add(pair)
        elif any(statement.passable for statement in statements):
            remark = "is stated both as passable and as not passable; taken as not passable"
            notes.append(Note("doubtful", statements[-1].place, remark))
    return ways


def _groups(edges: Sequence[str], relations: Iterable[Relation], ways: set[Pair]) -> list[frozenset[End]]:
    """Return the groups of ends that meet, in the order of the edges; an end without a way to another is a group."""
    led = {end for pair in ways for end in pair}
    beside: dict[End, set[End]] = {(edge, end): set() for edge in edges for end in (0, 1)}
    for relation in relations:
        if {relation.one, relation.other} <= led:
            beside[relation.one].add(relation.other)
            beside[relation.other].add(relation.one)
    groups: list[frozenset[End]] = []
    seen: set[End] = set()
    for start in beside:
        if start not in seen:
            group = _reached(start, beside)
            seen |= group
            groups.append(group)
    return groups


def _reached(start: End, beside: Mapping[End, set[End]]) -> frozenset[End]:
    reached, waiting = {start}, [start]
    while waiting:
        new = beside[waiting.pop()] - reached
        reached |= new
        waiting += new
    return frozenset(reached)


def _node(ends: Sequence[End], meeting: Sequence[Relation], naming: Naming, place: str) -> Node:
    edges = [edge for edge, _ in ends]
    if len(set(edges)) < len(edges):
        twice = next(edge for edge in edges if edges.count(edge) > 1)
        raise InputError(f"{place}: both ends of edge {twice!r} meet at one node; divide it into two edges.")
    where = next((found for found in map(naming.coordinates, ends) if found is not None), (None, None))
    return made(Node, place, id=naming.node(ends, meeting), longitude_deg=where[0], latitude_deg=where[1])


def _joint(
    node: str, ends: frozenset[End], ways: set[Pair], sides: Sides, place: str, notes: list[Note]
) -> Iterator[Switch | Crossing]:
    if len(ends) < 3:
        return
    pairs = [pair for pair in map(frozenset, combinations(sorted(ends), 2)) if pair in ways]
    stems = [end for end in ends if all(end in pair for pair in pairs)]
    if len(ends) == 3 and len(stems) == 1:
        one, other = sorted(ends - set(stems))
        branches = sides(stems[0], one, other)
        if branches is not None:
            names = dict(zip(("stem", "left", "right"), (stems[0][0], branches[0][0], branches[1][0]), strict=True))
            yield made(Switch, place, id=node, node=node, **names)
            return
        notes.append(Note("not carried over", place, "which branch is left is not known; the switch is a crossing"))
    movements = sorted(tuple(sorted(edge for edge, _ in pair)) for pair in pairs)
    yield made(Crossing, place, id=node, node=node, movements=tuple(movements))


def _inside(relations: Iterable[Relation], groups: Sequence[frozenset[End]]) -> tuple[list[list[Relation]], list[Note]]:
    """Return the relations within each group, and notes on relations to an end with a node of its own (never passable)."""
    index_of = {end: index for index, group in enumerate(groups) for end in group}
    inside: list[list[Relation]] = [[] for _ in groups]
    apart = "ends that meet without a way between them; kept apart"
    notes = []
    for relation in relations:
        index = index_of[relation.one]
        if index == index_of[relation.other]:
            inside[index].append(relation)
        else:
            notes.append(Note("not carried over", relation.place, apart))
    return inside, notes


def _refuse_same_names(nodes: Sequence[Node]) -> None:
    names = [node.id for node in nodes]
    twice = [name for name, count in Counter(names).items() if count > 1]
    if twice:
        raise InputError(f"node {twice[0]!r}: two places where edges meet have this name.")
