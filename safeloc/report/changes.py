"""Differences between two reports: verdicts, claims, laws, figures, versions and options."""

from __future__ import annotations

from collections import Counter
from collections.abc import Container, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from safeloc.language.verdict import WORST_FIRST
from safeloc.report.mutation_words import share

_Data = Mapping[str, Any]
_GOOD = ("proved", "held")
NOT_ASKED = "not asked"
"""The verdict of what a quick run leaves out: nothing got better or worse by it, but evidence is missing."""


@dataclass(frozen=True)
class Changes:
    """The changes, as lines by heading; headings without a change are left out.

    worse  whether a verdict is worse than it was or not asked any more, a new result is neither proved nor held, or a result is gone
    """

    sections: Mapping[str, tuple[str, ...]]
    worse: bool

    @property
    def lines(self) -> Iterator[str]:
        """The headings with their lines; one line if nothing changed."""
        if not self.sections:
            yield "nothing changed but the times"
        for heading, lines in self.sections.items():
            yield heading
            yield from (f"  {line}" for line in lines)


def changes(old: _Data, new: _Data) -> Changes:
    """Compare two reports, each with its machines' data."""
    before, after = ({row["id"]: row for row in report["results"]} for report in (old, new))
    changed = {key: (before[key], after[key]) for key in after if key in before}
    unasked = [key for key, (was, now) in changed.items() if was["verdict"] != now["verdict"] == NOT_ASKED]
    worse = [key for key, (was, now) in changed.items() if _rank(now) < _rank(was) and key not in unasked]
    better = [key for key, (was, now) in changed.items() if _rank(now) > _rank(was) and key not in unasked]
    bad = [row for key, row in after.items() if key not in before and row["verdict"] not in _GOOD]
    gone = [row for key, row in before.items() if key not in after]
    sections = {
        "verdict": [] if old["verdict"] == new["verdict"] else [f"{old['verdict']} -> {new['verdict']}"],
        "worse": [_verdicts(*changed[key]) for key in worse],
        "new, and neither proved nor held": [f"{row['verdict']}  {row['id']}" for row in bad],
        "not asked any more": [_verdicts(*changed[key]) for key in unasked],
        "better": [_verdicts(*changed[key]) for key in better],
        "gone": _counted(gone, whole=_names(old) - _names(new)),
        "new": _counted(
            [row for key, row in after.items() if key not in before and row["verdict"] in _GOOD],
            whole=_names(new) - _names(old),
        ),
        "other statement": [key for key, (was, now) in changed.items() if was["statement"] != now["statement"]],
        "other source lines": [*_other_lines(old, new)],
        "requirements": [*_named_values(_requirements(old), _requirements(new))],
        "laws": [*_laws(old, new)],
        "figures": [*_named_values(_figures(old), _figures(new))],
        "mutation scores": [*_named_values(_scores(old), _scores(new))],
        "machines": [*_machines(old, new)],
        "made with": [*_named_values(_made_with(old), _made_with(new))],
    }
    told = {heading: tuple(lines) for heading, lines in sections.items() if lines}
    return Changes(told, worse=bool(worse or unasked or bad or gone))


def _rank(row: _Data) -> int:
    return WORST_FIRST.index(row["verdict"])


def _verdicts(was: _Data, now: _Data) -> str:
    return f"{was['verdict']} -> {now['verdict']}  {now['id']}"


def _names(report: _Data) -> set[str]:
    return {one["name"] for one in report["machines"]}


def _counted(rows: Sequence[_Data], *, whole: Container[str]) -> list[str]:
    """Return each property, lemma and obligation by its id; tests and replays are counted for each machine and source.

    whole  machines that are in one report only: all their results are counted
    """
    of_machines = Counter((row["machine"], row["verdict"]) for row in rows if row["machine"] in whole)
    parts = [row for row in rows if row["machine"] not in whole]
    single = [row for row in parts if row["kind"] not in ("test", "replay")]
    several = Counter(
        (row["machine"], row["kind"], row["method"]) for row in parts if row["kind"] in ("test", "replay")
    )
    return [
        *(f"all of {machine}: {number} {verdict}" for (machine, verdict), number in of_machines.items()),
        *(f"{row['verdict']}  {row['id']}" for row in single),
        *(f"{number} of {machine}: {kind}, {method}" for (machine, kind, method), number in several.items()),
    ]


def _named_values(old: Mapping[str, str], new: Mapping[str, str]) -> Iterator[str]:
    """Yield what is new, gone or has another value."""
    for name in dict.fromkeys((*old, *new)):
        if name not in old:
            yield f"new: {name} = {new[name]}"
        elif name not in new:
            yield f"gone: {name} = {old[name]}"
        elif old[name] != new[name]:
            yield f"{name}: {old[name]} -> {new[name]}"


def _other_lines(old: _Data, new: _Data) -> Iterator[str]:
    """Yield the properties whose declaration reads otherwise: they may claim something else under the same name."""
    before, after = _declared(old), _declared(new)
    yield from (name for name, text in after.items() if name in before and before[name] != text)


def _declared(report: _Data) -> dict[str, str]:
    return {
        f"{machine['name']}/{one[0]}/{one[-1]}": excerpt["text"]
        for machine in report["machines"]
        for excerpt in machine["declared"]
        for one in excerpt["of"]
        if one[0] == "property"
    }


def _requirements(report: _Data) -> dict[str, str]:
    return {one["id"]: one["verdict"] or "no property" for one in report["requirements"]}


def _figures(report: _Data) -> dict[str, str]:
    return {
        f"{machine['name']}: {one['name']}": f"{one['value']} {one['unit']}".strip()
        for machine in report["machines"]
        for one in machine["figures"]
    }


def _laws(old: _Data, new: _Data) -> Iterator[str]:
    before, after = _law_terms(old), _law_terms(new)
    yield from (f"gone: {name}" for name in before if name not in after)
    for name, terms in after.items():
        if name not in before:
            yield f"new: {name}"
        elif terms != before[name]:
            yield f"other terms: {name}"


def _law_terms(report: _Data) -> dict[str, tuple[str, ...]]:
    return {
        f"{machine['name']}: {part['name']}: {law['name']}": tuple(law["terms"])
        for machine in report["machines"]
        for part in machine["parts"]
        for law in part["clauses"]
    }


def _scores(report: _Data) -> dict[str, str]:
    """Return the scores that were measured; a report of an earlier version has none."""
    found = {machine["name"]: machine.get("mutation") for machine in report["machines"]}
    return {
        name: f"{share(score)}, {score['judged']} of {score['mutants']} judged"
        for name, score in found.items()
        if score
    }


def _machines(old: _Data, new: _Data) -> Iterator[str]:
    before, after = ({one["name"]: one["declaration"] for one in report["machines"]} for report in (old, new))
    yield from (f"gone: {name}" for name in before if name not in after)
    yield from (f"new: {name}" for name in after if name not in before)
    yield from (f"other declaration: {name}" for name in after if name in before and before[name] != after[name])


def _made_with(report: _Data) -> dict[str, str]:
    made: _Data = report.get("made_by", {})
    limits = {f"limit of {name}": str(value) for name, value in made.get("limits", {}).items()}
    plain = {name: str(value) for name, value in made.items() if name != "limits"}
    return {**report["versions"], **plain, **limits}
