"""Limits of figures in words and as data, for the command and JSON."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict
from typing import Any

from safeloc.assurance.margins.asking import UNMOVED
from safeloc.assurance.margins.limits_of_figures import Limit
from safeloc.assurance.margins.margin_work import Margins

SCHEMA = "safeloc-margins/1"


def _is_unmoved(one: Limit) -> bool:
    """Return whether the figure moves nothing as far as it may go."""
    return one.proved_why == UNMOVED and one.end.end in ("proved", "refused")


def in_words(one: Limit) -> str:
    """Return what limits the figure, as a phrase."""
    if _is_unmoved(one):
        return UNMOVED
    match one.end.end:
        case "broken":
            cycles = len(one.end.inputs)
            return f"at {one.beyond} a run of {cycles} {'cycle' if cycles == 1 else 'cycles'} breaks {one.end.claim!r}"
        case "refused":
            return f"{one.beyond} is refused: {one.end.why}"
        case "vacuous":
            return f"at {one.beyond} {one.end.claim!r} says nothing: {one.end.why}"
        case "undecided":
            further = "" if one.broken_at is None else f"; a run breaks a claim at {one.broken_at}"
            what = one.end.why or f"at {one.beyond} {one.end.claim!r} is not decided within the limits"
            return what + further
        case "proved":
            return "holds to the end of the range" if one.margin else "its range ends here"


def row(one: Limit) -> dict[str, Any]:
    """Return a limit as plain data, without the run that breaks a claim."""
    return {
        "figure": one.figure.name,
        "unit": one.figure.unit,
        "value": one.figure.value,
        "direction": one.direction,
        "holds_to": one.holds_to,
        "margin": one.margin,
        "beyond": one.beyond,
        "broken_at": one.broken_at,
        "proved_why": one.proved_why,
        "unmoved": _is_unmoved(one),
        "end": one.end.end,
        "claim": one.end.claim,
        "cycles": len(one.end.inputs),
        "why": one.end.why,
        "in_words": in_words(one),
    }


def margins_data(margins: Margins, limits: Sequence[Limit]) -> dict[str, Any]:
    """Return the limits as data for JSON, with the run that breaks a claim."""
    return {
        "schema": SCHEMA,
        "target": margins.target.name,
        "where": margins.where,
        "claims": list(margins.claims),
        "limits": [{**row(one), "end": asdict(one.end)} for one in limits],
    }
