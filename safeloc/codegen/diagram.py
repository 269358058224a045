"""A machine as a picture and as a table: Mermaid, DOT, a self-contained SVG, and rows for a report."""

from __future__ import annotations

import html
import math
from collections.abc import Iterable
from dataclasses import dataclass

from safeloc.language.machine import Machine
from safeloc.language.transition_rows import transition_rows


def to_table_text(machines: Iterable[Machine]) -> str:
    """Return the tables of machines as text: a line for each transition, with tabs between its cells; updates are left out."""
    cells = (
        (row.name, row.source, row.target, row.guard, " ".join(row.requirements), row.declared)
        for machine in machines
        for row in transition_rows(machine)
    )
    return "\n".join(map("\t".join, cells)) + "\n"


def edges(machine: Machine) -> dict[tuple[str, str], list[str]]:
    """Return the names of the transitions, in order, by their (source, target)."""
    found: dict[tuple[str, str], list[str]] = {}
    for t in machine.transitions:
        for source in t.sources:
            found.setdefault((source.label, t.target.label), []).append(t.name)
    return found


def to_mermaid(machine: Machine) -> str:
    """Return a Mermaid state diagram."""
    lines = ["stateDiagram-v2", f"    [*] --> {_word(machine.modes[0].label)}"]
    for mode in machine.modes:
        lines.append(f'    state "{_mermaid(mode.label)}" as {_word(mode.label)}')
    for (source, target), names in edges(machine).items():
        label = "<br/>".join(_mermaid(name) for name in names)
        lines.append(f"    {_word(source)} --> {_word(target)}: {label}")
    return "\n".join(lines) + "\n"


def _word(label: str) -> str:
    return "".join(letter if letter.isalnum() else "_" for letter in label)


def _mermaid(text: str) -> str:
    return "".join(f"#{ord(letter)};" if letter in '#:;"<>{}' else letter for letter in text)


def to_dot(machine: Machine) -> str:
    """Return a Graphviz digraph."""
    lines = [
        f"digraph {_dot(machine.name)} {{",
        '  rankdir=LR; node [shape=box, style="rounded"]; start [shape=point];',
    ]
    lines.append(f"  start -> {_dot(machine.modes[0].label)};")
    for (source, target), names in edges(machine).items():
        lines.append(f"  {_dot(source)} -> {_dot(target)} [label={_dot(chr(10).join(names))}];")
    return "\n".join([*lines, "}"]) + "\n"


def _dot(text: str) -> str:
    escaped = text.replace("\\", "\\\\").replace('"', '\\"').replace("\n", "\\n")
    return f'"{escaped}"'


# ------------------------------------------------------------------ SVG

_BOX_WIDTH, _BOX_HEIGHT, _LINE, _MARGIN = 150, 40, 15, 20
_STYLE = """
.mode { fill: var(--box, #f4f7fb); stroke: #35618e; stroke-width: 1.6 }
.first { stroke-width: 3 }
.edge { fill: none; stroke: #6d7a88; stroke-width: 1.3 }
.tip { fill: #6d7a88 }
text { font: 12px system-ui, sans-serif; fill: var(--ink, #1c2733) }
.name { font-weight: 600; text-anchor: middle }
.label { font-size: 11px }
.halo { paint-order: stroke; stroke: var(--page, #fff); stroke-width: 4px }
"""


@dataclass(frozen=True)
class _Place:
    x: float
    y: float


def to_svg(machine: Machine) -> str:
    """Return a self-contained SVG: modes in a column, transitions as arcs beside it, numbered as in the table."""
    number = {t.name: index for index, t in enumerate(machine.transitions, 1)}
    labels = [mode.label for mode in machine.modes]
    between = {pair: [number[n] for n in names] for pair, names in edges(machine).items()}
    legend = [f"{index}  {name}" for name, index in number.items()]
    gap = 130
    column = _BOX_WIDTH / 2 + max(255, _width_beside(between, labels, side=-1) + _MARGIN)
    beside = column + _BOX_WIDTH / 2 + max(255, _width_beside(between, labels, side=1) + _MARGIN)
    height = max(len(labels) * gap + 20, len(legend) * _LINE + 60)
    places = {label: _Place(column, 60 + index * gap) for index, label in enumerate(labels)}
    body = [_arrow_edge(places, labels, pair, numbers) for pair, numbers in between.items()]
    body += [_box(places[label], label, label == labels[0]) for label in labels]
    body += [_text(beside, 40 + index * _LINE, line, "label legend") for index, line in enumerate(legend)]
    width = beside + 20 + max((len(line) for line in legend), default=0) * 6.2
    return (
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width:.0f} {height}" width="{width:.0f}" height="{height}" '
        f'role="img" aria-label="state diagram of {html.escape(machine.name)}"><style>{_STYLE}</style>'
        f"{''.join(body)}</svg>"
    )


def _width_beside(between: dict[tuple[str, str], list[int]], labels: list[str], *, side: int) -> float:
    """Return how far arcs and their numbers reach beyond the boxes: those downwards at the right (1), upwards at the left (-1)."""
    spans = {pair: side * (labels.index(pair[1]) - labels.index(pair[0])) for pair in between}
    return max(
        (0.76 * _reach(span) + _label_width(_shown(between[pair])) for pair, span in spans.items() if span > 1),
        default=0,
    )


def _reach(span: int) -> int:
    """Return how far the control points of an arc over so many modes stand from the boxes."""
    return 40 + 46 * abs(span)


def _box(place: _Place, label: str, first: bool) -> str:
    x, y = place.x - _BOX_WIDTH / 2, place.y - _BOX_HEIGHT / 2
    kind = "mode first" if first else "mode"
    rect = f'<rect class="{kind}" data-mode="{html.escape(label)}" x="{x}" y="{y}" width="{_BOX_WIDTH}" height="{_BOX_HEIGHT}" rx="8"/>'
    return rect + _text(place.x, place.y + 4, label, "name")


def _text(x: float, y: float, text: str, kind: str) -> str:
    return f'<text class="{kind}" x="{x:.0f}" y="{y:.0f}">{html.escape(text)}</text>'


def _arrow_edge(places: dict[str, _Place], labels: list[str], pair: tuple[str, str], numbers: list[int]) -> str:
    """Draw one edge: a downward edge bulges to the right, an upward one to the left, a self-loop is a small arc at the right."""
    source, target = places[pair[0]], places[pair[1]]
    shown = _shown(numbers)
    if pair[0] == pair[1]:
        x, y = source.x + _BOX_WIDTH / 2, source.y
        path = f"M{x} {y - 10} C{x + 46} {y - 30} {x + 46} {y + 30} {x} {y + 10}"
        return _edge(path, pair, _Place(x + 46, y + 30), _Place(x, y + 10)) + _text(x + 42, y + 4, shown, "label halo")
    span = labels.index(pair[1]) - labels.index(pair[0])
    side = 1 if span > 0 else -1
    reach = _reach(span)
    x1, x2 = source.x + side * _BOX_WIDTH / 2, target.x + side * _BOX_WIDTH / 2
    y1, y2 = source.y + side * 14, target.y - side * 14
    if abs(span) == 1:
        shift = side * 34
        start, end = _Place(source.x + shift, source.y + side * 20), _Place(target.x + shift, target.y - side * 20)
        path = f"M{start.x} {start.y} L{end.x} {end.y}"
        middle = _Place(source.x + shift + side * 8, (source.y + target.y) / 2 + 4)
    else:
        start, end = _Place(x2 + side * reach, y2), _Place(x2, y2)
        path = f"M{x1} {y1} C{x1 + side * reach} {y1} {start.x} {start.y} {end.x} {end.y}"
        middle = _Place(x1 + side * reach * 0.76, (y1 + y2) / 2 + 4)
    return _edge(path, pair, start, end) + _label(middle, shown, side)


def _label(place: _Place, shown: str, side: int) -> str:
    return _text(place.x if side > 0 else place.x - _label_width(shown), place.y, shown, "label halo")


def _shown(numbers: list[int]) -> str:
    return ", ".join(map(str, numbers))


def _label_width(shown: str) -> int:
    return math.ceil(len(shown) * 5.8)


def _edge(path: str, pair: tuple[str, str], before: _Place, end: _Place) -> str:
    """Return an edge that arrives at `end` from the direction of `before`, with its tip."""
    line = f'<path class="edge" data-from="{html.escape(pair[0])}" data-to="{html.escape(pair[1])}" d="{path}"/>'
    return line + _tip(before, end)


def _tip(before: _Place, end: _Place) -> str:
    """Return the tip of an arrow. It is drawn, not a marker: a marker needs an id, and a page has many diagrams."""
    length, half_width = 10, 5
    away = math.hypot(end.x - before.x, end.y - before.y)
    along_x, along_y = (end.x - before.x) / away, (end.y - before.y) / away
    x, y = end.x - length * along_x, end.y - length * along_y
    left = f"{x - half_width * along_y:.1f} {y + half_width * along_x:.1f}"
    right = f"{x + half_width * along_y:.1f} {y - half_width * along_x:.1f}"
    return f'<path class="tip" d="M{left} L{end.x} {end.y} L{right} z"/>'
