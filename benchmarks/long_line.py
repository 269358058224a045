"""A double-track line of any length that keeps every rule: crossovers both ways in every block, balises, reflectors."""

from __future__ import annotations

from collections.abc import Iterator

from safeloc.railway.map.elements import Balise, BaliseGroup, KilometrePoint, Node, Reflector, Switch, TrackEdge
from safeloc.railway.map.model import Line

BLOCK_MM = 2_000_000
MODELS = "ABCD"
FIRST_TRACK_MM = (60_000, 400_000, 740_000, 1_080_000, 1_420_000, 1_760_000)
SECOND_TRACK_MM = (90_000, 430_000, 770_000, 1_095_000, 1_450_000, 1_790_000)
ELEMENTS_PER_BLOCK = 28
"""4 nodes, 6 edges, 4 switches, 2 balise groups, 12 reflectors."""


def long_line(blocks: int) -> Line:
    """Two tracks of `blocks` x 2 km, both run eastwards; the number of routes doubles with every block."""
    every = range(blocks)
    ends = (f"s{blocks}", f"m{blocks}")
    return Line(
        name=f"long-{blocks}",
        version="1",
        nodes=(
            *(node for block in every for node in _nodes(block)),
            *(Node(id=one) for one in (*ends, "west-1", "west-2")),
        ),
        edges=(*_approach(), *(edge for block in every for edge in _edges(block))),
        switches=tuple(switch for block in every for switch in _switches(block)),
        balise_groups=tuple(group for block in every for group in _groups(block)),
        reflectors=tuple(reflector for block in every for reflector in _reflectors(block)),
    )


def _approach() -> Iterator[TrackEdge]:
    """100 m before the first block."""
    for edge, start, end, length in (("b-1", "west-1", "s0", 100_000), ("d-1", "west-2", "m0", 150_000)):
        counted = (KilometrePoint(kilometre_mm=-100_000),)
        yield TrackEdge(
            id=edge, from_node=start, to_node=end, length_mm=length, travel="increasing", kilometres=counted
        )


def _nodes(block: int) -> Iterator[Node]:
    return (Node(id=f"{kind}{block}") for kind in "sqmn")


def _edges(block: int) -> Iterator[TrackEdge]:
    shape = (
        ("a", f"s{block}", f"q{block}", 0, 1_050_000),
        ("b", f"q{block}", f"s{block + 1}", 1_050_000, 950_000),
        ("c", f"m{block}", f"n{block}", 50_000, 950_000),
        ("d", f"n{block}", f"m{block + 1}", 1_000_000, 1_050_000),
        ("x", f"s{block}", f"m{block}", 0, 50_000),
        ("y", f"n{block}", f"q{block}", 1_000_000, 50_000),
    )
    for kind, start, end, begins, length in shape:
        counted = (KilometrePoint(kilometre_mm=block * BLOCK_MM + begins),)
        yield TrackEdge(
            id=f"{kind}{block}",
            from_node=start,
            to_node=end,
            length_mm=length,
            travel="increasing",
            kilometres=counted,
        )


def _switches(block: int) -> Iterator[Switch]:
    before = block - 1
    shape = (
        ("s", f"b{before}", f"a{block}", f"x{block}"),
        ("m", f"c{block}", f"d{before}", f"x{block}"),
        ("q", f"b{block}", f"a{block}", f"y{block}"),
        ("n", f"c{block}", f"d{block}", f"y{block}"),
    )
    for kind, stem, left, right in shape:
        yield Switch(id=f"{kind}{block}", node=f"{kind}{block}", stem=stem, left=left, right=right)


def _groups(block: int) -> Iterator[BaliseGroup]:
    for track, edge, place in ((1, "a", 10_000), (2, "c", 5_000)):
        balises = (Balise(position_mm=place), Balise(position_mm=place + 3_000))
        identity = 2 * block + track
        yield BaliseGroup(
            id=str(identity), edge=f"{edge}{block}", identity=identity, balises=balises, location_accuracy_mm=300
        )


def _reflectors(block: int) -> Iterator[Reflector]:
    for index, place in enumerate(FIRST_TRACK_MM):
        edge, start = ("a", 0) if place < 1_050_000 else ("b", 1_050_000)
        yield _reflector(f"1-{block}-{index}", f"{edge}{block}", place - start, 6 * block + index)
    for index, place in enumerate(SECOND_TRACK_MM):
        edge, start = ("c", 50_000) if place < 1_000_000 else ("d", 1_000_000)
        yield _reflector(f"2-{block}-{index}", f"{edge}{block}", place - start, 6 * block + index + 1)


def _reflector(identity: str, edge: str, position_mm: int, number: int) -> Reflector:
    return Reflector(
        id=identity,
        edge=edge,
        position_mm=position_mm,
        model=MODELS[number % len(MODELS)],
        direction="increasing",
        view_from_mm=100_000,
        view_to_mm=3_000,
    )
