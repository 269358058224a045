"""A design in words and as data, for the command and JSON."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import asdict
from fractions import Fraction
from typing import Any

from safeloc.railway.audit.findings import AuditReport
from safeloc.railway.audit.rules import Rules
from safeloc.railway.design.checks import Held
from safeloc.railway.design.designing import Design
from safeloc.railway.design.function_tests import tests
from safeloc.railway.design.least_cost import Demand
from safeloc.railway.design.options import Installed, Option
from safeloc.railway.design.stretches import Stretch, stretches
from safeloc.railway.map.elements import Reflector
from safeloc.railway.map.places import kilometre_text

SCHEMA = "safeloc-line-design/1"
_SHOWN = 8
"""Stretches that are printed, those with the least to spare."""


def decisions(found: Design) -> list[dict[str, Any]]:
    """Return every element that is kept, left out or added, along the edges of the line."""
    edges = {edge.id: edge for edge in found.task.line.edges}
    order = {edge: number for number, edge in enumerate(edges)}
    rows = []
    for number, one in enumerate(found.options.every):
        chosen = number in found.chosen
        if chosen or not one.new:
            rows.append((order[one.element.edge], one.element.position_mm, one, chosen))
    rows.sort(key=lambda row: row[:2])
    return [
        {
            "what": "left out" if not chosen else "added" if one.new else "kept",
            "kind": one.kind,
            "id": _name(found, one),
            "edge": one.element.edge,
            "position_mm": position,
            "kilometre": kilometre_text(edges[one.element.edge], position),
            "cost_eur": one.cost_eur if chosen else 0,
            "kept_for": one.kept_for,
        }
        for _, position, one, chosen in rows
    ]


def _name(found: Design, one: Option) -> str:
    """Return the name on the designed line: new groups and reflectors are numbered anew."""
    if not one.new:
        return one.element.id
    line, kind = found.line, type(one.element)
    every: tuple[Installed, ...] = (*line.balise_groups, *line.reflectors, *line.markers)
    there = [element for element in every if isinstance(element, kind)]
    return next(
        element.id for element in there if element == one.element.model_copy(update={"id": element.id, **_own(element)})
    )


def _own(element: Installed) -> dict[str, int]:
    """Return what is an element's own besides its name."""
    return {} if isinstance(element, Reflector) else {"identity": element.identity}


def lines(found: Design, audited: AuditReport, held: Sequence[Held]) -> Iterator[str]:
    """Yield the lines for people."""
    rows = decisions(found)
    counts = {what: sum(row["what"] == what for row in rows) for what in ("kept", "left out", "added")}
    tolerance = found.task.layout.tolerance_mm
    yield f"{found.line.name} for {_metres(tolerance)}: " + ", ".join(f"{n} {what}" for what, n in counts.items())
    for row in rows:
        where = f"{row['edge']} at {row['position_mm']} mm" + (f", km {row['kilometre']}" if row["kilometre"] else "")
        why = f" ({row['kept_for']})" if row["kept_for"] else ""
        yield f"  {row['what']:8} {row['kind']} {row['id']}, {where}, {row['cost_eur']} EUR{why}"
    yield f"cost {found.cost_eur} EUR; {_least(found)}"
    yield "stretches with the least to spare:"
    yield from _tightest(found)
    cases, violated = sum(audited.cases.values()), len(audited.violated)
    yield f"the written line, read again, passes its audit: {cases} cases, {violated} violated"
    yield from (_held_in_words(one) for one in held)


def _tightest(found: Design) -> Iterator[str]:
    """The stretches with the least to spare; those that are alike in length and limit are one line."""
    alike = dict[tuple[int, str], list[Stretch]]()
    for one in stretches(found.line, found.reach):
        alike.setdefault((one.length_mm, one.why), []).append(one)
    for those in list(alike.values())[:_SHOWN]:
        one = those[0]
        more = f", and {len(those) - 1} more" if len(those) > 1 else ""
        where = f"from {one.origin} to {one.goal}, {one.direction}{more}"
        yield f"  {_metres(one.length_mm)} of {_metres(one.limit_mm)} {where}: {one.why}"


def _least(found: Design) -> str:
    places = sum(one.new for one in found.options.every)
    near = "" if found.apart_mm == 1 else f", of which those within {_metres(found.apart_mm)} count as one"
    kinds = [f"{kind}s" for kind in dict.fromkeys(one.kind for one in found.options.every if one.new)]
    what = " and ".join(kinds).replace("balise groups", "groups") or "groups"
    where = f"among {places} places for new {what}{near}"
    if found.least_eur == found.cost_eur:
        return f"proved to be least {where}: the weights of {len(found.weighted)} demands add up to it"
    if found.none_cheaper:
        return f"proved to be least {where}: no cheaper choice meets the {len(found.demands)} demands (z3, confirmed by a second solver)"
    return f"no less was found {where}, and less than {found.least_eur} EUR is impossible: the weights of {len(found.weighted)} demands add up to it"


def _held_in_words(one: Held) -> str:
    after = f"after a {one.what} known to {_metres(one.held.accuracy_mm)} the {one.machine} machine holds its position for {_metres(one.held.run_mm)}"
    lost = "no run was found that loses it" if one.lost_in is None else f"a run of {one.lost_in + 1} cycles loses it"
    return f"{after}: {one.verdict}; 1 mm farther {lost}"


def _metres(value_mm: int) -> str:
    return f"{value_mm / 1000:.3f} m"


def design_data(found: Design, audited: AuditReport, held: Sequence[Held]) -> dict[str, Any]:
    """Return the design as data for JSON, with weights of demands and with the runs that lose the position."""
    return {
        "schema": SCHEMA,
        "line": found.line.name,
        "tolerance_mm": found.task.layout.tolerance_mm,
        "layout": found.task.layout.model_dump(),
        "costs": found.task.costs.model_dump(),
        "elements": decisions(found),
        "cost_eur": found.cost_eur,
        "least_eur": found.least_eur,
        "none_cheaper": found.none_cheaper,
        "places": sum(one.new for one in found.options.every),
        "apart_mm": found.apart_mm,
        "weights": [_weighted(found, one, weight) for one, weight in found.weighted.items()],
        "stretches": [{**asdict(one), "spare_mm": one.spare_mm} for one in stretches(found.line, found.reach)],
        "audit": {"cases": sum(audited.cases.values()), "violated": len(audited.violated), "audits": found.audits},
        "machine": [_held_data(one) for one in held],
    }


def _weighted(found: Design, one: Demand, weight: Fraction) -> dict[str, Any]:
    places = {"any_of": one.any_of, "unless": one.unless}
    named = {kind: [_decided(found, number) for number in sorted(numbers)] for kind, numbers in places.items()}
    return {"weight_eur": str(weight), **named}


def _decided(found: Design, number: int) -> str:
    """Return what is decided under a number: the place of an option, or that the group of an option has a function test."""
    every = found.options.every
    if number < len(every):
        return ":".join(map(str, every[number].place))
    of = {test: group for group, test in tests(found.options, Rules(found.reach.layout)).items()}
    return f"function test over {':'.join(map(str, every[of[number]].place))}"


def _held_data(one: Held) -> dict[str, Any]:
    return {
        "machine": one.machine,
        "accuracy_mm": one.held.accuracy_mm,
        "holds_for_mm": one.held.run_mm,
        "verdict": one.verdict,
        "lost_in_cycle": one.lost_in,
        "first": dict(one.held.first),
        "steps": [dict(each) for each in one.held.steps],
    }
