"""First steps for a reader of the page: the runs that it offers to understand a counterexample, or to drive a machine by
hand.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from safeloc.report.links import Links

_Data = Mapping[str, Any]
_MOST = 5
"""Counterexamples that the first lines of the page name; the others stand below."""


def first_steps(data: _Data, links: Links) -> dict[str, Any]:
    """Return the violated results with a run, the shortest run first, how many more there are, and the run to drive, if there is one."""
    runs = data.get("runs", {})
    violated = [row for row in data["results"] if row["verdict"] == "violated" and row["id"] in runs]
    by_length = sorted(violated, key=lambda row: int(runs[row["id"]]))
    return {
        "counterexamples": [(row["id"], runs[row["id"]], links.run(row)) for row in by_length[:_MOST]],
        "more": max(0, len(by_length) - _MOST),
        "driven": _driven(data, links),
    }


def _driven(data: _Data, links: Links) -> dict[str, Any] | None:
    """Return the longest run of a machine that reports an interval, has a sensor that may be silent, and can be run in the page.

    One machine by itself comes before a composition, which has more inputs.
    """
    runs, scripts = data.get("runs", {}), data.get("scripts", ())
    usable = {
        one["name"]: len(one["parts"])
        for one in data["machines"]
        if one["reported"] and one["name"] in scripts and _may_be_silent(one)
    }
    rows = [row for row in data["results"] if row["id"] in runs and row["machine"] in usable]
    if not rows:
        return None
    row = min(rows, key=lambda row: (usable[row["machine"]], row["verdict"] == "violated", -int(runs[row["id"]])))
    return {"machine": row["machine"], "steps": runs[row["id"]], "at": f"{links.run(row)}&drive="}


def _may_be_silent(machine: _Data) -> bool:
    """Return whether an input of the machine may be absent."""
    variables = (one for part in machine["parts"] for one in part["variables"])
    return any(one["kind"] == "input" and one["name"].endswith(".present") for one in variables)
