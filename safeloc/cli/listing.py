"""`safeloc list`: machines, properties, assumptions, shared terms, folded cases, lines, and requirements traced both ways."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass
from textwrap import shorten
from typing import Annotated, Any

import typer

from safeloc.assurance.independence import Shared, follows_machine, shared_terms
from safeloc.assurance.mutation.strength import Strength, as_data, as_text, strengths_of
from safeloc.assurance.register import Assumption, of_border, register, to_confirm
from safeloc.assurance.requirements import Item, Link, traceability
from safeloc.assurance.source_places import Place
from safeloc.assurance.splits.covered import Covered, covered, folder_of
from safeloc.assurance.splits.deciding import Change
from safeloc.assurance.splits.observed import Split
from safeloc.assurance.splits.places import source_of
from safeloc.catalogue import ENTRIES, Target, load_target
from safeloc.cli.console import out, print_json
from safeloc.cli.keeping import CacheOption, store_in
from safeloc.errors import InputError
from safeloc.language.spec import Property
from safeloc.proof.cache.store import Store

_SHOWN = 3
_TERM_CHARACTERS = 200
_NO_REASON = "no reason is declared"
_HIDDEN = "live in no configuration"
_Listed = tuple[Any, Sequence[str]]
"""Data for JSON, and the same as lines of text."""


@dataclass(frozen=True)
class _Chosen:
    """A filter for properties: by machine (all if none is named), by requirement and by text."""

    machines: Sequence[str]
    requirement: str | None
    text: str | None

    def __bool__(self) -> bool:
        return bool(self.machines) or self.by_text

    @property
    def by_text(self) -> bool:
        """Return whether properties are chosen by requirement or text."""
        return self.requirement is not None or self.text is not None

    def lists(self, prop: Property) -> bool:
        """Return whether the filter accepts a property; case is ignored."""
        requirements = {one.casefold() for one in prop.requirements}
        words = f"{prop.name}\n{prop.statement}".casefold()
        return (self.requirement is None or self.requirement.casefold() in requirements) and (
            self.text or ""
        ).casefold() in words

    def in_words(self) -> str:
        """Return the filter in words, for a message."""
        machines = f" of {', '.join(self.machines)}" if self.machines else ""
        requirement = f" verifies requirement {self.requirement!r}" if self.requirement is not None else ""
        text = f" has {self.text!r} in its name or statement" if self.text is not None else ""
        return f"{machines}{' and'.join(part for part in (requirement, text) if part) or ' is declared'}"


def list_(
    what: Annotated[
        str, typer.Argument(help="machines, properties, assumptions, shared, splits, requirements or lines")
    ] = "machines",
    machines: Annotated[
        list[str] | None,
        typer.Option("--machine", help="only this machine, shipped or your own (repeatable)"),
    ] = None,
    requirement: Annotated[
        str | None, typer.Option("--id", help="only properties that verify this requirement, such as MRK-D1")
    ] = None,
    text: Annotated[
        str | None, typer.Option("--text", help="only properties with this text in name or statement")
    ] = None,
    cache: CacheOption = None,
    as_json: Annotated[bool, typer.Option("--json", help="print JSON only")] = False,
) -> None:
    """List machines, properties, lines, or requirements with the transitions and properties that implement and verify them.

    `assumptions` is the register of all assumptions of the proofs. `shared` lists the sub-terms that claims and clauses
    have in common with their machine: a wrong edit of such a term changes both. `splits` lists the cases that the default
    configuration folds away, and the configurations in which they are live.
    """
    chosen = _Chosen(machines or (), requirement, text)
    kinds: Mapping[str, Callable[[], _Listed]] = {
        "machines": _machines,
        "properties": lambda: _properties(chosen),
        "assumptions": lambda: _assumptions(chosen),
        "shared": lambda: _shared(chosen),
        "splits": lambda: _splits(chosen),
        "requirements": lambda: _requirements(store_in(cache)),
        "lines": _shipped_lines,
    }
    if what not in kinds:
        raise typer.BadParameter(f"{what!r}: choose one of {', '.join(kinds)}.")
    if chosen.by_text and what != "properties":
        raise typer.BadParameter(f"--id and --text filter properties, not {what}.")
    if chosen and what not in ("properties", "assumptions", "shared", "splits"):
        raise typer.BadParameter(f"--machine filters properties, assumptions, shared terms or splits, not {what}.")
    data, lines = kinds[what]()
    if as_json:
        print_json(data)
        return
    for line in lines:
        out.print(line, markup=False)


def _machines() -> _Listed:
    rows = [{"name": entry.name, "summary": entry.summary} for entry in ENTRIES.values()]
    return rows, _lines(rows)


def _properties(chosen: _Chosen) -> _Listed:
    """Return the chosen properties. InputError if there is none."""
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
        raise InputError(f"no property{chosen.in_words()}; `safeloc list properties` lists all.")
    return rows, _lines(rows)


def _assumptions(chosen: _Chosen) -> _Listed:
    """Return the register: every law with its figures, owner and missing fields."""
    targets = list(map(load_target, dict.fromkeys(chosen.machines or ENTRIES)))
    found = [(target.name, one) for target in targets for one in register(target)]
    found += [("every target on records", of_border())]
    figures = to_confirm(targets)
    lines = [line for target, one in found for line in _assumption_lines(target, one)]
    seen = sum(one.observable != "no" or bool(one.against) for _, one in found)
    lines += [
        f"{len(found)} assumptions, {seen} of them observable in operation; {len(figures)} figures are from memory: the "
        "operator has to confirm them."
    ]
    data = {
        "assumptions": [{"target": target, **asdict(one), "lacks": list(one.lacks)} for target, one in found],
        "to_confirm": {name: asdict(one) for name, one in figures.items()},
    }
    return data, lines


def _assumption_lines(target: str, one: Assumption) -> Iterator[str]:
    yield f"{target}  {one.id}  {one.name}{'  (guaranteed by another machine)' if one.guaranteed else ''}"
    for figure in one.figures:
        yield f"    {figure.name} = {figure.value} {figure.unit}  {figure.source}"
    fields = {"statement": one.statement, "source": one.source, "owner": one.owner, "check": one.check}
    fields["observable"] = one.monitored
    yield from (f"    {field}: {words}" for field, words in fields.items() if words)
    if one.lacks:
        yield f"    missing: {', '.join(one.lacks)}"


def _shared(chosen: _Chosen) -> _Listed:
    """Return the sub-terms that claims and clauses share with rows, and the clauses that read computed values of their machine."""
    targets = list(map(load_target, dict.fromkeys(chosen.machines or ENTRIES)))
    shared = [{"machine": target.name, **asdict(one)} for target in targets for one in shared_terms(target)]
    follows = [{"machine": target.name, **asdict(one)} for target in targets for one in follows_machine(target)]
    lines = [line for target in targets for line in _shared_lines(target)]
    for one in follows:
        lines += [
            f"{one['machine']}  {one['of']}  reads {_first_few(one['reads'])}",
            f"    because       {one['reason']}",
        ]
    return {"shared": shared, "reads_machine": follows}, lines or ["nothing is shared."]


def _shared_lines(target: Target) -> Iterator[str]:
    """Return lines for each shared term: rows and outputs that the machine computes with it, claims and clauses that have it."""
    by_term: dict[str, list[Shared]] = {}
    for one in shared_terms(target):
        by_term.setdefault(one.term, []).append(one)
    for term, speakers in sorted(by_term.items(), key=lambda item: -item[1][0].nodes):
        yield f"{target.name}  {speakers[0].nodes} nodes  {shorten(term, _TERM_CHARACTERS, placeholder=' ...')}"
        yield f"    computed for  {_first_few(speakers[0].used)}"
        yield f"    shared by     {_first_few(list(dict.fromkeys(one.of for one in speakers)))}"
        yield from (f"    because       {one}" for one in dict.fromkeys(one.reason or _NO_REASON for one in speakers))


def _first_few(names: Sequence[str]) -> str:
    """Return the first three names, and the number of further ones; the JSON has all of them."""
    more = f" and {len(names) - _SHOWN} more" if len(names) > _SHOWN else ""
    return ", ".join(names[:_SHOWN]) + more


def _splits(chosen: _Chosen) -> _Listed:
    """Return the cases that the defaults of a machine fold away, each with the configurations in which it is live."""
    unknown = [name for name in chosen.machines if name not in ENTRIES]
    if unknown:
        raise InputError(f"no shipped machine {unknown[0]!r}; cases are looked for in {', '.join(ENTRIES)}.")
    folders = dict.fromkeys(map(folder_of, chosen.machines or ENTRIES))
    rows = [row for folder in folders for row in _split_rows(covered(folder))]
    lines = [f"{row['split']}  {row['at']}  {row['source']}\n    {row['folded']}; {row['live']}" for row in rows]
    hidden = sum(row["live"] == _HIDDEN for row in rows)
    return rows, [
        *lines,
        f"{len(rows)} cases are folded away by defaults; {hidden} of them are live in no configuration.",
    ]


def _split_rows(found: Covered) -> Iterator[dict[str, str]]:
    """Return each case once, even if its expression is used often; for a hidden case, a figure that would make it live."""
    rows: dict[tuple[str, Place, str], dict[str, str]] = {}
    figures = found.figures()
    for split, why in sorted(found.folded().items(), key=lambda pair: pair[0].place):
        live = [f"{target}, {name}" for target, name in found.live_in(split)]
        where = f"live in {_first_few(live)}" if live else _not_live(found, split, figures)
        row = {
            "split": split.kind,
            "at": str(split.place),
            "source": source_of(split.place),
            "folded": why,
            "live": where,
        }
        rows.setdefault((split.kind, split.place, where), row)
    yield from rows.values()


def _not_live(found: Covered, split: Split, figures: Mapping[Split, Change]) -> str:
    if split in found.never:
        return f"never live: {found.never[split]}"
    if split in found.shared:
        return "in a folder that several machines use"
    return (
        f"{_HIDDEN}; {figures[split]} makes it live"
        if split in figures
        else f"{_HIDDEN}; no figure alone makes it live"
    )


def _shipped_lines() -> _Listed:
    from safeloc.railway.map.toml_files import load_line, shipped_lines  # loaded only if lines are listed

    lines = [load_line(path) for path in shipped_lines().values()]
    rows = [{"name": line.name, "version": line.version, "source": line.source} for line in lines]
    return rows, _lines(rows)


def _lines(rows: Sequence[dict[str, str]]) -> list[str]:
    return ["  ".join(value for value in row.values() if value) for row in rows]


def _requirements(store: Store) -> _Listed:
    """Return every requirement with its transitions, properties and their strength, and the links back."""
    targets = [load_target(name) for name in ENTRIES]
    traced, found = traceability(targets), strengths_of(store, targets)
    data = {
        "requirements": [
            {
                **asdict(link.requirement),
                "transitions": link.transitions,
                "properties": link.properties,
                "strength": as_data(found.get(link.requirement.id, [])),
            }
            for link in traced.links
        ],
        "items": [asdict(item) for item in traced.items],
        "gaps": traced.gaps,
    }
    lines = [line for link in traced.links for line in _link_lines(link, found.get(link.requirement.id, []))]
    lines += [
        "",
        "Reverse traceability, from transitions and properties to requirements:",
        *map(_item_line, traced.items),
    ]
    lines += ["", *(f"gap: {gap}" for gap in traced.gaps or ("none",))]
    return data, lines


def _link_lines(link: Link, found: Sequence[Strength]) -> list[str]:
    one = link.requirement
    lines = [f"{one.id}  {one.status}  {one.machine}  {one.text}"]
    lines += [f"    transition  {name}" for name in link.transitions]
    lines += [f"    property    {name}" for name in link.properties]
    if link.transitions:
        lines += [f"    strength    {text}" for text in as_text(found)]
    return lines + ([f"    test        {one.carried_by}"] if one.carried_by else [])


def _item_line(item: Item) -> str:
    return f"{item.kind:10}  {item.label}  {' '.join(item.requirements) or '-'}"
