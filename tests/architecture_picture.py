"""Draw the rooms of the code and who imports whom: `python -m tests.architecture_picture` writes docs/architecture.svg.

A room stands above all that it imports. An arrow that a chain of other arrows implies is left out; each box names all
that its room imports. Where rooms import each other in a circle, the arrow with the fewest imports runs upwards, dashed and
along the right edge.
"""

from __future__ import annotations

import html
import itertools
import textwrap
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass

import networkx as nx

from tests.rooms import ROOT, arrows, heights, rooms, upward

PICTURE = ROOT / "docs" / "architecture.svg"
COMMAND = "python -m tests.architecture_picture"
BOX_WIDTH, LANE_WIDTH, UP_WIDTH, GAP, MARGIN = 200, 20, 8, 20, 20
NAME_HEIGHT, LINE_HEIGHT, BETWEEN_ROWS = 28, 15, 64
LETTERS = 32
"""So many fit on one line of a box."""
ROUNDS = 24
"""In each of which rows are ordered anew by where their neighbours stand."""
STYLE = (
    "text{font:12px sans-serif;fill:#222}.name{font:bold 15px sans-serif}"
    "rect{fill:#f4f6f8;stroke:#4a5a68}path{fill:none;stroke:#0072b2;stroke-width:1.5}.up{stroke:#d55e00;stroke-dasharray:5 4}"
    "@media(prefers-color-scheme:dark){text{fill:#e6e6e6}rect{fill:#22282e;stroke:#8aa0b4}path{stroke:#56b4e9}}"
)
Stop = tuple[str, str, int]
"""What stands in a row: a room (its name, empty, its row), or the lane of an arrow from room to room past a row."""


def stops(graph: nx.DiGraph[str]) -> dict[tuple[str, str], list[Stop]]:
    """Each arrow with where it begins, the lanes that it runs through, and where it ends."""
    height = heights(graph)
    return {
        (above, below): [
            (above, "", height[above]),
            *((above, below, row) for row in range(height[above] - 1, height[below], -1)),
            (below, "", height[below]),
        ]
        for above, below in arrows(graph)
    }


def rows(graph: nx.DiGraph[str], ways: Iterable[list[Stop]]) -> list[list[Stop]]:
    """The rows from below, each ordered so that arrows run nearly straight."""
    height, ways = heights(graph), list(ways)
    every = {(room, "", height[room]) for room in graph} | {stop for way in ways for stop in way}
    found = [sorted(stop for stop in every if stop[2] == row) for row in range(max(height.values()) + 1)]
    near: dict[Stop, set[Stop]] = {stop: set() for stop in every}
    for way in ways:
        for one, other in itertools.pairwise(way):
            near[one].add(other)
            near[other].add(one)
    for turn in range(ROUNDS):
        for row in found if turn % 2 else found[::-1]:
            place = centres(found)
            row.sort(key=lambda stop: (_mean([place[one] for one in near[stop]], place[stop]), stop))
    return found


def _mean(values: list[int], otherwise: int) -> float:
    return sum(values) / len(values) if values else otherwise


def width(stop: Stop) -> int:
    """A room's box is wide, an arrow's lane is not."""
    return LANE_WIDTH if stop[1] else BOX_WIDTH


def centres(found: list[list[Stop]]) -> dict[Stop, int]:
    """How far to the right the middle of everything lies; rows are centred over each other."""
    lengths = [sum(width(stop) + GAP for stop in row) - GAP for row in found]
    places: dict[Stop, int] = {}
    for row, length in zip(found, lengths, strict=True):
        at = MARGIN + (max(lengths) - length) // 2
        for stop in row:
            places[stop] = at + width(stop) // 2
            at += width(stop) + GAP
    return places


def words(graph: nx.DiGraph[str], room: str) -> list[str]:
    """What a box says under its name; a new file alone changes nothing in the picture."""
    named = ", ".join(sorted(graph.successors(room))) or "nothing"
    return textwrap.wrap(f"imports {named}", LETTERS)


def tall(graph: nx.DiGraph[str], row: Iterable[Stop]) -> int:
    """The height of a row's tallest box."""
    return NAME_HEIGHT + LINE_HEIGHT * max(len(words(graph, stop[0])) for stop in row if not stop[1])


@dataclass(frozen=True)
class _Ends:
    """Where each row of boxes begins and ends, from the top of the page; the lowest row stands last."""

    top: Mapping[int, int]
    bottom: Mapping[int, int]


def _ends(graph: nx.DiGraph[str], found: list[list[Stop]]) -> _Ends:
    at, top, bottom = MARGIN, dict[int, int](), dict[int, int]()
    for number in range(len(found) - 1, -1, -1):
        top[number], bottom[number] = at, at + tall(graph, found[number])
        at = bottom[number] + BETWEEN_ROWS
    return _Ends(top, bottom)


def drawn() -> str:
    """The whole picture as SVG text."""
    graph = rooms()
    ways = stops(graph)
    found = rows(graph, ways.values())
    centre, ends = centres(found), _ends(graph, found)
    right = max(centre[stop] + width(stop) // 2 for row in found for stop in row) + MARGIN
    lines = [*_upwards(graph, centre, ends, right), *(_arrow(way, centre, ends) for way in ways.values())]
    boxes = [line for row in found for stop in row if not stop[1] for line in _box(graph, stop, centre[stop], ends)]
    head = _head(right + len(upward(graph)) * UP_WIDTH, ends.bottom[0] + MARGIN)
    return "\n".join([*head, *lines, *boxes, "</svg>", ""])


def _head(right: int, bottom: int) -> Iterator[str]:
    size = f'width="{right}" height="{bottom}" viewBox="0 0 {right} {bottom}"'
    yield f'<svg xmlns="http://www.w3.org/2000/svg" {size} role="img" aria-label="rooms of the code and their imports">'
    yield f"<style>{STYLE}</style>"
    yield (
        '<defs><marker id="tip" viewBox="0 0 8 8" refX="8" refY="4" markerWidth="8" markerHeight="8" orient="auto">'
        '<path d="M0 0 8 4 0 8"/></marker></defs>'
    )


def _arrow(way: list[Stop], centre: Mapping[Stop, int], ends: _Ends) -> str:
    path = f"M{centre[way[0]]} {ends.bottom[way[0][2]]}"
    for one, other in itertools.pairwise(way):
        begin, end = ends.bottom[one[2]], ends.top[other[2]]
        middle = (begin + end) // 2
        path += f"C{centre[one]} {middle} {centre[other]} {middle} {centre[other]} {end}"
        path += f"V{ends.bottom[other[2]]}" if other[1] else ""
    return f'<path d="{path}" marker-end="url(#tip)"/>'


def _upwards(graph: nx.DiGraph[str], centre: Mapping[Stop, int], ends: _Ends, right: int) -> Iterator[str]:
    """The arrows that close a circle: through the space between rows to a lane of their own beside all boxes."""
    height, found = heights(graph), upward(graph)
    for number, (one, other) in enumerate(found):
        begin, end = (one, "", height[one]), (other, "", height[other])
        beside = BOX_WIDTH // 8 + number % 8 * BOX_WIDTH // 24
        aside = BETWEEN_ROWS // 6 + number * BETWEEN_ROWS * 2 // 3 // len(found)
        upper, lower = ends.top[begin[2]], ends.bottom[end[2]]
        path = f"M{centre[begin] + beside} {upper}V{upper - aside}H{right + number * UP_WIDTH}"
        path += f"V{lower + aside}H{centre[end] + beside}V{lower}"
        yield f'<path class="up" d="{path}" marker-end="url(#tip)"/>'


def _box(graph: nx.DiGraph[str], stop: Stop, centre: int, ends: _Ends) -> Iterator[str]:
    left, upper, lower = centre - BOX_WIDTH // 2, ends.top[stop[2]], ends.bottom[stop[2]]
    yield f'<rect x="{left}" y="{upper}" width="{BOX_WIDTH}" height="{lower - upper}" rx="6"/>'
    yield f'<text class="name" x="{left + 10}" y="{upper + 20}">{html.escape(stop[0])}</text>'
    for number, line in enumerate(words(graph, stop[0]), 1):
        yield f'<text x="{left + 10}" y="{upper + 20 + number * LINE_HEIGHT}">{html.escape(line)}</text>'


if __name__ == "__main__":
    PICTURE.write_text(drawn(), encoding="utf-8")
    print(f"{PICTURE.relative_to(ROOT)} is drawn.")
