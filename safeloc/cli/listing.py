"""`safeloc list`: machines, properties, shipped lines, and requirements with what carries and shows them, both ways."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict
from typing import Annotated, Any

import typer

from safeloc.catalogue import ENTRIES, load_target
from safeloc.cli.show import out, print_json
from safeloc.line.toml_files import load_line, shipped_lines
from safeloc.requirements import Item, Link, traceability


def list_(
    what: Annotated[str, typer.Argument(help="machines, properties, requirements or lines")] = "machines",
    as_json: Annotated[bool, typer.Option("--json", help="print JSON only")] = False,
) -> None:
    """List machines, properties, requirements with the transitions and properties that answer for them, or lines."""
    kinds = {"machines": _machines, "properties": _properties, "requirements": _requirements, "lines": _shipped_lines}
    if what not in kinds:
        raise typer.BadParameter(f"{what!r}: choose one of {', '.join(kinds)}.")
    data, lines = kinds[what]()
    if as_json:
        print_json(data)
        return
    for line in lines:
        out.print(line, markup=False)


def _machines() -> tuple[Any, Sequence[str]]:
    rows = [{"name": entry.name, "summary": entry.summary} for entry in ENTRIES.values()]
    return rows, _lines(rows)


def _properties() -> tuple[Any, Sequence[str]]:
    rows = [
        {"machine": name, "name": prop.name, "requirements": " ".join(prop.trace), "statement": prop.statement}
        for name in ENTRIES
        for prop in load_target(name).properties
    ]
    return rows, _lines(rows)


def _shipped_lines() -> tuple[Any, Sequence[str]]:
    lines = [load_line(path) for path in shipped_lines().values()]
    rows = [{"name": line.name, "version": line.version, "source": line.source} for line in lines]
    return rows, _lines(rows)


def _lines(rows: Sequence[dict[str, str]]) -> list[str]:
    return ["  ".join(value for value in row.values() if value) for row in rows]


def _requirements() -> tuple[Any, Sequence[str]]:
    """From every requirement to its transitions and properties, and from each of these back."""
    traced = traceability(load_target(name) for name in ENTRIES)
    data = {
        "requirements": [
            {**asdict(link.requirement), "transitions": link.transitions, "properties": link.properties}
            for link in traced.links
        ],
        "items": [asdict(item) for item in traced.items],
        "gaps": traced.gaps,
    }
    lines = [line for link in traced.links for line in _link_lines(link)]
    lines += ["", "Back from transitions and properties:", *map(_item_line, traced.items)]
    lines += ["", *(f"gap: {gap}" for gap in traced.gaps or ("none",))]
    return data, lines


def _link_lines(link: Link) -> list[str]:
    one = link.requirement
    lines = [f"{one.id}  {one.status}  {one.machine}  {one.text}"]
    lines += [f"    transition  {name}" for name in link.transitions]
    lines += [f"    property    {name}" for name in link.properties]
    return lines + ([f"    test        {one.carried_by}"] if one.carried_by else [])


def _item_line(item: Item) -> str:
    return f"{item.kind:10}  {item.label}  {' '.join(item.requirements) or '-'}"
