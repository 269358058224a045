"""`safeloc list`: machines, properties, assumptions, shared terms, folded cases, lines, and requirements traced both ways."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import asdict
from pathlib import Path
from textwrap import shorten
from typing import Annotated, Any

import typer
from pydantic import BaseModel

from safeloc.assurance.independence import Shared, by_term, follows_machine, shared_terms
from safeloc.assurance.mutation.shipped_scores import strengths_of
from safeloc.assurance.mutation.strength import Strength, as_data, as_text
from safeloc.assurance.property_choice import PropertyChoice
from safeloc.assurance.register import Listed, register_of
from safeloc.assurance.requirements import Item, Link, traceability
from safeloc.assurance.short_lists import first_few
from safeloc.assurance.splits.folded import folded_cases
from safeloc.catalogue import ENTRIES, Target, load_target
from safeloc.cli.console import print_json, print_line
from safeloc.cli.keeping import CacheOption, store_in
from safeloc.config import figures
from safeloc.proof.cache.store import Store
from safeloc.target import recording_name

_TERM_CHARACTERS = 200
_NO_REASON = "no reason is declared"
_Listed = tuple[Any, Sequence[str]]
"""Data for JSON, and the same as lines of text."""


def list_(
    what: Annotated[
        str,
        typer.Argument(
            help="machines, properties, config, recordings, assumptions, shared, splits, requirements or lines"
        ),
    ] = "machines",
    of: Annotated[
        list[str] | None,
        typer.Argument(help="machines of which something is listed, as with --machine", show_default=False),
    ] = None,
    machines: Annotated[
        list[str] | None,
        typer.Option("--machine", help="only this machine, shipped or your own (repeatable)"),
    ] = None,
    requirement: Annotated[
        str | None, typer.Option("--id", help="only this requirement, such as MRK-D1, or the properties that verify it")
    ] = None,
    text: Annotated[
        str | None,
        typer.Option("--text", help="only requirements with this text, or properties with it in name or statement"),
    ] = None,
    config: Annotated[
        Path | None, typer.Option("--config", help="of `list config MACHINE`: the figures as this file sets them")
    ] = None,
    cache: CacheOption = None,
    as_json: Annotated[bool, typer.Option("--json", help="print JSON only")] = False,
) -> None:
    """List machines, properties, lines, or requirements with the transitions and properties that implement and verify them.

    `assumptions` is the register of all assumptions of the proofs. `shared` lists the sub-terms that claims and clauses
    have in common with their machine: a wrong edit of such a term changes both. `config` lists the figures of a machine's
    configuration with unit, default and source, `recordings` the streams that ship with it, for `safeloc replay`. `splits`
    lists the cases that the default configuration folds away, and the configurations in which they are live.
    """
    asked = [*(of or ()), *(machines or ())]
    chosen = PropertyChoice(asked, requirement, text)
    kinds: Mapping[str, Callable[[], _Listed]] = {
        "machines": _machines,
        "properties": lambda: _properties(chosen, store_in(cache)),
        "config": lambda: _config(asked, config),
        "recordings": lambda: _recordings(asked),
        "assumptions": lambda: _assumptions(asked),
        "shared": lambda: _shared(asked),
        "splits": lambda: _splits(asked),
        "requirements": lambda: _requirements(store_in(cache), requirement, text),
        "lines": _shipped_lines,
    }
    if what not in kinds:
        raise typer.BadParameter(f"{what!r}: choose one of {', '.join(kinds)}.")
    if config is not None and (what != "config" or len(set(asked)) != 1):
        raise typer.BadParameter("--config sets the figures of one machine: safeloc list config MACHINE --config FILE.")
    if chosen.by_text and what not in ("properties", "requirements"):
        raise typer.BadParameter(f"--id and --text filter properties and requirements, not {what}.")
    if asked and what not in ("properties", "config", "recordings", "assumptions", "shared", "splits"):
        raise typer.BadParameter(
            f"--machine chooses machines of which something is listed, and {what} are not of a machine."
        )
    data, lines = kinds[what]()
    if as_json:
        print_json(data)
        return
    for line in lines:
        print_line(line)


def _machines() -> _Listed:
    rows = [{"name": entry.name, "summary": entry.summary} for entry in ENTRIES.values()]
    return rows, _lines(rows)


def _properties(chosen: PropertyChoice, store: Store) -> _Listed:
    rows = [{**asdict(one), "requirements": " ".join(one.requirements)} for one in chosen.found(store)]
    return rows, _lines(rows)


def _targets(machines: Sequence[str]) -> list[Target]:
    return list(map(load_target, dict.fromkeys(machines or ENTRIES)))


def _config(machines: Sequence[str], file: Path | None) -> _Listed:
    """Return the figures of each machine's configuration as a configuration file names them, and those of other kinds.

    file  configuration of the one machine; without it the figures are the defaults
    """
    targets = _targets(machines) if file is None else [load_target(machines[0], file)]
    configured = [(target.name, target.config) for target in targets]
    others = {} if file is not None else _of_other_kinds(machines)
    rows = [
        {"machine": name, **figure}
        for name, config in [*configured, *others.items()]
        if config is not None
        for figure in figures(config)
    ]
    lines = [f"{row['machine']}  {row['name']} = {row['value']} {row['unit']}  {row['source']}" for row in rows]
    return rows, lines or ["no figures are declared."]


def _of_other_kinds(machines: Sequence[str]) -> dict[str, BaseModel]:
    """Return the configurations that have sources of their own, by machine and name."""
    entries = [ENTRIES[name] for name in dict.fromkeys(machines or ENTRIES) if name in ENTRIES]
    return {f"{entry.name}, {kind}": config for entry in entries for kind, config in entry.of_other_kinds.items()}


def _recordings(machines: Sequence[str]) -> _Listed:
    """Return the recordings that ship, as `safeloc replay MACHINE NAME` takes them."""
    rows = [
        {"machine": target.name, "name": recording_name(path)}
        for target in _targets(machines)
        for path in target.streams
    ]
    return rows, _lines(rows) or ["no recordings ship with it."]


def _assumptions(machines: Sequence[str]) -> _Listed:
    """Return the register: every law once, with the machines that rest on it, its figures, owner and missing fields."""
    found = register_of(_targets(machines), _of_other_kinds(machines))
    lines = [line for row in found.rows for line in _assumption_lines(row)]
    number, left = len(found.rows), found.left_to_others
    guaranteed = f"; {number - left} more are guaranteed by other machines" if number != left else ""
    lines += [
        f"{left} assumptions, that of records among them; {found.observable} of them observable in operation{guaranteed}; {len(found.to_confirm)} figures "
        "are from memory: the operator has to confirm them."
    ]
    data = {
        "assumptions": [_assumption_data(row) for row in found.rows],
        "to_confirm": [asdict(one) for one in found.to_confirm],
    }
    return data, lines


def _assumption_data(row: Listed) -> dict[str, Any]:
    """Return an assumption with the machines that rest on it; where it is guaranteed or seen depends on the machine."""
    alike = {key: value for key, value in asdict(row.one).items() if key not in ("guaranteed", "observable", "against")}
    more = {"targets": row.targets, "guaranteed": row.guaranteed, "observable": row.monitored}
    return {**alike, **more, "lacks": list(row.one.lacks)}


def _assumption_lines(row: Listed) -> Iterator[str]:
    one = row.one
    yield f"{one.id}  {one.name}{'' if row.is_left_to_others else '  (guaranteed by another machine)'}"
    yield f"    assumed by: {', '.join(row.targets)}"
    if row.guaranteed and row.is_left_to_others:
        yield f"    guaranteed by another machine in: {', '.join(row.guaranteed)}"
    for figure in one.figures:
        yield f"    {figure.name} = {figure.value} {figure.unit}  {figure.source}"
    fields = {"statement": one.statement, "source": one.source, "owner": one.owner, "check": one.check}
    yield from (f"    {field}: {words}" for field, words in fields.items() if words)
    for words, targets in row.monitored.items():
        of = f"  (in {', '.join(targets)})" if len(row.monitored) > 1 else ""
        yield f"    observable: {words}{of}"
    if one.lacks:
        yield f"    missing: {', '.join(one.lacks)}"


def _shared(machines: Sequence[str]) -> _Listed:
    """Return the sub-terms that claims and clauses share with rows, and the clauses that read computed values of their machine."""
    targets = _targets(machines)
    shared = [(target.name, shared_terms(target)) for target in targets]
    follows = [(target.name, one) for target in targets for one in follows_machine(target)]
    lines = [line for machine, found in shared for line in _shared_lines(machine, found)]
    for machine, one in follows:
        lines += [f"{machine}  {one.of}  reads {first_few(one.reads)}", f"    because       {one.reason}"]
    data = {
        "shared": [{"machine": machine, **asdict(term)} for machine, found in shared for term in found],
        "reads_machine": [{"machine": machine, **asdict(one)} for machine, one in follows],
    }
    return data, lines or ["nothing is shared."]


def _shared_lines(machine: str, found: Sequence[Shared]) -> Iterator[str]:
    """Return lines for each shared term: rows and outputs that the machine computes with it, claims and clauses that have it."""
    for speakers in by_term(found):
        first = speakers[0]
        yield f"{machine}  {first.nodes} nodes  {shorten(first.term, _TERM_CHARACTERS, placeholder=' ...')}"
        yield f"    computed for  {first_few(first.used)}"
        yield f"    shared by     {first_few(list(dict.fromkeys(one.of for one in speakers)))}"
        yield from (f"    because       {one}" for one in dict.fromkeys(one.reason or _NO_REASON for one in speakers))


def _splits(machines: Sequence[str]) -> _Listed:
    """Return the cases that the defaults of a machine fold away, each with the configurations in which it is live."""
    cases = folded_cases(machines)
    lines = [f"{one.split}  {one.at}  {one.source}\n    {one.folded}; {one.live}" for one in cases]
    hidden = sum(one.is_hidden for one in cases)
    summary = f"{len(cases)} cases are folded away by defaults; {hidden} of them are live in no configuration."
    return list(map(asdict, cases)), [*lines, summary]


def _shipped_lines() -> _Listed:
    from safeloc.railway.map.toml_files import load_line, shipped_lines  # loaded only if lines are listed

    lines = [load_line(path) for path in shipped_lines().values()]
    rows = [{"name": line.name, "version": line.version, "source": line.source} for line in lines]
    return rows, _lines(rows)


def _lines(rows: Sequence[dict[str, str]]) -> list[str]:
    return ["  ".join(value for value in row.values() if value) for row in rows]


def _requirements(store: Store, id_: str | None, text: str | None) -> _Listed:
    """Return the chosen requirements with their transitions, properties and their strength, and the links back."""
    targets = [load_target(name) for name in ENTRIES]
    (links, items, gaps), found = traceability(targets).chosen(id_, text), strengths_of(store, targets)
    data = {
        "requirements": [
            {
                **asdict(link.requirement),
                "transitions": link.transitions,
                "properties": link.properties,
                "strength": as_data(found.get(link.requirement.id, [])),
            }
            for link in links
        ],
        "items": [asdict(item) for item in items],
        "gaps": gaps,
    }
    lines = [line for link in links for line in _link_lines(link, found.get(link.requirement.id, []))]
    lines += [
        "",
        "Reverse traceability, from transitions and properties to requirements:",
        *map(_item_line, items),
    ]
    lines += ["", *(f"gap: {gap}" for gap in gaps or ("none",))]
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
