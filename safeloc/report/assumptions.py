"""The result of `safeloc replay --assumptions`, as text and as data.

Each law of the worlds has the least distance to a breach that the recording shows, and every breach.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

from safeloc.assurance.register import Assumption, of_border, register
from safeloc.catalogue import Target
from safeloc.proof.verification.assumptions import AtCycle, Judged, JudgedLaw
from safeloc.runtime.breaches import BrokenLaw

_SCHEMA = "safeloc-assumptions/1"
_SHOWN_BREACHES = 10
_SHOWN_VALUES = 12
_BY: Mapping[str, str] = {"inputs": "inputs", "part": "inputs, in part", "truth": "truth"}
_Numbers = Mapping[tuple[str, str], Assumption]


def numbers_of(target: Target) -> _Numbers:
    """Return the assumptions of the register, those of the border among them, by machine and name."""
    return {(one.machine, one.name): one for one in (*register(target), of_border())}


# ------------------------------------------------------------------ as text


def as_lines(recording: str, judged: Judged, numbers: _Numbers) -> Iterator[str]:
    """Return the lines for a reader: a table of the laws, every breach, and the laws that the recording does not show."""
    truth = "with the truth" if judged.with_truth else "without the truth: only laws that inputs show are checked"
    yield f"{recording}: {judged.cycles} cycles, {truth}"
    yield from _table(judged, numbers)
    for one in judged.clocks:
        yield (
            f"clock of {one.source}: at least {one.least_ms} ms and at most {one.greatest_ms} ms behind another source "
            f"({one.behind})"
        )
    for law in judged.broken:
        yield from _breaches(law, numbers)
    for left in judged.unjudged:
        known = numbers[left.machine, left.name]
        yield f"not checked: {known.id}  {left.name}; owner: {known.owner or 'none'}; check: {known.check or 'none'}"
    yield (
        f"checked: {len(judged.every)}, of them broken: {len(judged.broken)}; laws that this recording does not show: "
        f"{len(judged.unjudged)}"
    )


def _table(judged: Judged, numbers: _Numbers) -> Iterator[str]:
    rows = [("law", "checked by", "least distance", "cycle", "broken in")]
    for one in judged.every:
        least = "none" if one.least is None else f"{one.least} {one.unit}"
        cycles = f"{len(one.breaches)} cycles" if one.breaches else "-"
        rows.append((_named(one, numbers), _BY[one.by], least, "-" if one.cycle is None else str(one.cycle), cycles))
    widths = [max(map(len, column)) for column in zip(*rows, strict=True)]
    for row in rows:
        yield "  ".join(cell.ljust(width) for cell, width in zip(row, widths, strict=True)).rstrip()


def _named(one: JudgedLaw, numbers: _Numbers) -> str:
    return " against ".join(f"{numbers[law.machine, law.name].id} {law.name}" for law in one.laws)


def _breaches(one: JudgedLaw, numbers: _Numbers) -> Iterator[str]:
    yield f"BROKEN  {_named(one, numbers)}"
    if len(one.laws) > 1:
        yield "    at least one of them is broken: they exclude each other"
    for law in one.laws:
        yield f"    {law.statement or 'no statement'}  (owner: {law.owner or 'none'})"
    for at in one.breaches[:_SHOWN_BREACHES]:
        yield f"    cycle {at.cycle}: {_by(one, at)}; {_values(at)}"
    if len(one.breaches) > _SHOWN_BREACHES:
        more = len(one.breaches) - _SHOWN_BREACHES
        yield f"    and {more} more cycles, the last of them {one.breaches[-1].cycle}; --json has all"


def _by(one: JudgedLaw, at: AtCycle) -> str:
    distance = at.breach.distance
    shown = "inputs show it" if at.seen else "only the truth shows it"
    return f"{'broken' if distance is None else f'by {-distance} {one.unit}'}, {shown}"


def _values(at: AtCycle) -> str:
    values = [f"{name}={_value(value)}" for name, value in at.breach.values.items()]
    more = f" and {len(values) - _SHOWN_VALUES} more" if len(values) > _SHOWN_VALUES else ""
    return " ".join(values[:_SHOWN_VALUES]) + more


def _value(value: object) -> str:
    return "absent" if value is None else str(value).lower() if isinstance(value, bool) else str(value)


# ------------------------------------------------------------------ as data


def as_data(recording: str, judged: Judged, numbers: _Numbers) -> dict[str, Any]:
    """Return the same as plain data, schema safeloc-assumptions/1."""
    return {
        "schema": _SCHEMA,
        "target": judged.target,
        "recording": recording,
        "cycles": judged.cycles,
        "with_truth": judged.with_truth,
        "judged": [_law_data(one, numbers) for one in judged.every],
        "not_judged": [{**_of(law, numbers), "check": numbers[law.machine, law.name].check} for law in judged.unjudged],
        "clocks": [
            {"source": one.source, "least_ms": one.least_ms, "greatest_ms": one.greatest_ms, "behind": one.behind}
            for one in judged.clocks
        ],
    }


def _law_data(one: JudgedLaw, numbers: _Numbers) -> dict[str, Any]:
    return {
        "laws": [_of(law, numbers) for law in one.laws],
        "by": one.by,
        "unit": one.unit,
        "least_distance": one.least,
        "cycle": one.cycle,
        "breaches": [
            {
                "cycle": at.cycle,
                "distance": at.breach.distance,
                "inputs_show_it": at.seen,
                "values": dict(at.breach.values),
            }
            for at in one.breaches
        ],
    }


def _of(law: BrokenLaw, numbers: _Numbers) -> dict[str, str]:
    return {
        "id": numbers[law.machine, law.name].id,
        "machine": law.machine,
        "name": law.name,
        "statement": law.statement,
        "owner": law.owner,
    }
