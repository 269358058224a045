"""The conditions that the proofs hand over to others, in one list: what a safety case has to justify (EN 50129: SRACs)."""

from __future__ import annotations

import json
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from safeloc.assurance.law_figures import FROM_MEMORY

_Data = Mapping[str, Any]


def conditions(machines: Sequence[_Data]) -> dict[str, list[dict[str, Any]]]:
    """Return every law that no machine guarantees, once, with its figures, every figure that is from memory, and sums by owner.

    A law of which two targets have different terms, or the same with other parts, stands twice.
    """
    laws: dict[tuple[str, str, str], dict[str, Any]] = {}
    for machine, law in _laws(machines):
        key = (law["id"], law["name"], json.dumps([law["terms"], law["parts"]]))
        one = laws.setdefault(key, {**law, **_with_figures(law, machine), "targets": [], "needed_by": []})
        one["targets"].append(machine["name"])
        one["needed_by"] += _needed_by(machine, law)
    confirm: dict[tuple[str, str], dict[str, Any]] = {}
    for machine in machines:
        for figure in machine["figures"]:
            if figure["source"].startswith(FROM_MEMORY):
                key_of = (figure["name"], figure["value"])
                confirm.setdefault(key_of, {**figure, "targets": []})["targets"].append(machine["name"])
    return {"laws": list(laws.values()), "figures": list(confirm.values()), "owners": _by_owner(list(laws.values()))}


def counts(found: Mapping[str, Sequence[_Data]]) -> dict[str, int]:
    """Count conditions: laws, laws without owner or source, and figures to be confirmed; headline and list have one number."""
    return {
        "assumptions": len(found["laws"]),
        "without_owner_or_source": sum(not (law["owner"] and law["source"]) for law in found["laws"]),
        "figures_to_confirm": len(found["figures"]),
    }


def _with_figures(law: _Data, machine: _Data) -> dict[str, Any]:
    """Return the figures of a law in words, and whether one of them, or the law itself, is from memory."""
    named = figures(law, machine)
    return {"figures": named, "confirm": any(FROM_MEMORY in words for words in (*named, law["source"]))}


def _by_owner(laws: Sequence[_Data]) -> list[dict[str, Any]]:
    """Return how many laws each owner has to ensure, and how many of them have to be confirmed; the most first."""
    owned, confirm = (
        Counter(law["owner"] or "none" for law in some) for some in (laws, [law for law in laws if law["confirm"]])
    )
    return [{"owner": name, "laws": number, "confirm": confirm[name]} for name, number in owned.most_common()]


def _laws(machines: Sequence[_Data]) -> Iterator[tuple[_Data, _Data]]:
    for machine in machines:
        for part in machine["parts"]:
            yield from ((machine, law) for law in part["clauses"] if not law["guaranteed"])


def figures(law: _Data, machine: _Data) -> list[str]:
    """Return the figures that a law names, each with its value and unit, and [M] if it is from memory; with all values if parts of the target differ in it."""
    found = []
    for name in law["figures"]:
        named = [one for one in machine["figures"] if one["name"] == name or one["name"].endswith(f".{name}")]
        values = dict.fromkeys(f"{one['value']} {one['unit']}".strip() + _mark(one) for one in named)
        found.append(f"{name} = {' or '.join(values)}" if values else name)
    return found


def _mark(figure: _Data) -> str:
    return f" {FROM_MEMORY}" if figure.get("source", "").startswith(FROM_MEMORY) else ""


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
