"""Table of rejected, withdrawn and withheld values along a run, with reasons: one row for each uninterrupted stretch."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import groupby

from safeloc.railway.pictures import Refusals, Sources
from safeloc.report.drawing import number
from safeloc.report.recorded_run import RecordedRun

_MOST_ROWS = 400


@dataclass(frozen=True)
class _Refused:
    """A reason that applied from step `begin` up to, not including, `end`; steps are counted from 0."""

    of: str
    signal: str
    reason: str
    begin: int
    end: int


def refused(one: Sources, recorded: RecordedRun) -> list[_Refused]:
    """Return all refusals of the run, in order of time."""
    found = [run for verdict in one.refusals for run in _of_verdict(verdict, recorded)]
    return sorted(found, key=lambda run: run.begin)


def _of_verdict(verdict: Refusals, recorded: RecordedRun) -> Iterator[_Refused]:
    begin = 0
    for reason, group in groupby(_reasons(verdict, recorded)):
        end = begin + len(list(group))
        if reason:
            yield _Refused(verdict.of, verdict.signal, reason, begin, end)
        begin = end


def _reasons(verdict: Refusals, recorded: RecordedRun) -> Iterator[str]:
    """Yield the reason of each step with further names; empty if nothing is refused."""
    also = (
        zip(*(recorded.words(name) for name in verdict.also), strict=True)
        if verdict.also
        else [()] * len(recorded.rows)
    )
    for label, more in zip(recorded.words(verdict.signal), also, strict=True):
        names = " and ".join(name for name in more if name not in ("", "NONE"))
        yield "" if label in ("", *verdict.fine) else f"{label}: {names}" if names else label


def refusals_table(one: Sources, recorded: RecordedRun) -> dict[str, list[str] | list[list[str]]]:
    """Return the table for the page; if rows are omitted, the last row gives their number."""
    found, truth = refused(one, recorded), recorded.truth(one.fused.truth)
    rows = [_row(one, run, truth[run.begin]) for run in found[:_MOST_ROWS]]
    if len(found) > _MOST_ROWS:
        rows.append(["", "", "", "", "", f"and {len(found) - _MOST_ROWS} more"])
    return {"head": ["from s", "to s", "front end at m", "of", "signal", "reason"], "rows": rows}


def _row(one: Sources, run: _Refused, place_mm: float | None) -> list[str]:
    begin, end = (number(step * one.period_ms / 1_000) for step in (run.begin, run.end))
    place = "unknown" if place_mm is None else number(round(place_mm / 1_000, 1))
    return [begin, end, place, run.of, run.signal, run.reason]
