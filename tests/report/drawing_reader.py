"""Reads a drawing as a person does: scales from the numbers at the ticks, marks by kind, words."""

from __future__ import annotations

import re
from collections.abc import Callable
from xml.etree import ElementTree

Drawing = ElementTree.Element
Reader = Callable[[float], float]
NUMBER = re.compile("^[-\N{MINUS SIGN}]?[0-9.]+$")
MARGIN = 150
"""Everything left of it stands beside an upright axis."""


def drawing(svg: str) -> Drawing:
    """The parsed drawing; ParseError where it is no XML."""
    return ElementTree.fromstring(svg)


def words(of: Drawing) -> list[str]:
    """Every text, in order."""
    return [str(one.text) for one in of.findall(".//{*}text") if one.text]


def kinds(of: Drawing, kind: str) -> list[Drawing]:
    """Elements that carry a class."""
    return [one for one in of.iter() if kind in str(one.get("class")).split()]


def _value(text: str) -> float:
    return float(text.replace("\N{MINUS SIGN}", "-"))


def _through(ticks: list[tuple[float, float]]) -> Reader:
    """Place on the page -> value, by the outermost ticks."""
    (x0, v0), (x1, v1) = min(ticks), max(ticks)
    return lambda x: v0 + (x - x0) * (v1 - v0) / (x1 - x0)


def across(of: Drawing, number: int = 0) -> Reader:
    """The scale of an axis across the page, counted from the top."""
    rows: dict[str, list[tuple[float, float]]] = {}
    for one in of.findall(".//{*}text"):
        if one.get("text-anchor") == "middle" and NUMBER.match(str(one.text)) and not one.get("style"):
            rows.setdefault(str(one.get("y")), []).append((float(str(one.get("x"))), _value(str(one.text))))
    axes = [row for _, row in sorted(rows.items(), key=lambda pair: float(pair[0])) if _is_scale(row)]
    return _through(axes[number])


def _is_scale(row: list[tuple[float, float]]) -> bool:
    """Three numbers at least, evenly spaced in place and value: names of switches are not."""
    steps = [(b[0] - a[0], b[1] - a[1]) for a, b in zip(sorted(row), sorted(row)[1:], strict=False)]
    return len(row) >= 3 and all(abs(x - steps[0][0]) < 0.2 and abs(v - steps[0][1]) < 1e-6 for x, v in steps)


def upright(of: Drawing, number: int = 0) -> Reader:
    """The scale of an upright axis, counted from the top: each begins with the highest value."""
    panels: list[list[tuple[float, float]]] = []
    ticks = [(float(str(one.get("y"))) - 4, _value(str(one.text))) for one in of.findall(".//{*}text")
             if one.get("text-anchor") == "end" and NUMBER.match(str(one.text)) and float(str(one.get("x"))) < MARGIN]  # fmt: skip
    for y, value in sorted(ticks):
        if not panels or value > panels[-1][-1][1]:
            panels.append([])
        panels[-1].append((y, value))
    return _through(panels[number])


def points(path: Drawing) -> list[tuple[float, float]]:
    """The points of a line, polygon, or cross (its middle)."""
    if path.tag.endswith("polygon"):
        return [(float(x), float(y)) for x, y in (pair.split(",") for pair in str(path.get("points")).split())]
    if path.tag.endswith("circle"):
        return [(float(str(path.get("cx"))), float(str(path.get("cy"))))]
    found = re.findall(r"[ML](-?[\d.]+) (-?[\d.]+)", str(path.get("d")))
    return [(float(x), float(y)) for x, y in found]


def begin(path: Drawing) -> float:
    """Where a shape that is drawn with moves begins, across the page."""
    if path.tag.endswith("rect"):
        return float(str(path.get("x")))
    return points(path)[0][0]


def end(box: Drawing) -> float:
    """Where a box ends, across the page."""
    return begin(box) + float(str(box.get("width")))
