"""The pictures of replayed runs: of each target that declares some, one of each kind for each recording."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any, assert_never

from safeloc.language.verdict import Violated
from safeloc.proof.results import Finding, Replayed
from safeloc.railway.pictures import Approach, Deviation, Picture, Recognition, Sources, Standings, Stanford, Waterfall
from safeloc.report.approach import approach_picture
from safeloc.report.deviation import deviation_picture
from safeloc.report.recognition import recognition_picture
from safeloc.report.refusals import refusals_table
from safeloc.report.sources import sources_picture
from safeloc.report.standings import standings_picture
from safeloc.report.stanford import stanford_picture
from safeloc.report.told import Broken, Told
from safeloc.report.waterfall import waterfall_picture, waterfall_table
from safeloc.target import Target


def pictures_data(target: Target, findings: Sequence[Finding]) -> list[dict[str, Any]]:
    """Return title, recording and drawing of each picture, in order of the recordings."""
    return [
        {**_beside(declared, told), "recording": told.name, "violated": [one.name for one in told.broken], "svg": svg}
        for told in runs_told(target, findings)
        for declared in target.pictures
        if (svg := drawn(declared, told))
    ]


def _beside(declared: Picture, told: Told) -> dict[str, Any]:
    """Return the text with a drawing: its title; for a waterfall also the expected outcome, and a table if there is one."""
    if isinstance(declared, Sources):
        return _beside_sources(declared, told)
    loud = declared.loud(told.name) if isinstance(declared, Waterfall) else None
    if not isinstance(declared, Waterfall) or loud is None:
        return {"title": declared.title}
    return {"title": f"{declared.title}: {loud.title}", "says": loud.says, "table": waterfall_table(declared, told)}


def _beside_sources(declared: Sources, told: Told) -> dict[str, Any]:
    says = declared.says(told.name) if declared.says else ""
    table = {"table": refusals_table(declared, told), "summary": "everything that was rejected, with its reason"}
    return {"title": declared.title, **({"says": says} if says else {}), **table}


def drawn(declared: Picture, told: Told) -> str:
    """Return one picture as SVG text; empty for a run that tells of no place."""
    match declared:
        case Deviation():
            return deviation_picture(declared, told)
        case Approach():
            return approach_picture(declared, told)
        case Recognition():
            return recognition_picture(declared, told)
        case Stanford():
            return stanford_picture(declared, told)
        case Standings():
            return standings_picture(declared, told)
        case Sources():
            return sources_picture(declared, told)
        case Waterfall():
            return waterfall_picture(declared, told)
        case _:
            assert_never(declared)


def runs_told(target: Target, findings: Sequence[Finding]) -> Iterator[Told]:
    """Return each replayed run once, with every statement that it violates."""
    own = [(one.replayed, one) for one in findings if one.machine == target.name]
    for replayed in dict.fromkeys(replayed for replayed, _ in own):
        if replayed is not None:
            broken = [_broken(one, replayed) for run, one in own if run is replayed]
            known = tuple(sorted((one for one in broken if one is not None), key=lambda one: one.step))
            yield Told(replayed.name, replayed.trace, replayed.truth_mm, known)


def _broken(finding: Finding, replayed: Replayed) -> Broken | None:
    """The run of a violated finding ends where it is violated."""
    if not isinstance(finding.result, Violated):
        return None
    trace = finding.result.trace
    name = finding.id.removeprefix(f"{finding.machine}/replay/{replayed.name}: ")
    return Broken(name, len(replayed.trace.steps) if trace is None else len(trace.steps))
