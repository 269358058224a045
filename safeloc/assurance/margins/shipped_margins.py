"""Margins that ship with a machine: `<name>.margins.json` in its folder of `models/`, found before and written down.

A file has the digest of the machine that it is about: of its terms, its claims, its figures and the code that makes it. Of a machine
with another digest nothing of the file is shown. The engine is not in the digest: a prover that is edited makes no limit wrong.

The runs that break claims are not in it; `safeloc margins` finds them again.
"""

from __future__ import annotations

import json
import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from safeloc.assurance.margins.asking import Answer
from safeloc.assurance.margins.figures import Figure, figures
from safeloc.assurance.margins.kept_margins import MARGINS
from safeloc.assurance.margins.limits_of_figures import Limit
from safeloc.assurance.margins.makers import machine_digest
from safeloc.assurance.margins.margin_data import row
from safeloc.assurance.shipped_files import ShippedFile, has_shipped_figures, place_of, read_shipped, shipped_file
from safeloc.proof.cache.store import Store
from safeloc.target import Target

KIND = "margins.json"
_SCHEMA = "safeloc-shipped-margins/1"
_COLUMNS: Mapping[str, Any] = {
    "figure": "", "direction": "", "holds_to": 0, "end": "", "beyond": None, "cycles": 0, "claim": "", "why": "", "proved_why": "",
    "broken_at": None,
}  # fmt: skip
"""Columns of a limit in the file, each with the value that may be left out at the end of a row."""
_WHY = list(_COLUMNS).index("why")
_FOLDERS = re.compile(r"/\S*/(?=safeloc/\w)")
"""The folders above safeloc in a reason that names a place in a machine's file."""


class _File(ShippedFile):
    found: str
    seconds: float
    world: list[list[str | int | None]]
    pairs: list[dict[str, Any]]


@dataclass(frozen=True)
class Shipped:
    """The margins that ship with a machine.

    found       the day on which they were found
    is_current  whether they are of this version of the machine; those of another one are not to be shown
    parts       "world" with the limits of all figures, and "pairs" with the fronts, as `KeptResults` keeps them; nothing if not current
    """

    found: str
    is_current: bool
    parts: Mapping[str, Any]


def shipped_margins(target: Target, path: Path | None = None) -> Shipped | None:
    """Return the margins that ship with a target; None without a file, and for other figures than the defaults.

    path  the file, if it is not that in the machine's folder

    InputError for a file of another form.
    """
    if not has_shipped_figures(target):
        return None
    path = shipped_file(target, KIND) if path is None else path
    if path is None:
        return None
    content = read_shipped(path, _File, _SCHEMA, "margins")
    if content.digest != machine_digest(target):
        return Shipped(content.found, False, {})
    parts = {"world": _rows(content.world, figures(target)), "pairs": content.pairs}
    return Shipped(content.found, True, {name: part for name, part in parts.items() if part})


def margins_of(store: Store, targets: Iterable[Target]) -> dict[str, Any]:
    """Return the margins of each target that has some, by its name: those that are kept, and what they lack from those that ship.

    "shipped" is the day on which those that ship were found; "other_version" the same of those that are of another version.
    """
    found = dict[str, Any]()
    for target in targets:
        kept, ships = MARGINS.kept(store, target) or {}, shipped_margins(target)
        parts = {**({} if ships is None else ships.parts), **kept}
        if ships is not None and not ships.is_current and not kept:
            parts = {"other_version": ships.found}
        elif ships is not None and set(ships.parts) - set(kept):
            parts["shipped"] = ships.found
        if parts:
            found[target.name] = parts
    return found


def write_shipped(
    target: Target, parts: Mapping[str, Any], found: str, seconds: float, path: Path | None = None
) -> Path:
    """Write the margins of a machine to the file that ships with it; return its path."""
    path = place_of(target, KIND) if path is None else path
    head = {"schema": _SCHEMA, "digest": machine_digest(target), "found": found, "seconds": seconds}
    lines = [f"{json.dumps(name)}: {json.dumps(value)}" for name, value in head.items()]
    world = [json.dumps(_short(one), separators=(",", ":")) for one in parts.get("world", ())]
    pairs = [json.dumps(one, separators=(",", ":")) for one in parts.get("pairs", ())]
    lines += [f"{json.dumps(name)}: [\n{_joined(rows)}]" for name, rows in (("world", world), ("pairs", pairs))]
    path.write_text("{\n" + ",\n".join(lines) + "\n}\n", encoding="utf-8")
    return path


def _joined(rows: Sequence[str]) -> str:
    return ",\n".join(rows) + ("\n" if rows else "")


def _short(limit: Mapping[str, Any]) -> list[Any]:
    """Return a limit in columns, without what is as usual at the end."""
    values = [limit[name] for name in _COLUMNS]
    values[_WHY] = _FOLDERS.sub("", str(values[_WHY]))
    usual = list(_COLUMNS.values())
    while values and values[-1] == usual[len(values) - 1]:
        values.pop()
    return values


def _rows(limits: Sequence[Sequence[Any]], known: Mapping[str, Figure]) -> list[dict[str, Any]]:
    return [
        row(_limit(dict(zip(_COLUMNS, [*one, *list(_COLUMNS.values())[len(one) :]], strict=True)), known))
        for one in limits
    ]


def _limit(one: Mapping[str, Any], known: Mapping[str, Figure]) -> Limit:
    end = Answer(one["end"], one["claim"], one["why"], inputs=({},) * one["cycles"])
    return Limit(
        known[one["figure"]], one["direction"], one["holds_to"], end, one["beyond"], one["broken_at"], one["proved_why"]
    )
