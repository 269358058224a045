"""The conditions that the proofs hand over to others, in one list: what a safety case has to justify (EN 50129: SRACs)."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from safeloc.assurance.register import FROM_MEMORY

_Data = Mapping[str, Any]


def conditions(machines: Sequence[_Data]) -> dict[str, list[dict[str, Any]]]:
    """Return every law that no machine guarantees, once, with its figures, and every figure that is from memory."""
    laws: dict[tuple[str, str, str], dict[str, Any]] = {}
    for machine, law in _laws(machines):
        key = (law["id"], law["name"], "\n".join(law["terms"]))
        one = laws.setdefault(key, {**law, "figures": figures(law, machine), "targets": [], "needed_by": []})
        one["targets"].append(machine["name"])
        one["needed_by"] += _needed_by(machine, law)
    confirm: dict[tuple[str, str], dict[str, Any]] = {}
    for machine in machines:
        for figure in machine["figures"]:
            if figure["source"].startswith(FROM_MEMORY):
                key_of = (figure["name"], figure["value"])
                confirm.setdefault(key_of, {**figure, "targets": []})["targets"].append(machine["name"])
    return {"laws": list(laws.values()), "figures": list(confirm.values())}


def _laws(machines: Sequence[_Data]) -> Iterator[tuple[_Data, _Data]]:
    for machine in machines:
        for part in machine["parts"]:
            yield from ((machine, law) for law in part["clauses"] if not law["guaranteed"])


def figures(law: _Data, machine: _Data) -> list[str]:
    """Return the figures that a law names, each with its value and unit; with all values if parts of the target differ in it."""
    found = []
    for name in law["figures"]:
        named = [one for one in machine["figures"] if one["name"] == name or one["name"].endswith(f".{name}")]
        values = dict.fromkeys(f"{one['value']} {one['unit']}".strip() for one in named)
        found.append(f"{name} = {' or '.join(values)}" if values else name)
    return found


def _needed_by(machine: _Data, law: _Data) -> list[str]:
    """Return the claims whose proof core has the law, if the report has cores."""
    return [f"{machine['name']}: {claim}" for claim, ids in needs(machine).items() if law["id"] in ids]


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
