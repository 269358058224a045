"""The results of mutants as text: the scores, the mutants that a single claim detects, and the open questions."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from types import MappingProxyType

from safeloc.assurance.mutation.results import (
    OTHERS,
    QUESTIONS,
    UNPROVED,
    Judged,
    Outcome,
    Score,
    by_requirement,
    kills_alone,
    needless,
    of_part,
    questions,
    score,
)

_WORDS = {"world": "a clause of the world wrong", "claims": "a weaker claim in its place"}


def lines(
    target: str,
    judged: Sequence[Judged],
    *,
    of: int,
    machine_only: bool,
    reasons: Mapping[str, str] = MappingProxyType({}),
) -> Iterator[str]:
    """Return all lines of a result; mutants with a written reason come last."""
    machine = of_part(judged, "machine")
    yield f"{target}: {len(judged)} of {of} mutants"
    if machine:
        yield from _of_machine(machine, machine_only=machine_only)
    for part in OTHERS:
        of_this_part = of_part(judged, part)
        if of_this_part:
            yield f"  {_WORDS[part]}: {_score_text(score([one.alone for one in of_this_part]))}"
    yield from _counted(judged, reasons, machine_only=machine_only)
    for with_reason in (False, True):
        some = [one for one in judged if (one.id in reasons) == with_reason]
        yield from (line for one in some for line in _questions(one, reasons, machine_only=machine_only))


def _counted(judged: Sequence[Judged], reasons: Mapping[str, str], *, machine_only: bool) -> Iterator[str]:
    open_ = questions(judged, machine_only=machine_only)
    known = sum(one.id in reasons for one in open_)
    if open_:
        yield f"  no proof notices {len(open_)}: {known} with a written reason, {len(open_) - known} without"
    for one in needless(judged, reasons):
        yield f"  a reason that is no longer needed: {one.id} is {one.everywhere.fate}"


def _of_machine(machine: Sequence[Judged], *, machine_only: bool) -> Iterator[str]:
    everywhere, alone = (score([getattr(one, way) for one in machine]) for way in ("everywhere", "alone"))
    if not machine_only:
        yield f"  the term wrong wherever it stands: {_score_text(everywhere)}"
    yield f"  the machine alone wrong:           {_score_text(alone)}"
    for name, one in by_requirement(machine).items():
        yield f"  {name}: {_score_text(one)}"
    for claim, noticed in kills_alone(machine).items():
        yield f"  only {claim} notices {len(noticed)}: {' '.join(noticed[:4])}{' ...' if len(noticed) > 4 else ''}"


def _score_text(one: Score) -> str:
    fates = ", ".join(f"{count} {fate}" for fate, count in sorted(one.fates.items(), key=lambda pair: -pair[1]))
    return f"{one.killed_by_proof} of {one.asked} noticed by a proof ({one.share:.0%}); {fates}"


def _questions(one: Judged, reasons: Mapping[str, str], *, machine_only: bool) -> Iterator[str]:
    outcome = one.outcome(machine_only=machine_only)
    if outcome.fate in QUESTIONS or outcome.fate == UNPROVED:
        suffix = f"\n    REASON: {reasons[one.id]}" if one.id in reasons else ""
        yield f"{_question(one, outcome, machine_only=machine_only)}{suffix}"


def _question(one: Judged, outcome: Outcome, *, machine_only: bool) -> str:
    where = "; ".join(one.where[:2]) + (f" and {len(one.where) - 2} more" if len(one.where) > 2 else "")
    written = f"\n      written: {one.source}" if one.source else ""
    suffix = f" ({outcome.how})" if outcome.how else f" ({', '.join(outcome.by[:2])})" if outcome.by else ""
    which = f" [{one.direction}]" if one.direction else ""
    return (
        f"{outcome.fate}{suffix}: {one.id}, {one.place}{which}\n"
        f"    {one.kind}: {one.words} [{where}]{written}\n"
        f"      {one.term}  ->  {one.becomes}{_besides(one, machine_only=machine_only)}"
    )


def _besides(one: Judged, *, machine_only: bool) -> str:
    """Return a note if claims detect the mutant only as long as they do not contain the same error; else ""."""
    if machine_only or not one.proves_itself:
        return ""
    shared = ", ".join(one.shared_with[:3])
    by = ", ".join(one.alone.by[:2])
    return (
        f"\n      PROVES ITSELF: with the machine alone wrong {one.alone.fate} ({by}); the same term stands in {shared}"
    )
