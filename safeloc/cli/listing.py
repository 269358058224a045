"""`safeloc list`: machines, properties, shipped lines, and requirements with what carries and shows them, both ways."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict, dataclass
from typing import Annotated, Any

import typer

from safeloc.assurance.requirements import Item, Link, traceability
from safeloc.catalogue import ENTRIES, load_target
from safeloc.cli.console import out, print_json
from safeloc.errors import InputError
from safeloc.language.spec import Property

Listed = tuple[Any, Sequence[str]]
"""Data for JSON, and the same as lines."""


@dataclass(frozen=True)
class _Chosen:
    """Which properties are listed: of these machines (all without any), with this requirement and this text, if told."""

    machines: Sequence[str]
    requirement: str | None
    text: str | None

    def __bool__(self) -> bool:
        return bool(self.machines) or self.requirement is not None or self.text is not None

    def lists(self, prop: Property) -> bool:
        """Whether a property is one of them; capital letters are like small ones."""
        answers = {one.casefold() for one in prop.requirements}
        said = f"{prop.name}\n{prop.statement}".casefold()
        return (self.requirement is None or self.requirement.casefold() in answers) and (
            self.text or ""
        ).casefold() in said

    def told(self) -> str:
        """What was asked for, for a message."""
        machines = f" of {', '.join(self.machines)}" if self.machines else ""
        requirement = f" answers for requirement {self.requirement!r}" if self.requirement is not None else ""
        text = f" says {self.text!r} in its name or statement" if self.text is not None else ""
        return f"{machines}{' and'.join(part for part in (requirement, text) if part) or ' is declared'}"


def list_(
    what: Annotated[str, typer.Argument(help="machines, properties, requirements or lines")] = "machines",
    machines: Annotated[
        list[str] | None,
        typer.Option("--machine", help="properties of this machine only, also one of your own (repeatable)"),
    ] = None,
    requirement: Annotated[
        str | None, typer.Option("--id", help="properties only that answer for this requirement, such as MRK-D1")
    ] = None,
    text: Annotated[
        str | None, typer.Option("--text", help="properties only with this text in name or statement")
    ] = None,
    as_json: Annotated[bool, typer.Option("--json", help="print JSON only")] = False,
) -> None:
    """List machines, properties, requirements with the transitions and properties that answer for them, or lines."""
    chosen = _Chosen(machines or (), requirement, text)
    kinds: Mapping[str, Callable[[], Listed]] = {
        "machines": _machines,
        "properties": lambda: _properties(chosen),
        "requirements": _requirements,
        "lines": _shipped_lines,
    }
    if what not in kinds:
        raise typer.BadParameter(f"{what!r}: choose one of {', '.join(kinds)}.")
    if chosen and what != "properties":
        raise typer.BadParameter(f"--machine, --id and --text choose among properties, and {what} are asked for.")
    data, lines = kinds[what]()
    if as_json:
        print_json(data)
        return
    for line in lines:
        out.print(line, markup=False)


def _machines() -> Listed:
    rows = [{"name": entry.name, "summary": entry.summary} for entry in ENTRIES.values()]
    return rows, _lines(rows)


def _properties(chosen: _Chosen) -> Listed:
    """Those chosen; only the machines that are asked for are made. InputError where there is none."""
    rows = [
        {
            "machine": target.name,
            "name": prop.name,
            "requirements": " ".join(prop.requirements),
            "statement": prop.statement,
        }
        for target in map(load_target, dict.fromkeys(chosen.machines or ENTRIES))
        for prop in target.properties
        if chosen.lists(prop)
    ]
    if not rows:
        raise InputError(f"no property{chosen.told()}; `safeloc list properties` lists all.")
    return rows, _lines(rows)


def _shipped_lines() -> Listed:
    from safeloc.railway.map.toml_files import load_line, shipped_lines  # maps are read only where they are listed

    lines = [load_line(path) for path in shipped_lines().values()]
    rows = [{"name": line.name, "version": line.version, "source": line.source} for line in lines]
    return rows, _lines(rows)


def _lines(rows: Sequence[dict[str, str]]) -> list[str]:
    return ["  ".join(value for value in row.values() if value) for row in rows]


def _requirements() -> Listed:
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
