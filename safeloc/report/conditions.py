"""The conditions that the proofs hand over to others, in one list: what a safety case has to justify (EN 50129: SRACs)."""

from __future__ import annotations

import json
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import asdict
from typing import Any

from safeloc.assurance.law_figures import FROM_MEMORY, Figure, figures_named, is_from_memory, to_confirm
from safeloc.assurance.register import NOBODY
from safeloc.language.verdict import SHOWN

_Data = Mapping[str, Any]


def conditions(machines: Sequence[_Data]) -> dict[str, list[dict[str, Any]]]:
    """Return every law that no machine guarantees, once, with its figures, every figure that is from memory, and sums by owner.

    A law of which two targets have other terms, parts or figures stands twice; in reports of earlier versions it has one id there.
    """
    laws: dict[str, dict[str, Any]] = {}
    for machine, part, law in _laws(machines):
        named = figures(law, machine, part)
        key = json.dumps([law["id"], law["name"], law["terms"], law["parts"], named])
        one = laws.setdefault(
            key,
            {
                **law,
                **_to_confirm(law, named),
                "part": part["name"],
                "targets": [],
                "needed_by": [],
                "open_in": [],
                "perhaps": [],
                "seen": {},
            },
        )
        one["targets"].append(machine["name"])
        one["needed_by"] += _needed_by(machine, law)
        one["perhaps"] += _perhaps(machine)
        one["open_in"] += [machine["name"]] if machine["evidence"] is None else []
        one["seen"].setdefault(law["observable"], []).append(machine["name"])
    every = ((machine["name"], _figure(one)) for machine in machines for one in machine["figures"])
    confirm = [asdict(one) for one in to_confirm(every)]
    return {"laws": list(laws.values()), "figures": confirm, "owners": _by_owner(list(laws.values()))}


def counts(found: Mapping[str, Sequence[_Data]]) -> dict[str, int]:
    """Count conditions: laws, those that nobody has to ensure, those without owner or source, and figures to be confirmed.

    Headline, list and data have these numbers.
    """
    return {
        "assumptions": len(found["laws"]),
        "true_by_definition": sum(law["owner"] == NOBODY for law in found["laws"]),
        "without_owner_or_source": sum(not (law["owner"] and law["source"]) for law in found["laws"]),
        "without_owner": sum(not law["owner"] for law in found["laws"]),
        "without_source": sum(not law["source"] for law in found["laws"]),
        "figures_to_confirm": len(found["figures"]),
    }


def _figure(one: _Data) -> Figure:
    return Figure(one["name"], one["value"], one["unit"], one["source"])


def _to_confirm(law: _Data, named: Sequence[str]) -> dict[str, Any]:
    """Return the figures of a law in words, and whether one of them, or the law itself, is from memory."""
    return {"figures": named, "confirm": any(FROM_MEMORY in one for one in named) or is_from_memory(law["source"])}


def _by_owner(laws: Sequence[_Data]) -> list[dict[str, Any]]:
    """Return how many laws each owner has to ensure, and how many of them have to be confirmed; the most first."""
    owned, confirm = (
        Counter(law["owner"] or "none" for law in some) for some in (laws, [law for law in laws if law["confirm"]])
    )
    return [{"owner": name, "laws": number, "confirm": confirm[name]} for name, number in owned.most_common()]


def _laws(machines: Sequence[_Data]) -> Iterator[tuple[_Data, _Data, _Data]]:
    for machine in machines:
        for part in machine["parts"]:
            yield from ((machine, part, law) for law in part["clauses"] if not law["guaranteed"])


def figures(law: _Data, machine: _Data, part: _Data) -> list[str]:
    """Return the figures that a law of a part names, each with its value and unit, and [M] if it is from memory.

    If several parts of the configuration have a figure of the name, that of the part's own; of several with other values, each with its place.
    """
    every, section = [_figure(one) for one in machine["figures"]], part.get("section", part["name"])
    return [_in_words(name, figures_named(name, section, every), section) for name in law["figures"]]


def _in_words(name: str, found: Sequence[Figure], section: str) -> str:
    """Return a figure with its value; where it has several, the places in the configuration of each of them."""
    places: dict[str, list[str]] = {}
    for one in found:
        value = f"{one.value} {one.unit}".strip() + (f" {FROM_MEMORY}" if one.to_confirm else "")
        places.setdefault(value, []).append(_within(one.name.removesuffix(name).rstrip("."), section))
    if len(places) > 1:
        return f"{name} = " + " or ".join(f"{value} ({', '.join(at)})" for value, at in places.items())
    return f"{name} = {next(iter(places))}" if places else name


def _within(place: str, section: str) -> str:
    """Return a place in a section of the configuration, so that it is the same wherever the section stands; the whole place elsewhere."""
    return place.partition(f"{section}.")[2] if f".{section}." in f".{place}" else place


def _needed_by(machine: _Data, law: _Data) -> list[str]:
    """Return the claims whose proof core has the law, if the report has cores."""
    return [f"{machine['name']}: {claim}" for claim, ids in needs(machine).items() if law["id"] in ids]


def _perhaps(machine: _Data) -> list[str]:
    """Return the claims that are proved and have no proof core: they may need every law of their target."""
    cores = [] if machine["evidence"] is None else machine["evidence"]["cores"]
    return [f"{machine['name']}: {one['claim']}" for one in cores if one["why_none"] not in ("", SHOWN)]


def needs(machine: _Data) -> dict[str, list[str]]:
    """Return the ids of the laws that each claim of a target needs by its proof core; nothing if it has no cores."""
    if machine["evidence"] is None:
        return {}
    ids = {(part["name"], law["name"]): law["id"] for part in machine["parts"] for law in part["clauses"]}
    return {
        core["claim"]: [
            ids[element["machine"], element["name"]] for element in core["rests_on"] if element["kind"] == "clause"
        ]
        for core in machine["evidence"]["cores"]
        if not core["why_none"]
    }
