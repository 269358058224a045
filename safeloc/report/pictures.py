"""The pictures of replayed runs: one for each recording and each picture that the target declares."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any, assert_never

from safeloc.language.verdict import Violated
from safeloc.proof.results import Finding, Replayed
from safeloc.railway.pictures import (
    Approach,
    Deviation,
    Picture,
    PossibleEdges,
    Recognition,
    Sources,
    Standings,
    Stanford,
    Waterfall,
)
from safeloc.report.approach import approach_picture
from safeloc.report.deviation import deviation_picture
from safeloc.report.possible_edges import possible_edges_picture
from safeloc.report.recognition import recognition_picture
from safeloc.report.recorded_run import Broken, RecordedRun
from safeloc.report.refusals import refusals_table
from safeloc.report.sources import sources_picture
from safeloc.report.standings import standings_picture
from safeloc.report.stanford import stanford_picture
from safeloc.report.waterfall import waterfall_picture, waterfall_table
from safeloc.target import Target


def pictures_data(target: Target, findings: Sequence[Finding]) -> list[dict[str, Any]]:
    """Return title, recording and drawing of each picture, in the order of the recordings."""
    return [
        {
            **_beside(declared, recorded),
            "recording": recorded.name,
            "violated": [one.name for one in recorded.broken],
            "svg": svg,
        }
        for recorded in recorded_runs(target, findings)
        for declared in target.pictures
        if (svg := _drawn(declared, recorded))
    ]


def _beside(declared: Picture, recorded: RecordedRun) -> dict[str, Any]:
    """Return the text with a drawing: its title; for a waterfall also its scene and a table."""
    if isinstance(declared, Sources):
        return _beside_sources(declared, recorded)
    loud = declared.loud(recorded.name) if isinstance(declared, Waterfall) else None
    if not isinstance(declared, Waterfall) or loud is None:
        return {"title": declared.title}
    return {"title": f"{declared.title}: {loud.title}", "says": loud.says, "table": waterfall_table(declared, recorded)}


def _beside_sources(declared: Sources, recorded: RecordedRun) -> dict[str, Any]:
    says = declared.says(recorded.name) if declared.says else ""
    table = {"table": refusals_table(declared, recorded), "summary": "everything that was rejected, with its reason"}
    return {"title": declared.title, **({"says": says} if says else {}), **table}


def _drawn(declared: Picture, recorded: RecordedRun) -> str:
    """Return one picture as SVG text; empty for a run without any position."""
    match declared:
        case Deviation():
            return deviation_picture(declared, recorded)
        case Approach():
            return approach_picture(declared, recorded)
        case Recognition():
            return recognition_picture(declared, recorded)
        case Stanford():
            return stanford_picture(declared, recorded)
        case PossibleEdges():
            return possible_edges_picture(declared, recorded)
        case Standings():
            return standings_picture(declared, recorded)
        case Sources():
            return sources_picture(declared, recorded)
        case Waterfall():
            return waterfall_picture(declared, recorded)
        case _:
            assert_never(declared)


def recorded_runs(target: Target, findings: Sequence[Finding]) -> Iterator[RecordedRun]:
    """Yield each replayed run once, with all statements that it violates."""
    replays = [(one.replayed, one) for one in findings if one.machine == target.name]
    for replayed in dict.fromkeys(replayed for replayed, _ in replays):
        if replayed is not None:
            broken = [_broken(one, replayed) for run, one in replays if run is replayed]
            known = tuple(sorted((one for one in broken if one is not None), key=lambda one: one.step))
            yield RecordedRun(replayed.name, replayed.trace, replayed.truth_mm, known)


def _broken(finding: Finding, replayed: Replayed) -> Broken | None:
    """Return the violated statement of a finding, with the step; None for any other finding."""
    if not isinstance(finding.result, Violated):
        return None
    trace = finding.result.trace
    name = finding.id.removeprefix(f"{finding.machine}/replay/{replayed.name}: ")
    return Broken(name, replayed.trace.length if trace is None else trace.length)
