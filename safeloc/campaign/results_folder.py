"""Writes what a finished campaign says into its folder: results.json, pictures, page and kept streams."""

from __future__ import annotations

import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from safeloc.campaign.aggregate import Results
from safeloc.campaign.counted import CELLS_TO_LIMIT, alert_limit_mm
from safeloc.campaign.declaration import Campaign, Stratum
from safeloc.campaign.kept import keep_streams
from safeloc.campaign.scenes import scene_of
from safeloc.report.campaign_page import campaign_page
from safeloc.report.campaign_pictures import (
    availability_along_line,
    margins_of_situations,
    stanford_of_cells,
    times_until_silent,
    width_along_line,
    with_style,
)


def write_results(campaign: Campaign, folder: Path) -> dict[str, Any]:
    """Write the results of all shards into the folder; return them as data."""
    results = Results(campaign, folder)
    data = results.as_data()
    data["found"], data["streams"] = keep_streams(campaign, results, folder)
    drawn = {
        name: (caption, with_style(text))
        for name, (caption, text) in _pictures(campaign, results, data).items()
        if text
    }
    for name, (_, text) in drawn.items():
        (folder / f"{name}.svg").write_text(text, encoding="utf-8")
    (folder / "results.json").write_text(json.dumps(data, indent=2) + "\n", encoding="utf-8")
    page = campaign_page(data, {caption: text for caption, text in drawn.values()})
    (folder / "index.html").write_text(page, encoding="utf-8")
    return data


def _pictures(campaign: Campaign, results: Results, data: Mapping[str, Any]) -> dict[str, tuple[str, str]]:
    """Return file name -> caption and drawing."""
    strata, declared = campaign.strata, campaign.declared
    limits = {alert_limit_mm(campaign, scene_of(campaign, one).target) for one in strata}
    names = {one.number: campaign.words_of(one) for one in strata}
    period = {names[one.number]: data["strata"][one.number]["period_ms"] for one in strata}
    along = {names[one.number]: results.along(one, _widest_mm(campaign, one)) for one in strata}
    margins = {names[one.number]: results.margins_mm(one) for one in strata}
    found = {
        "width": (
            "Width along the line",
            width_along_line(along, declared.place_step_mm, declared.confidence, "width along the line"),
        ),
        "availability": (
            "Availability along the line",
            availability_along_line(along, declared.place_step_mm, declared.confidence, "availability along the line"),
        ),
        "margins": (
            "Smallest margins of the vehicles, by situation",
            margins_of_situations(margins, declared.confidence, "smallest margins by situation"),
        ),
    }
    if len(limits) == 1:  # cells of vehicles with different limits are of different size
        limit_mm = limits.pop()
        drawn = stanford_of_cells(results.stanford(), results.silent(), limit_mm, CELLS_TO_LIMIT, "all vehicles run")
        caption = "Stanford diagram: the vehicles as they were run, without weights; what is far beyond the limit stands at the edge"
        found["stanford"] = (caption, drawn)
    for column, name, caption in (
        ("withdrawn_after", "time-to-withdraw", "Time from the fault until nothing is reported"),
        ("reaction", "reaction", "Time from the first broken law until nothing is reported"),
    ):
        times = {names[one.number]: results.times(one, column) for one in strata}
        found[name] = (caption, times_until_silent(times, period, declared.confidence, caption))
    return found


def _widest_mm(campaign: Campaign, stratum: Stratum) -> int | None:
    """Return the greatest width that the machine can report, where its tolerance bounds both margins."""
    tolerance_mm = getattr(scene_of(campaign, stratum).target.config, "tolerance_mm", None)
    return None if tolerance_mm is None else 2 * int(tolerance_mm)
